// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fast/frame_scene.h"

namespace pcl_slim::detail {

/** \brief Some pixels of a tile and what their rays have met, as a kernel's lanes store them. */
struct NearLanes {
  static constexpr std::size_t kSize = 16;

  alignas(64) float x[kSize], y[kSize];           ///< pixel
  alignas(64) float nearest[kSize];               ///< depth value less the tile's
  alignas(64) float first[kSize];                 ///< the same of q^; in and out for pass 1
  alignas(64) float live[kSize];                  ///< 1: to be looked at
  alignas(64) float weight[kSize], shift[kSize];  ///< of one leaf in pass 2
  alignas(64) float coverage[kSize], facing[kSize], lean[3][kSize];
  alignas(64) float outside[kSize];
  alignas(64) float gradient[3][kSize], hessian[6][kSize];  ///< times weight, camera's axes
  float tile_depth;                                         ///< D of the tile
  std::size_t count;
};

/** \brief Pass 1 of a surfel so near to the camera, or around it, that its record contains no
 * polynomial: in double, ray by ray. */
void
firstOfNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes);

/** \brief Pass 2 of the same. */
void
blendNearLeaf(const FrameScene& scene, std::uint32_t surfel, NearLanes& lanes);

}  // namespace pcl_slim::detail
