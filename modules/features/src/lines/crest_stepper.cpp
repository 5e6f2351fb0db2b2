// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_stepper.h"

#include <algorithm>
#include <cmath>

#include "lines/crest_root.h"

namespace pcl_slim::detail {

namespace {

constexpr double kAside = 0.8;        ///< roots are looked for so many steps to both sides
constexpr double kShorter = 0.4;      ///< a step that fails is tried once more, so much shorter
constexpr double kLeastCosine = 0.5;  ///< a line turns by less than 60 degrees a step
constexpr double kTurnAgain = 0.5;   ///< share of the last turn that the next one is expected to be
constexpr double kFine = 0.02;       ///< distance of the last samples across, in radii
constexpr double kNearMiddle = 0.4;  ///< of a section's half width
constexpr int kRefinements = 3;
constexpr double kPastReach = 1.2;  ///< roots count so far beyond where they are looked for

Vector3
acrossOf(const Vector3& normal, const Vector3& ahead)
{
  return normalized(cross(normal, ahead));
}

}  // namespace

/** To the root of dk/dt along its gradient. */
bool
CrestStepper::start(const CrestVertex& seed, const CrestSample (&samples)[3], CrestVertex& vertex)
{
  forget();
  if (!samples[0].known || !samples[1].known || !samples[2].known) return false;
  const CrestAxes axes = seed.axes();
  const Vector3 gradient = along(scaled(axes.t, samples[1].e - samples[0].e),
                                 samples[2].e - samples[0].e, cross(axes.normal, axes.t));
  if (!(length(gradient) > 0)) return false;
  const double size = kAside * step_ * axes.radius;
  Search search;
  search.row = {samples[0].position, normalized(gradient), std::max(size, field_.leastSpan(axes))};
  search.reach = size;
  search.stride_across = search.row.across;
  search.stride = scaled(cross(axes.normal, search.row.across), step_ * axes.radius);
  if (!correct(search, axes, vertex)) return false;
  vertex.ahead = normalized(cross(vertex.normal, search.row.across));
  return complete(vertex);
}

/** Finds the line's vertex on a segment across it. */
bool
CrestStepper::correct(const Search& search, const CrestAxes& axes, CrestVertex& vertex)
{
  const Vector3& across = search.row.across;
  const double reach = search.reach;
  double at = search.at, span = search.row.span;
  CrestSample s[6];
  for (int round = 0; round <= kRefinements; ++round) {
    CrestRow rows[2];
    rows[0] = {along(search.row.place, at, across), across, span};
    rows[1] = {along(rows[0].place, 1.0, search.stride), search.stride_across, search.row.span};
    const bool strides = dot(search.stride, search.stride) > 0;
    field_.sampleAcross(rows, strides ? 2 : 1, axes, s);
    const CrossSection section(s, across);
    double move = 0;
    if (section.hasRoot()) {
      move = section.root();
      // Differences reach as far as the section: one whose middle is near the root is as good as any.
      const bool centered = !field_.isAnalytic() && std::abs(move) < kNearMiddle;
      if (round > 0 || centered) {
        vertex = section.vertex();
        vertex.fall /= span;
        ahead_.known = strides && s[3].known;
        ahead_.row = rows[1];
        std::copy(s + 3, s + 6, ahead_.samples);
        return std::abs(at + move * span) <= kPastReach * reach &&
               vertex.k > std::abs(vertex.other);
      }
    } else if (round == 0 || !section.newton(move)) {
      return false;
    }
    at += std::clamp(move * span, -reach, reach);
    if (std::abs(at) > kPastReach * reach) return false;
    span = std::max(std::min(reach, kFine * axes.radius), field_.leastSpan(axes));
  }
  return false;
}

/** Fills in what depends on the leaves around a vertex; false outside their support. */
bool
CrestStepper::complete(CrestVertex& vertex)
{
  const ProbeScale scale = field_.scaleAt(vertex.position, vertex.normal);
  vertex.radius = scale.radius;
  vertex.effective_count = scale.effective_count;
  vertex.reach = CrestField::reachAt(vertex);
  return scale.radius > 0;
}

bool
CrestStepper::finish(const CrestVertex& from, CrestVertex& next)
{
  const Vector3 chord = normalized(subtract(next.position, from.position));
  if (dot(chord, from.ahead) < kLeastCosine) return false;
  next.ahead = normalized(along(chord, -dot(chord, next.normal), next.normal));
  return complete(next);
}

bool
CrestStepper::step(const std::vector<CrestVertex>& line, double size, CrestVertex& next)
{
  const CrestVertex& from = line.back();
  Vector3 turn{};
  if (line.size() > 2) turn = scaled(subtract(from.ahead, line[line.size() - 2].ahead), kTurnAgain);
  const CrestAxes axes = from.axes();
  Search search;
  const Vector3 ahead = normalized(along(from.ahead, 1.0, turn));
  search.reach = kAside * size;
  search.row = {along(from.position, size, ahead), acrossOf(from.normal, ahead),
                std::max(search.reach, field_.leastSpan(axes))};
  const Vector3 beyond = normalized(along(ahead, 1.0, turn));
  search.stride = scaled(beyond, size);
  search.stride_across = acrossOf(from.normal, beyond);
  return correct(search, axes, next) && finish(from, next);
}

/** The vertex on the row that was sampled with the last one's. */
bool
CrestStepper::useAhead(const CrestVertex& from, CrestVertex& next)
{
  if (!ahead_.known) return false;
  ahead_.known = false;
  const CrossSection section(ahead_.samples, ahead_.row.across);
  if (!section.hasRoot() || std::abs(section.root()) >= kNearMiddle) return false;
  next = section.vertex();
  next.fall /= ahead_.row.span;
  return next.k > std::abs(next.other) && finish(from, next);
}

bool
CrestStepper::advance(const std::vector<CrestVertex>& line, CrestVertex& next)
{
  const double size = step_ * line.back().radius;
  return useAhead(line.back(), next) || step(line, size, next) || step(line, kShorter * size, next);
}

}  // namespace pcl_slim::detail
