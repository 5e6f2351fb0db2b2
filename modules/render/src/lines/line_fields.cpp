// SPDX-License-Identifier: BSD-3-Clause
#include "lines/line_fields.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr float kStep = 2.0f;          ///< pixels over which k is differenced, at least
constexpr float kRadiusStep = 0.1f;    ///< of the leaf's radius, at least
constexpr float kMostStep = 24.0f;     ///< pixels, at most
constexpr float kProminence = 0.5f;    ///< of the leaf's radius: where a crest has to be lower
constexpr float kSignificance = 2.0f;  ///< deviations of the noise that count as strength 1

float
screenLength(const PixelFrame& frame)
{
  return std::sqrt(frame.screen[0] * frame.screen[0] + frame.screen[1] * frame.screen[1]);
}

/** k at a local distance before and behind a pixel along its direction. */
bool
sampleBothWays(const PixelGeometry& geometry, const std::vector<PixelFrame>& frames,
               std::size_t pixel, float distance, float& before, float& behind)
{
  const GBuffer& buffer = geometry.buffer();
  const auto x = static_cast<float>(pixel % buffer.width),
             y = static_cast<float>(pixel / buffer.width);
  const float dx = distance * frames[pixel].screen[0], dy = distance * frames[pixel].screen[1];
  const float depth = buffer.depth[pixel];
  return geometry.sample(frames, x + dx, y + dy, depth, before) &&
         geometry.sample(frames, x - dx, y - dy, depth, behind);
}

/** Local distance over which differences of k are steady, in the pixels of this view. */
float
stepAt(const GBuffer& buffer, const PixelFrame& frame, std::size_t pixel)
{
  const float pixels = screenLength(frame);
  const float step = std::max(kStep, kRadiusStep * buffer.radius[pixel] * pixels);
  return std::min(step, kMostStep) / pixels;
}

}  // namespace

CrestField::CrestField(const PixelGeometry& geometry, std::vector<PixelFrame> frames,
                       float least_curvature, int threads)
    : geometry_(geometry), least_curvature_(least_curvature)
{
  frames_ = std::move(frames);
  value_.assign(frames_.size(), 0.0f);
  valid_.assign(frames_.size(), 0);
  parallelFor(static_cast<std::size_t>(geometry.buffer().height), threads, 8,
              [&](std::size_t row, int) { derive(row); });
}

void
CrestField::derive(std::size_t row)
{
  const GBuffer& buffer = geometry_.buffer();
  const std::size_t first = row * static_cast<std::size_t>(buffer.width);
  for (std::size_t i = first; i < first + static_cast<std::size_t>(buffer.width); ++i) {
    const PixelFrame& frame = frames_[i];
    if (frame.k < least_curvature_ || !(screenLength(frame) > 0)) continue;
    const float step = stepAt(buffer, frame, i);
    float before, behind;
    if (!sampleBothWays(geometry_, frames_, i, step, before, behind)) continue;
    value_[i] = (before - behind) / (2.0f * step);
    valid_[i] = 1;
  }
}

/** Whether k is greatest between two neighbours, not least: the derivative falls along the
 * direction. */
bool
CrestField::falls(std::size_t a, std::size_t b) const
{
  const auto width = static_cast<std::size_t>(geometry_.buffer().width);
  const float way = frames_[a].screen[b == a + width ? 1 : 0];
  return (value(b, a) - value(a, a)) * way < 0;
}

/** How far k stands out of its surroundings, in deviations of the noise. */
float
CrestField::significance(std::size_t pixel) const
{
  const float distance = kProminence * geometry_.buffer().radius[pixel];
  float before, behind;
  if (!sampleBothWays(geometry_, frames_, pixel, distance, before, behind)) {
    before = behind = 0;  // The surface ends: nothing stands beside it.
  }
  return (frames_[pixel].k - std::max(before, behind)) / geometry_.noiseOfCurvature(pixel);
}

float
CrestField::strength(std::size_t a, std::size_t b, float share) const
{
  if (!falls(a, b)) return 0;
  const float k = frames_[a].k + share * (frames_[b].k - frames_[a].k);
  const float significant = significance(share < 0.5f ? a : b) / kSignificance;
  return std::max(0.0f, std::min(k / least_curvature_, significant));
}

RadialField::RadialField(const PixelGeometry& geometry, float least_derivative, int threads)
    : geometry_(geometry), least_derivative_(least_derivative)
{
  signless_ = true;
  frames_ = radialFrames(geometry, threads);
  value_.resize(frames_.size());
  valid_.resize(frames_.size());
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    value_[i] = frames_[i].k;
    valid_[i] = screenLength(frames_[i]) > 0;
  }
}

/** Of k towards the viewer along the surface, 1/local length squared. */
float
RadialField::derivative(std::size_t pixel) const
{
  const float step = stepAt(geometry_.buffer(), frames_[pixel], pixel);
  float before, behind;
  if (!sampleBothWays(geometry_, frames_, pixel, step, before, behind)) return 0;
  return (before - behind) / (2.0f * step);
}

float
RadialField::strength(std::size_t a, std::size_t b, float share) const
{
  const std::size_t pixel = share < 0.5f ? a : b;
  const float d = derivative(pixel);
  const float rise = kProminence * geometry_.buffer().radius[pixel] * d;
  const float significant = rise / (geometry_.noiseOfCurvature(pixel) * kSignificance);
  return std::max(0.0f, std::min(d / least_derivative_, significant));
}

}  // namespace pcl_slim::detail
