// SPDX-License-Identifier: BSD-3-Clause
#include "lines/pixel_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr float kLeastFacing = 0.15f;     ///< crest lines seen flatter are not told from noise
constexpr float kLeastRadial = 0.342f;    ///< sin 20 degrees: DeCarlo et al. 2003
constexpr float kContourFacing = 0.05f;   ///< flatter than that belongs to the contour itself
constexpr double kDepthStep = 0.03;       ///< [L]
constexpr double kStorePrecision = 1e-9;  ///< [L]
/** Noise of curvature is 60 sigma / (r^2 sqrt(n_eff)): measured on spheres and tori. */
constexpr double kNoiseFactor = 60;

float
dot(const Float3& a, const Float3& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Float3
toFloat(const Vector3& v)
{
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/** Two unit tangents that make a frame with a unit normal. */
std::array<Float3, 2>
tangents(const Float3& n)
{
  const float sign = n[2] >= 0 ? 1.0f : -1.0f;
  const float a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
  return {Float3{1.0f + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
          Float3{b, sign + n[1] * n[1] * a, -n[1]}};
}

/** Principal curvatures k1 >= k2 of a symmetric 2x2 matrix and the angle of the first. */
void
principal(float aa, float ab, float bb, float& k1, float& k2, float& cosine, float& sine)
{
  const float mean = 0.5f * (aa + bb), half = 0.5f * (aa - bb);
  const float root = std::sqrt(half * half + ab * ab);
  k1 = mean + root;
  k2 = mean - root;
  // The half angle of (half, ab), without trigonometry.
  float x = half + root, y = ab;
  if (half < 0) x = ab, y = root - half;
  const float length = std::sqrt(x * x + y * y);
  cosine = length > 0 ? x / length : 1.0f;
  sine = length > 0 ? y / length : 0.0f;
}

}  // namespace

PixelGeometry::PixelGeometry(const GBuffer& buffer, const Camera& camera,
                             const SLIMSurface& surface, int threads)
    : buffer_(buffer),
      surface_(surface),
      rays_(camera, surface.info.origin, surface.info.scale),
      diagonal_(surface.info.diagonal),
      sigma_(std::max(std::sqrt(std::max(surface.info.lambda, 0.0)), kStorePrecision) * diagonal_),
      step_(static_cast<float>(kDepthStep * diagonal_)),
      ray_(buffer.numPixels()),
      pixel_length_(buffer.numPixels(), 0.0f)
{
  const CameraAxes axes(camera);
  right_ = toFloat(axes.right);
  up_ = toFloat(axes.up);
  forward_ = toFloat(axes.forward);
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t i = buffer.index(x, y);
      if (!buffer.covered(i)) continue;
      const Ray ray = rays_.ray(x, y);
      ray_[i] = toFloat(ray.direction);
      pixel_length_[i] = static_cast<float>(
          rays_.pixelLength(pcl_slim::along(ray.origin, buffer.depth[i], ray.direction)));
    }
  });
}

Vector3
PixelGeometry::point(std::size_t pixel, int x, int y) const
{
  const Ray ray = rays_.ray(x, y);
  return pcl_slim::along(ray.origin, buffer_.depth[pixel], ray.direction);
}

float
PixelGeometry::depthOfPlane(std::size_t pixel, int x, int y, int other_x, int other_y) const
{
  const Ray ray = rays_.ray(other_x, other_y);
  const Float3& n = buffer_.normal[pixel];
  const Vector3 normal = {n[0], n[1], n[2]};
  const double slope = pcl_slim::dot(normal, ray.direction);
  const double height = pcl_slim::dot(normal, subtract(point(pixel, x, y), ray.origin));
  const double depth = slope != 0 ? height / slope : -1.0;
  return depth > 0 ? static_cast<float>(depth) : -std::numeric_limits<float>::infinity();
}

Pixel2
PixelGeometry::onScreen(std::size_t pixel, const Float3& tangent) const
{
  const Float3& ray = ray_[pixel];
  const float ahead = dot(tangent, forward_) / dot(ray, forward_);
  return {(dot(tangent, right_) - ahead * dot(ray, right_)) / pixel_length_[pixel],
          (ahead * dot(ray, up_) - dot(tangent, up_)) / pixel_length_[pixel]};
}

float
PixelGeometry::facing(std::size_t pixel) const
{
  return -dot(buffer_.normal[pixel], ray_[pixel]);
}

bool
PixelGeometry::sample(const std::vector<PixelFrame>& frames, float x, float y, float depth,
                      float& value) const
{
  const auto x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  if (x0 < 0 || y0 < 0 || x0 + 1 >= buffer_.width || y0 + 1 >= buffer_.height) return false;
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const std::size_t first = buffer_.index(x0, y0), below = first + buffer_.width;
  for (const std::size_t i : {first, first + 1, below, below + 1}) {
    if (!buffer_.covered(i) || std::abs(buffer_.depth[i] - depth) > step_) return false;
  }
  const float top = frames[first].k + fx * (frames[first + 1].k - frames[first].k);
  const float bottom = frames[below].k + fx * (frames[below + 1].k - frames[below].k);
  value = top + fy * (bottom - top);
  return true;
}

float
PixelGeometry::noiseOfCurvature(std::size_t pixel) const
{
  const std::uint32_t leaf = buffer_.surfel[pixel];
  const double r = surface_.radius[leaf], n = std::max(1.0f, surface_.effective_count[leaf]);
  return static_cast<float>(kNoiseFactor * sigma_ / (r * r * std::sqrt(n)));
}

namespace {

/** Both principal directions of a pixel, as ridges and as ravines. */
void
frameCrests(const PixelGeometry& geometry, std::size_t i, PixelFrame& ridge, PixelFrame& ravine)
{
  const GBuffer& buffer = geometry.buffer();
  const Float3& g = buffer.gradient[i];
  const float length = std::sqrt(dot(g, g));
  if (!(length > 0) || geometry.facing(i) < kLeastFacing) return;
  const auto [a, b] = tangents(buffer.normal[i]);
  const Float3 ha = multiplied(buffer.hessian[i], a), hb = multiplied(buffer.hessian[i], b);
  float k1, k2, c, s;
  principal(dot(a, ha) / length, dot(a, hb) / length, dot(b, hb) / length, k1, k2, c, s);
  const bool bulges = k1 > -k2;
  PixelFrame& frame = bulges ? ridge : ravine;
  frame.k = bulges ? k1 : -k2;
  if (!bulges) std::tie(c, s) = std::make_pair(-s, c);
  for (std::size_t d = 0; d < 3; ++d) frame.direction[d] = c * a[d] + s * b[d];
  frame.screen = geometry.onScreen(i, frame.direction);
}

/** The radial curvature of a pixel and its direction. */
void
frameRadial(const PixelGeometry& geometry, std::size_t i, PixelFrame& frame)
{
  const GBuffer& buffer = geometry.buffer();
  const Float3 &ray = geometry.ray(i), &g = buffer.gradient[i];
  const float facing = geometry.facing(i), length = std::sqrt(dot(g, g));
  Float3 w;
  for (std::size_t d = 0; d < 3; ++d) w[d] = -ray[d] - facing * buffer.normal[i][d];
  const float w_length = std::sqrt(dot(w, w));
  if (!(length > 0) || w_length < 1e-6f) return;
  for (float& value : w) value /= w_length;
  frame.k = dot(w, multiplied(buffer.hessian[i], w)) / length;
  if (facing < kContourFacing || w_length < kLeastRadial) return;
  frame.direction = w;
  frame.screen = geometry.onScreen(i, w);
}

/** Calls body(pixel) for every pixel that shows the surface, rows in parallel. */
template <typename Body>
void
forCovered(const GBuffer& buffer, int threads, const Body& body)
{
  const auto width = static_cast<std::size_t>(buffer.width);
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      if (buffer.covered(i)) body(i);
    }
  });
}

}  // namespace

CrestFrames
crestFrames(const PixelGeometry& geometry, int threads)
{
  CrestFrames frames;
  frames.ridges.resize(geometry.buffer().numPixels());
  frames.ravines.resize(geometry.buffer().numPixels());
  forCovered(geometry.buffer(), threads,
             [&](std::size_t i) { frameCrests(geometry, i, frames.ridges[i], frames.ravines[i]); });
  return frames;
}

std::vector<PixelFrame>
radialFrames(const PixelGeometry& geometry, int threads)
{
  std::vector<PixelFrame> frames(geometry.buffer().numPixels());
  forCovered(geometry.buffer(), threads,
             [&](std::size_t i) { frameRadial(geometry, i, frames[i]); });
  return frames;
}

}  // namespace pcl_slim::detail
