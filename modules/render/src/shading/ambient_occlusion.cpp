// SPDX-License-Identifier: BSD-3-Clause
#include "shading/ambient_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {
namespace {

constexpr int kSamples = 16;
constexpr int kPatterns = 16;     ///< rotations of the spiral, repeating in 4 x 4 pixels
constexpr double kReach = 0.045;  ///< of the picture's smaller side
constexpr double kGoldenAngle = 2.39996322972865332;

struct Offset {
  int dx, dy;
};
using Spiral = std::array<Offset, kSamples>;

std::array<Spiral, kPatterns>
makeSpirals(double reach)
{
  std::array<Spiral, kPatterns> spirals;
  for (int p = 0; p < kPatterns; ++p) {
    // Steps of 7 spread neighbouring rotations over the 4 x 4 pattern.
    const double turn = 2.0 * M_PI * ((p * 7) % kPatterns) / kPatterns;
    for (int i = 0; i < kSamples; ++i) {
      const double distance = std::max(1.0, reach * std::sqrt((i + 0.5) / kSamples));
      const double angle = turn + kGoldenAngle * i;
      spirals[static_cast<std::size_t>(p)][static_cast<std::size_t>(i)] = {
          static_cast<int>(std::lround(distance * std::cos(angle))),
          static_cast<int>(std::lround(distance * std::sin(angle)))};
    }
  }
  return spirals;
}

/** \brief How much one neighbour hides: its elevation over the tangent plane, faded by distance. */
float
hiddenBy(const GBuffer& buffer, std::size_t pixel, std::size_t other, float reach)
{
  const auto &p = buffer.position[pixel], &q = buffer.position[other], &n = buffer.normal[pixel];
  const float d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
  const float distance_sq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  if (!(distance_sq > 0.0f)) return 0.0f;
  const float rise = (d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) / std::sqrt(distance_sq);
  const float fade = std::max(0.0f, 1.0f - distance_sq / (4.0f * reach * reach));
  return std::max(0.0f, rise - 0.08f) * fade;
}

/** \brief Local length of a pixel at the object: from neighbouring positions, robustly. */
float
pixelLength(const GBuffer& buffer)
{
  std::vector<float> steps;
  for (int y = 0; y < buffer.height; y += 4) {
    for (int x = 0; x + 1 < buffer.width; x += 4) {
      const std::size_t a = buffer.index(x, y), b = a + 1;
      if (!buffer.covered(a) || !buffer.covered(b)) continue;
      const auto &p = buffer.position[a], &q = buffer.position[b];
      steps.push_back(std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]));
    }
  }
  if (steps.empty()) return 0.0f;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 4);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

std::vector<float>
ambientOcclusion(const GBuffer& buffer, int threads)
{
  std::vector<float> open(buffer.numPixels(), 1.0f);
  const double reach_pixels = std::max(2.0, kReach * std::min(buffer.width, buffer.height));
  const float reach = static_cast<float>(reach_pixels) * pixelLength(buffer);
  if (!(reach > 0.0f)) return open;
  const auto spirals = makeSpirals(reach_pixels);
  parallelFor(static_cast<std::size_t>(buffer.height), threads, 8, [&](std::size_t row, int) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < buffer.width; ++x) {
      const std::size_t pixel = buffer.index(x, y);
      if (!buffer.covered(pixel)) continue;
      float hidden = 0.0f;
      for (const Offset& offset : spirals[static_cast<std::size_t>((y & 3) * 4 + (x & 3))]) {
        const int nx = x + offset.dx, ny = y + offset.dy;
        if (nx < 0 || ny < 0 || nx >= buffer.width || ny >= buffer.height) continue;
        const std::size_t other = buffer.index(nx, ny);
        if (buffer.covered(other)) hidden += hiddenBy(buffer, pixel, other, reach);
      }
      open[pixel] = std::max(0.0f, 1.0f - 1.6f * hidden / kSamples);
    }
  });
  return open;
}

}  // namespace pcl_slim::detail
