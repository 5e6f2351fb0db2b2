// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
#include "reference/leaf_on_ray.h"
#include "tiles/frame_rules.h"
#include "tiles/surfel_bins.h"

namespace pcl_slim::detail {

/** \brief What every tile of a frame needs. */
struct FrameContext {
  const SLIMSurface& surface;
  const CameraRays& rays;
  const SurfelBins& bins;
  const FrameRules& rules;
};

/** \brief One tile's pixels while they are being rendered; reused from tile to tile. */
struct Tile {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<Ray> rays;
  std::vector<double> first_depth;  ///< t^ of pass 1; farthest where nothing was met
  std::vector<double> nearest;      ///< pass 1 looks no nearer than this ...
  std::vector<double> farthest;     ///< ... and no farther
  std::vector<BlendSum> sums;
  PixelRect pending;  ///< contains every pixel of the next passes
  std::vector<std::uint8_t> is_pending;

  /** \brief Takes up tile number t of a frame and prepares its rays. */
  void begin(const FrameContext& frame, const ImageSize& size, std::size_t t);
  std::size_t index(int x, int y) const
  {
    return static_cast<std::size_t>(y - y0) * kTileSize + static_cast<std::size_t>(x - x0);
  }
  /** \brief The part of a rectangle inside this tile. */
  PixelRect clip(const PixelRect& rect) const;
};

/** \brief Pass 1: the first intersection of each ray with a leaf inside its shrunk ball. */
void
findFirstIntersections(const FrameContext& frame, std::size_t t, Tile& tile,
                       RenderStatistics& statistics);

/** \brief Pass 2: sums over the leaves whose ball contains q^, each at its root nearest to q^. */
void
gatherBlends(const FrameContext& frame, std::size_t t, Tile& tile, RenderStatistics& statistics);

/** \brief Sends pixels whose blend is not covered back to pass 1, to look behind it.
 * \return false when there are none. */
bool
peelUncovered(const FrameContext& frame, Tile& tile);

/** \brief Divides a blend's sums and writes them into a pixel of the buffer. */
void
writeBlend(const SLIMSurface& surface, const Ray& ray, double depth_hat, const BlendSum& sum,
           std::size_t pixel, GBuffer& out);

/** \brief Divides the sums and writes the tile's pixels into the buffer. */
void
resolveTile(const FrameContext& frame, const Tile& tile, GBuffer& buffer,
            RenderStatistics& statistics);

}  // namespace pcl_slim::detail
