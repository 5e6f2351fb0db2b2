// SPDX-License-Identifier: BSD-3-Clause
#include "lines/line_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr float kProminence = 0.5f;    ///< of the leaf's radius: where a crest has to be lower
constexpr float kSignificance = 2.0f;  ///< deviations of the noise that count as strength 1

/** Curvature as lines of one kind want it: of the surface, or of the surface turned round; 0 where
 * the other is the larger. */
struct Side {
  const CurvatureMap& map;
  float sign;

  float operator()(std::size_t pixel) const { return std::max(0.0f, sign * map[pixel]); }
};

}  // namespace

CurvatureMap::CurvatureMap(const PixelGeometry& geometry, Kernel kernel, int threads)
    : values_(new float[geometry.buffer().numPixels()])
{
  const GBuffer& buffer = geometry.buffer();
  constexpr std::size_t kRows = 8;
  const auto height = static_cast<std::size_t>(buffer.height);
  parallelFor((height + kRows - 1) / kRows, threads, 1, [&](std::size_t slice, int) {
    FrameRow frames(buffer.width);
    for (std::size_t y = slice * kRows; y < std::min(height, (slice + 1) * kRows); ++y) {
      if (geometry.rowIsEmpty(static_cast<int>(y))) continue;
      kernel(geometry.row(static_cast<int>(y)), frames);
      std::copy_n(frames.k.begin(), buffer.width,
                  values_.get() + buffer.index(0, static_cast<int>(y)));
    }
  });
}

CrestField::CrestField(const PixelGeometry& geometry, float least_curvature, int threads)
    : ZeroField(geometry),
      map_(geometry, kernels::crestFrames, threads),
      least_curvature_(least_curvature)
{
}

void
CrestField::fill(int y, FieldRow& row) const
{
  std::fill(row.kind.begin(), row.kind.end(), std::uint8_t{0});
  if (geometry_.rowIsEmpty(y)) return;
  kernels::crestFrames(geometry_.row(y), row.frames);
  const std::size_t first = geometry_.buffer().index(0, y);
  for (std::size_t x = 0; x < row.kind.size(); ++x) {
    const float k = row.frames.k[x];
    const Pixel2 screen = {row.frames.screen[0][x], row.frames.screen[1][x]};
    if (std::abs(k) < least_curvature_ || (screen[0] == 0 && screen[1] == 0)) continue;
    const float step = geometry_.differenceStep(first + x, screen);
    const Side side{map_, k > 0 ? 1.0f : -1.0f};
    float before, behind;
    if (!geometry_.sampleBothWays(first + x, screen, step, side, before, behind)) continue;
    row.value[x] = (before - behind) / (2.0f * step);
    row.kind[x] = k > 0 ? kRidge : kRavine;
  }
}

/** Strength of curvature alone; 0 where k is least between the two, not greatest. */
float
CrestField::mostBetween(const FieldRow& a, std::size_t xa, const FieldRow& b, std::size_t xb,
                        float share, std::size_t axis) const
{
  const bool grows = a.value[xa] < 0;
  const bool ahead = a.frames.screen[axis][xa] > 0;
  if (grows == ahead) return 0;
  const float k = a.frames.k[xa] + share * (b.frames.k[xb] - a.frames.k[xa]);
  return std::abs(k) / least_curvature_;
}

/** Not more than k stands out of its surroundings, in deviations of the noise. */
float
CrestField::strength(const Crossing& at, std::size_t nearer, int kind) const
{
  const Side side{map_, kind == kRidge ? 1.0f : -1.0f};
  const float distance = kProminence * geometry_.buffer().radius[nearer];
  float before, behind;
  if (!geometry_.sampleBothWays(nearer, at.screen, distance, side, before, behind)) {
    before = behind = 0;  // The surface ends: nothing stands beside it.
  }
  const float prominence = side(nearer) - std::max(before, behind);
  const float significant = prominence / (geometry_.noiseOfCurvature(nearer) * kSignificance);
  return std::max(0.0f, std::min(at.most, significant));
}

RadialField::RadialField(const PixelGeometry& geometry, float least_derivative, int threads)
    : ZeroField(geometry),
      map_(geometry, kernels::radialFrames, threads),
      least_derivative_(least_derivative)
{
}

void
RadialField::fill(int y, FieldRow& row) const
{
  std::fill(row.kind.begin(), row.kind.end(), std::uint8_t{0});
  if (geometry_.rowIsEmpty(y)) return;
  kernels::radialFrames(geometry_.row(y), row.frames);
  for (auto& column : row.frames.direction) std::fill(column.begin(), column.end(), 0.0f);
  std::copy_n(row.frames.k.begin(), row.value.size(), row.value.begin());
  for (std::size_t x = 0; x < row.kind.size(); ++x) {
    row.kind[x] = row.frames.screen[0][x] != 0 || row.frames.screen[1][x] != 0;
  }
}

float
RadialField::mostBetween(const FieldRow&, std::size_t, const FieldRow&, std::size_t, float,
                         std::size_t) const
{
  return std::numeric_limits<float>::infinity();
}

/** The derivative of the curvature towards the viewer along the surface, against the least and
 * against what noise makes of it. */
float
RadialField::strength(const Crossing& at, std::size_t nearer, int) const
{
  const float step = geometry_.differenceStep(nearer, at.screen);
  const auto read = [&](std::size_t pixel) { return map_[pixel]; };
  float before, behind;
  if (!geometry_.sampleBothWays(nearer, at.screen, step, read, before, behind)) return 0;
  const float derivative = (before - behind) / (2.0f * step);
  const float rise = kProminence * geometry_.buffer().radius[nearer] * derivative;
  const float significant = rise / (geometry_.noiseOfCurvature(nearer) * kSignificance);
  return std::max(0.0f, std::min(derivative / least_derivative_, significant));
}

}  // namespace pcl_slim::detail
