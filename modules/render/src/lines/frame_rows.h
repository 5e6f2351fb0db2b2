// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

/** \brief A row of a picture as kernels read it; columns as in GBuffer. */
struct PictureRow {
  const float *depth, *normal, *gradient, *hessian;  ///< of its first pixel
  int width;
  float left, height, pixel;  ///< first pixel in the plane at depth 1, and a pixel's length there
  bool perspective;           ///< false: a pixel has that length at every depth
  std::array<float, 3> right, up, forward;
};

/** \brief The surface's curvature from a row's blends; columns per pixel, padded to sixteen. */
struct FrameRow {
  AlignedVector<float> k;                         ///< a curvature, 1/local length
  std::array<AlignedVector<float>, 3> direction;  ///< its unit tangent; the sign is arbitrary
  std::array<AlignedVector<float>, 2>
      screen;  ///< the tangent in the picture, pixels per local length

  explicit FrameRow(int width);
};

namespace kernels {

/** \brief The larger principal curvature of each pixel: k1 where the surface is convex, as for
 * ridges, and k2 < 0 where it is more concave. 0 where nothing is seen or the surface is seen at a
 * grazing angle. */
void
crestFrames(const PictureRow& row, FrameRow& frames);

/** \brief Radial curvature of each pixel, along the projected way to the viewer. Facing contours and
 * straight ahead, where it is undefined, screen is 0. */
void
radialFrames(const PictureRow& row, FrameRow& frames);

}  // namespace kernels
}  // namespace pcl_slim::detail
