// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/render/disc_rasterizer.h"
#include "pcl_slim/render/g_buffer.h"
#include "tiles/surfel_bins.h"

namespace pcl_slim::detail {

/** \brief What every tile of a frame of discs needs. Local units: world less splats.origin. */
struct DiscFrame {
  const SplatSet& splats;
  const CameraRays& rays;
  const SurfelBins& bins;
  const DiscRenderParams& params;
  bool front_only;
};

/** \brief One disc as rays meet it. */
struct Disc {
  Vector3 center, normal;
  double radius;
  double pixel;  ///< length of a pixel where the disc is
  double width;  ///< radius of what rays meet: at least half a pixel's diagonal if filtered
  double span;   ///< along a ray no hit lies farther from the point beside the centre
  double reach;  ///< nor farther from the centre itself

  Disc(const DiscFrame& frame, std::size_t i);
};

/** \brief Where a ray meets a disc. */
struct DiscHit {
  double depth = 0.0;
  double cosine = 0.0;       ///< of the angle between ray and normal, >= 0
  double distance_sq = 0.0;  ///< s^2 of the weight, in [0, 1)
  Vector3 offset{};          ///< from the centre, within the disc
  bool from_front = true;
};

/** \brief Intersects a ray with a disc. \return false where it passes by. */
bool
intersect(const DiscFrame& frame, const Ray& ray, const Disc& disc, DiscHit& hit);

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
  struct First {
    double depth, cosine, radius;
    std::uint32_t disc;
  };
  struct Sum {
    double weight, depth, normal[3], color[3];
  };

  std::size_t index(int x, int y) const
  {
    return static_cast<std::size_t>(y - y0_) * kTileSize + static_cast<std::size_t>(x - x0_);
  }
  template <typename Body>
  void forEachPixel(const DiscFrame& frame, const Body& body) const;
  PixelRect clip(const PixelRect& rect) const;
  bool countsBehind(const DiscFrame& frame, const First& first, const Disc& disc, double depth,
                    double cosine) const;
  void add(const DiscFrame& frame, const DiscHit& hit, const Disc& disc, std::size_t i, Sum& sum);

  std::size_t tile_ = 0;
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
  std::vector<Ray> rays_;
  std::vector<First> first_;
  std::vector<Sum> sums_;
};

}  // namespace pcl_slim::detail
