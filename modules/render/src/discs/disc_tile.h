// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "discs/disc_blend.h"
#include "pcl_slim/render/g_buffer.h"
#include "tiles/surfel_bins.h"

namespace pcl_slim::detail {

/** \brief What every tile of a frame of discs needs. */
struct DiscFrame : DiscView {
  const SurfelBins& bins;
};

/** \brief One tile's pixels while discs are drawn into them; reused from tile to tile. */
class DiscTile {
 public:
  /** \brief Takes up tile number t and prepares its rays. */
  void begin(const DiscFrame& frame, const ImageSize& size, std::size_t t);

  /** \brief Pass 1: the first disc of each ray. */
  void findFirst(const DiscFrame& frame, DiscRenderStatistics& statistics);
  /** \brief Pass 2: weighted sums over the discs at the first one's depth. */
  void blend(const DiscFrame& frame, DiscRenderStatistics& statistics);
  /** \brief Writes the tile's pixels. */
  void resolve(const DiscFrame& frame, GBuffer& buffer, DiscRenderStatistics& statistics) const;

 private:
  std::size_t index(int x, int y) const
  {
    return static_cast<std::size_t>(y - y0_) * kTileSize + static_cast<std::size_t>(x - x0_);
  }
  template <typename Body>
  void forEachPixel(const DiscFrame& frame, const Body& body) const;
  PixelRect clip(const PixelRect& rect) const;

  std::size_t tile_ = 0;
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
  std::vector<Ray> rays_;
  std::vector<FirstDisc> first_;
  std::vector<DiscSum> sums_;
};

}  // namespace pcl_slim::detail
