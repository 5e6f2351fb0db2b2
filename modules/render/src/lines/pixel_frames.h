// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

using Pixel2 = std::array<float, 2>;
using Float3 = std::array<float, 3>;

/** \brief What a pixel's blend tells of the surface's bending. */
struct PixelFrame {
  float k = 0;         ///< the curvature that a line is looked for in, 1/local length
  Float3 direction{};  ///< its unit tangent; its sign is arbitrary
  Pixel2 screen{};     ///< the tangent in the picture, pixels per local length
};

/** \brief Cosine of the angle between two pixels' tangents. */
inline float
along(const PixelFrame& a, const PixelFrame& b)
{
  return a.direction[0] * b.direction[0] + a.direction[1] * b.direction[1] +
         a.direction[2] * b.direction[2];
}

/** \brief Geometry that all kinds of lines need, made once a view. O(pixels). */
class PixelGeometry {
 public:
  PixelGeometry(const GBuffer& buffer, const Camera& camera, const SLIMSurface& surface,
                int threads);

  const GBuffer& buffer() const { return buffer_; }
  double diagonal() const { return diagonal_; }

  /** \brief Unit ray of a pixel, local axes. */
  const Float3& ray(std::size_t pixel) const { return ray_[pixel]; }
  /** \brief Length of a pixel at its surface point, local units. */
  float pixelLength(std::size_t pixel) const { return pixel_length_[pixel]; }
  /** \brief A tangent's image, pixels per local length. */
  Pixel2 onScreen(std::size_t pixel, const Float3& tangent) const;
  /** \brief Depth at which another pixel's ray meets a pixel's tangent plane; -infinity where it
   * meets it behind the camera or never. */
  float depthOfPlane(std::size_t pixel, int x, int y, int other_x, int other_y) const;
  /** \brief Cosine of the angle between a pixel's normal and the way to the viewer. */
  float facing(std::size_t pixel) const;

  /** \brief A value of the four pixels about a place, by bilinear interpolation; nothing where one
   * shows no surface or lies beyond a step of depth from the given one. */
  bool sample(const std::vector<PixelFrame>& frames, float x, float y, float depth,
              float& value) const;

  /** \brief Deviation of a curvature that noise makes at a pixel, from its leaf's radius and number
   * of points (1/local length); a change of curvature within half a radius is compared with it. */
  float noiseOfCurvature(std::size_t pixel) const;

 private:
  Vector3 point(std::size_t pixel, int x, int y) const;

  const GBuffer& buffer_;
  const SLIMSurface& surface_;
  CameraRays rays_;
  double diagonal_, sigma_;
  float step_;  ///< of depth
  Float3 right_, up_, forward_;
  std::vector<Float3> ray_;
  std::vector<float> pixel_length_;  ///< 0 where nothing is seen
};

/** \brief Tangents of greatest curvature, of the surface and of the surface turned round: what
 * ridges and ravines are looked for in. Pixels seen at a grazing angle, those without a surface and
 * those that bend the other way more keep k = 0. */
struct CrestFrames {
  std::vector<PixelFrame> ridges, ravines;
};

CrestFrames
crestFrames(const PixelGeometry& geometry, int threads);

/** \brief Radial curvature of each pixel, along the projected way to the viewer; facing contours
 * and straight ahead, where it says nothing, screen is 0. */
std::vector<PixelFrame>
radialFrames(const PixelGeometry& geometry, int threads);

}  // namespace pcl_slim::detail
