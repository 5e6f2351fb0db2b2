// SPDX-License-Identifier: BSD-3-Clause
#include "lines/pixel_geometry.h"

#include <algorithm>
#include <limits>

namespace pcl_slim::detail {

namespace {

constexpr double kDepthStep = 0.03;       ///< [L]
constexpr double kStorePrecision = 1e-9;  ///< [L]
/** Noise of curvature is 60 sigma / (r^2 sqrt(n_eff)): measured on spheres and tori. */
constexpr double kNoiseFactor = 60;
constexpr float kStep = 2.0f;        ///< pixels over which k is differenced, at least
constexpr float kRadiusStep = 0.1f;  ///< of the leaf's radius, at least
constexpr float kMostStep = 24.0f;   ///< pixels, at most

std::array<float, 3>
toFloat(const Vector3& v)
{
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

PixelGeometry::PixelGeometry(const GBuffer& buffer, const Camera& camera,
                             const SLIMSurface& surface)
    : buffer_(buffer),
      surface_(surface),
      rays_(camera, surface.info.origin, surface.info.scale),
      perspective_(camera.projection == Camera::Projection::kPerspective),
      diagonal_(surface.info.diagonal),
      sigma_(std::max(std::sqrt(std::max(surface.info.lambda, 0.0)), kStorePrecision) * diagonal_),
      step_(static_cast<float>(kDepthStep * diagonal_))
{
  const CameraAxes axes(camera);
  right_ = toFloat(axes.right);
  up_ = toFloat(axes.up);
  forward_ = toFloat(axes.forward);
}

PictureRow
PixelGeometry::row(int y) const
{
  const std::size_t first = buffer_.index(0, y);
  const auto [left, height] = rays_.inPlane(0, y);
  return {buffer_.depth.data() + first,
          buffer_.normal[first].data(),
          buffer_.gradient[first].data(),
          buffer_.hessian[first].data(),
          buffer_.width,
          static_cast<float>(left),
          static_cast<float>(height),
          static_cast<float>(rays_.pixel()),
          perspective_,
          right_,
          up_,
          forward_};
}

bool
PixelGeometry::rowIsEmpty(int y) const
{
  const std::uint32_t* const begin = buffer_.surfel.data() + buffer_.index(0, y);
  return std::all_of(begin, begin + buffer_.width,
                     [](std::uint32_t surfel) { return surfel == GBuffer::kNothing; });
}

float
PixelGeometry::pixelLength(std::size_t pixel, int x, int y) const
{
  const Ray ray = rays_.ray(x, y);
  return static_cast<float>(
      rays_.pixelLength(along(ray.origin, buffer_.depth[pixel], ray.direction)));
}

float
PixelGeometry::depthOfPlane(std::size_t pixel, int x, int y, int other_x, int other_y) const
{
  const Ray own = rays_.ray(x, y), ray = rays_.ray(other_x, other_y);
  const auto& n = buffer_.normal[pixel];
  const Vector3 normal = {n[0], n[1], n[2]};
  const Vector3 point = along(own.origin, buffer_.depth[pixel], own.direction);
  const double slope = dot(normal, ray.direction);
  const double height = dot(normal, subtract(point, ray.origin));
  const double depth = slope != 0 ? height / slope : -1.0;
  return depth > 0 ? static_cast<float>(depth) : -std::numeric_limits<float>::infinity();
}

float
PixelGeometry::differenceStep(std::size_t pixel, const Pixel2& screen) const
{
  const float pixels = std::sqrt(screen[0] * screen[0] + screen[1] * screen[1]);
  const float step = std::max(kStep, kRadiusStep * buffer_.radius[pixel] * pixels);
  return std::min(step, kMostStep) / pixels;
}

float
PixelGeometry::noiseOfCurvature(std::size_t pixel) const
{
  const std::uint32_t leaf = buffer_.surfel[pixel];
  const double r = surface_.radius[leaf], n = std::max(1.0f, surface_.effective_count[leaf]);
  return static_cast<float>(kNoiseFactor * sigma_ / (r * r * std::sqrt(n)));
}

}  // namespace pcl_slim::detail
