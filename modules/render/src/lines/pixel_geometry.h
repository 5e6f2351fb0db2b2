// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "camera/camera_rays.h"
#include "lines/frame_rows.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

using Pixel2 = std::array<float, 2>;

/** \brief Geometry that all kinds of lines need; nothing is stored per pixel. */
class PixelGeometry {
 public:
  PixelGeometry(const GBuffer& buffer, const Camera& camera, const SLIMSurface& surface);

  const GBuffer& buffer() const { return buffer_; }
  double diagonal() const { return diagonal_; }

  /** \brief A row for the kernels; of a buffer with gradients and Hessians. */
  PictureRow row(int y) const;
  /** \brief Whether a row shows the surface anywhere. */
  bool rowIsEmpty(int y) const;

  /** \brief Length of a pixel at its surface point, local units. */
  float pixelLength(std::size_t pixel, int x, int y) const;
  /** \brief Depth at which another pixel's ray meets a pixel's tangent plane; -infinity where it
   * meets it behind the camera or never. */
  float depthOfPlane(std::size_t pixel, int x, int y, int other_x, int other_y) const;

  /** \brief A value of the four pixels about a place, by bilinear interpolation; false where one
   * shows no surface or is beyond a step of depth from the given one.
   * \param[in] read gives a pixel's value; it is called for pixels that show the surface only */
  template <typename Read>
  bool sample(float x, float y, float depth, const Read& read, float& value) const
  {
    if (!(x >= 0 && x < static_cast<float>(buffer_.width - 1))) return false;
    if (!(y >= 0 && y < static_cast<float>(buffer_.height - 1))) return false;
    const auto x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const std::size_t first = buffer_.index(x0, y0);
    const std::size_t below = first + static_cast<std::size_t>(buffer_.width);
    // Where nothing is seen the depth is infinite.
    const float* const d = buffer_.depth.data();
    // Counted without a branch each.
    const auto near = [&](std::size_t i) {
      return static_cast<int>(std::abs(d[i] - depth) <= step_);
    };
    if (near(first) + near(first + 1) + near(below) + near(below + 1) < 4) return false;
    const float top_left = read(first), bottom_left = read(below);
    const float top = top_left + fx * (read(first + 1) - top_left);
    const float bottom = bottom_left + fx * (read(below + 1) - bottom_left);
    value = top + fy * (bottom - top);
    return true;
  }

  /** \brief The same at a local distance before and behind a pixel along a tangent, given as its
   * image in the picture. */
  template <typename Read>
  bool sampleBothWays(std::size_t pixel, const Pixel2& screen, float distance, const Read& read,
                      float& before, float& behind) const
  {
    const auto width = static_cast<std::size_t>(buffer_.width);
    const std::size_t row = pixel / width;
    const auto x = static_cast<float>(pixel % width), y = static_cast<float>(row);
    const float dx = distance * screen[0], dy = distance * screen[1];
    const float depth = buffer_.depth[pixel];
    return sample(x + dx, y + dy, depth, read, before) &&
           sample(x - dx, y - dy, depth, read, behind);
  }

  /** \brief Local distance over which differences of curvature along a tangent are steady, in the
   * pixels of this view. */
  float differenceStep(std::size_t pixel, const Pixel2& screen) const;

  /** \brief Deviation of a curvature that noise makes at a pixel, from its leaf's radius and number
   * of points (1/local length); a change of curvature within half a radius is compared with it. */
  float noiseOfCurvature(std::size_t pixel) const;

 private:
  const GBuffer& buffer_;
  const SLIMSurface& surface_;
  CameraRays rays_;
  bool perspective_;
  double diagonal_, sigma_;
  float step_;  ///< of depth
  std::array<float, 3> right_, up_, forward_;
};

}  // namespace pcl_slim::detail
