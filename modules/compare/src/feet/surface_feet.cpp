// SPDX-License-Identifier: BSD-3-Clause
#include "feet/surface_feet.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr int kMostSteps = 12;
constexpr double kConverged = 1e-4;   ///< [r] a remainder in the tangent plane that is no error
constexpr double kLongestStep = 0.5;  ///< [r]
constexpr double kFlatDistance =
    0.05;  ///< [r] nearer to the surface its curvature has no influence
constexpr double kLeastFactor =
    0.2;                        ///< of 1 + distance curvature, next to the centre of curvature
constexpr double kDoubt = 2.0;  ///< [e] by which a patch with residuals e is farther away
constexpr double kInner = 0.9;  ///< of a patch's reach: its leaf covers places within
/** Coverage of places of the surface; that of exact tori is above .002, and 0 where a polynomial has
 * left its points. */
constexpr double kLeastCoverage = 3e-4;
constexpr double kGroupWidth = 2.0;  ///< [r] places in one request are no farther apart

/** A step in the tangent plane, by the curvatures of parallel surfaces: a step on the surface moves
 * the foot of a place at a height by 1 / (1 + height k) of the same step at the place. */
Vector3 curvedStep(const Vector3& tangential, double height, const PrincipalFrame& frame) {
  Vector3 step{};
  const auto add = [&](const std::array<float, 3>& direction, double k) {
    const Vector3 d = {direction[0], direction[1], direction[2]};
    step = along(step, dot(tangential, d) / std::max(1 + height * k, kLeastFactor), d);
  };
  add(frame.direction1, frame.k1);
  add(frame.direction2, frame.k2);
  return step;
}

}  // namespace

void FootFinder::restart() {
  hint_ = side_hint_ = 0;
  probe_.restart(0);
}

/** The nearest patch but for those that are excluded, where a patch's errors count as distance: beside
 * a sharp edge a polynomial leaves its points by about that much. */
FootFinder::Start FootFinder::nearest(const Vector3& place, const Vector3* side, double most,
                                      std::uint32_t hint, const Search& search) const {
  Start best{hint, {}};
  double bound = Bounds::kInfinity;
  const auto excluded_end = search.excluded.begin() + search.num_excluded;
  const auto visit = [&](std::uint32_t j) {
    if (std::find(search.excluded.begin(), excluded_end, j) != excluded_end) return bound;
    const LeafPatch& patch = index_.patches.patches[j];
    const PatchFoot foot = nearestOnPatch(patch, place);
    if (side && !(dot(foot.normal, *side) > 0)) return bound;
    const double distance = std::sqrt(foot.distance_sq);
    if (distance <= most && distance + kDoubt * patch.error < bound) {
      best = {j, foot};
      bound = distance + kDoubt * patch.error;
    }
    return bound;
  };
  visit(hint);
  index_.patches.tree.search(place, side, std::min(bound, most), visit);
  return best;
}

/** Places a walk at the nearest patch. \return whether there is one. */
bool FootFinder::start(const FeetRequest& request, std::size_t i, SidedFeet& found) {
  const Vector3 &place = request.places[i], &side = request.sides[i];
  Search& search = searches_[i];
  Start start;
  if (!search.sided) {
    start = nearest(place, nullptr, request.max_distance, hint_, search);
    if (!(start.foot.distance_sq < Bounds::kInfinity)) return false;
    hint_ = start.patch;
    found.faces = !(dot(side, side) > 0) || dot(start.foot.normal, side) > 0;
    if (!found.faces) found.nearest = start.foot;
    search.sided = !found.faces;
  }
  if (search.sided) {
    start = nearest(place, &side, request.max_distance, side_hint_, search);
    if (!(start.foot.distance_sq < Bounds::kInfinity)) return false;
    side_hint_ = start.patch;
  }
  Walk& walk = walks_[num_walks_++];
  walk = Walk{};
  walk.place = i;
  walk.patch = start.patch;
  walk.at = start.foot.position;
  walk.side = start.foot.normal;
  walk.radius = index_.patches.patches[start.patch].radius;
  walk.distance_sq = start.foot.distance_sq;
  return true;
}

/** Whether a foot is on the surface, and on the place's side. */
bool FootFinder::accept(const FeetRequest& request, const Walk& walk, const SurfaceFoot& foot) {
  const Vector3& side = request.sides[walk.place];
  if (searches_[walk.place].sided && !(dot(foot.normal, side) > 0)) return false;
  if (foot.border) return true;
  const LeafPatch& patch = index_.patches.patches[walk.patch];
  const Vector3 off = subtract(foot.position, patch.center);
  const double inner = kInner * patch.reach * patch.radius;
  if (dot(off, off) < inner * inner) return true;  // covered by this leaf alone
  return probe_.scaleAt(foot.position, foot.normal).coverage >= kLeastCoverage;
}

void FootFinder::find(const FeetRequest& request, std::array<SidedFeet, FeetRequest::kMost>& feet) {
  for (std::size_t i = 0; i < request.count; ++i) {
    feet[i] = SidedFeet();
    searches_[i] = {true, false, {}, 0};
  }
  for (std::size_t round = 0; round <= Search::kMost; ++round) {
    num_walks_ = 0;
    for (std::size_t i = 0; i < request.count; ++i) {
      if (searches_[i].pending) searches_[i].pending = start(request, i, feet[i]);
    }
    if (num_walks_ == 0) return;
    walk(request);
    for (std::size_t k = 0; k < num_walks_; ++k) {
      const Walk& walk = walks_[k];
      const SurfaceFoot foot = footOf(request.places[walk.place], walk);
      Search& search = searches_[walk.place];
      search.pending = !accept(request, walk, foot);
      if (!search.pending) {
        feet[walk.place].foot = foot;
      } else if (search.num_excluded < Search::kMost) {
        search.excluded[search.num_excluded++] = walk.patch;
      }
    }
  }
}

/** Steps all places on until they are at their feet, those near each other side by side. */
void FootFinder::walk(const FeetRequest& request) {
  for (int step = 0; step < kMostSteps; ++step) {
    std::array<Walk*, FeetRequest::kMost> group;
    for (std::size_t k = 0; k < num_walks_;) {
      std::size_t count = 0;
      bool curved = false;
      Bounds box;
      for (; k < num_walks_; ++k) {
        Walk& walk = walks_[k];
        if (walk.done) continue;
        Bounds wider = box;
        wider.add(walk.at);
        if (count > 0 && wider.diagonal() > kGroupWidth * group[0]->radius) break;
        box = wider;
        group[count++] = &walk;
        curved =
            curved || walk.distance_sq > kFlatDistance * kFlatDistance * walk.radius * walk.radius;
      }
      if (count > 0) evaluate(request, group.data(), count, curved);
    }
  }
}

void FootFinder::evaluate(const FeetRequest& request, Walk* const* group, std::size_t count,
                          bool curved) {
  std::array<Vector3, FeetRequest::kMost> positions, sides;
  std::array<ProbeSample, FeetRequest::kMost> samples;
  for (std::size_t k = 0; k < count; ++k) {
    positions[k] = group[k]->at;
    sides[k] = group[k]->side;
  }
  ProbeRequest probed;
  probed.positions = positions.data();
  probed.sides = sides.data();
  probed.count = count;
  probed.curvature = curved;
  probed.errors = true;
  probed.with_directions = curved ? count : 0;
  probe_.evaluate(probed, samples.data());
  for (std::size_t k = 0; k < count; ++k) {
    advance(request.places[group[k]->place], samples[k], curved, *group[k]);
  }
}

/** Takes a sample of the surface as the new nearest place, or shortens the step that led to it. */
void FootFinder::advance(const Vector3& place, const ProbeSample& sample, bool curved,
                         Walk& walk) const {
  const Vector3 off = subtract(place, sample.position);
  const bool nearer =
      sample.supported && (!walk.stands || dot(off, off) <= walk.distance_sq * (1 + 1e-9));
  if (!nearer) {
    walk.at_end = !sample.supported;
    walk.step = scaled(walk.step, 0.5);
    walk.done = !walk.stands || length(walk.step) < kConverged * walk.radius;
    walk.at = along(walk.last.position, 1, walk.step);
    return;
  }
  walk.stands = true;
  walk.at_end = false;
  walk.last = sample;
  walk.distance_sq = dot(off, off);
  walk.side = sample.normal;
  const double height = dot(off, sample.normal);
  const Vector3 tangential = along(off, -height, sample.normal);
  Vector3 step = curved ? curvedStep(tangential, height, sample.frame) : tangential;
  const double remaining = length(step);
  walk.done = walk.converged = remaining < kConverged * walk.radius;
  if (remaining > kLongestStep * walk.radius) {
    step = scaled(step, kLongestStep * walk.radius / remaining);
  }
  walk.step = step;
  walk.at = along(sample.position, 1, step);
}

SurfaceFoot FootFinder::footOf(const Vector3& place, const Walk& walk) {
  SurfaceFoot foot;
  foot.found = true;
  foot.border = !walk.stands || walk.at_end || walk.last.outside > 0.5;
  foot.position = walk.stands ? walk.last.position : walk.at;
  foot.normal = walk.stands ? walk.last.normal : walk.side;
  const Vector3 off = subtract(place, foot.position);
  const double height = dot(off, foot.normal);
  foot.distance = walk.converged ? height : std::copysign(length(off), height);
  if (walk.stands) foot.sigma = walk.last.errors.position;
  return foot;
}

}  // namespace pcl_slim::detail
