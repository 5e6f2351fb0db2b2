// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"
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

/** \brief Sums of one pixel's blend (eqs. 6, 7, 8 left), before division by the weight. */
struct BlendSum {
  double weight = 0.0;
  double shift = 0.0;  ///< of w (t - t^): q lies on the ray
  double coverage = 0.0;
  double lean[3] = {0.0, 0.0, 0.0};  ///< of w (q - c) / r: points away from the leaves' middle
  int leaves = 0;
  double gradient[3] = {0.0, 0.0, 0.0};
  double hessian[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};  ///< xx yy zz xy xz yz
  double largest_weight = 0.0;
  std::uint32_t surfel = GBuffer::kNothing;
  std::int32_t facing = 0;  ///< leaves seen from the front minus those seen from behind
};

/** \brief One tile's pixels while they are being rendered; reused from tile to tile. */
struct Tile {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<Ray> rays;
  std::vector<double> first_depth;  ///< t^ of pass 1, infinity where nothing was met
  std::vector<double> nearest;      ///< pass 1 looks no nearer than this
  std::vector<BlendSum> sums;
  PixelRect pending;  ///< holds every pixel the next passes have to look at
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

/** \brief Pass 2: sums over the leaves whose ball holds q^, each at its root nearest to q^. */
void
gatherBlends(const FrameContext& frame, std::size_t t, Tile& tile, RenderStatistics& statistics);

/** \brief Sends pixels whose blend is not covered back to pass 1, to look behind it.
 * \return false when there are none. */
bool
peelUncovered(const FrameContext& frame, Tile& tile);

/** \brief Divides the sums and writes the tile's pixels into the buffer. */
void
resolveTile(const FrameContext& frame, const Tile& tile, GBuffer& buffer,
            RenderStatistics& statistics);

}  // namespace pcl_slim::detail
