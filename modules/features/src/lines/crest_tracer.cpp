// SPDX-License-Identifier: BSD-3-Clause
#include "lines/crest_tracer.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::detail {

namespace {

constexpr double kSeedGap = 0.9;    ///< seeds nearer to a line are left out [steps]
constexpr double kCell = 8.0;       ///< of the reach: cells in which vertices are looked up
constexpr double kJoinGap = 0.5;    ///< lines nearer to each other become one [steps]
constexpr double kSeedShare = 0.5;  ///< of the significance: seeds are a little off their line
constexpr std::int64_t kMiddle = std::int64_t{1} << 32;
constexpr std::int64_t kOwnGap = 8;  ///< own vertices this many steps back count as another line's
constexpr std::size_t kChunk = CrestField::kMostVertices;
constexpr std::size_t kMostSteps = 1000000;

}  // namespace

void PlaceGrid::clear() {
  ++age_;
  used_ = 0;
  entries_.clear();
  links_.clear();
}

void PlaceGrid::cellOf(const Vector3& place, std::int64_t (&cell)[3]) const {
  for (std::size_t a = 0; a < 3; ++a) {
    cell[a] = static_cast<std::int64_t>(std::floor(place[a] * inverse_));
  }
}

std::uint64_t PlaceGrid::keyOf(const std::int64_t (&cell)[3]) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  return (static_cast<std::uint64_t>(cell[0]) & kMask) << 42 |
         (static_cast<std::uint64_t>(cell[1]) & kMask) << 21 |
         (static_cast<std::uint64_t>(cell[2]) & kMask);
}

std::size_t PlaceGrid::slotOf(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t at = (key * 0x9e3779b97f4a7c15ULL >> 32) & mask;
  while (slots_[at].age == age_ && slots_[at].key != key) at = (at + 1) & mask;
  return at;
}

std::uint32_t PlaceGrid::headOf(std::uint64_t key) const {
  const Slot& slot = slots_[slotOf(key)];
  return slot.age == age_ ? slot.head : kNone;
}

void PlaceGrid::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.age == age_) slots_[slotOf(slot.key)] = slot;
  }
}

void PlaceGrid::add(const Vector3& place, double reach, std::int64_t number) {
  const auto entry = static_cast<std::uint32_t>(entries_.size());
  entries_.push_back({place, reach * reach, number});
  std::int64_t low[3], high[3], cell[3];
  cellOf(subtract(place, {reach, reach, reach}), low);
  cellOf(subtract(place, {-reach, -reach, -reach}), high);
  for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0]) {
    for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1]) {
      for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) {
        if (2 * used_ >= slots_.size()) grow();
        const std::uint64_t key = keyOf(cell);
        Slot& slot = slots_[slotOf(key)];
        if (slot.age != age_) {
          slot = {key, kNone, age_};
          ++used_;
        }
        links_.push_back({entry, slot.head});
        slot.head = static_cast<std::uint32_t>(links_.size() - 1);
      }
    }
  }
}

CrestTracer::CrestTracer(const ProbeIndex& index, CrestType type, const CrestParams& params,
                         const CurvatureNoise& noise, bool analytic, double mean_radius)
    : params_(params),
      field_(index, type, analytic),
      stepper_(field_, params.step),
      noise_(noise),
      mean_radius_(mean_radius),
      traced_(kCell * reachOf(mean_radius)),
      refused_(kCell * reachOf(mean_radius)),
      own_(kCell * reachOf(mean_radius)) {}

/** How far a vertex or a seed keeps other seeds away. */
double CrestTracer::reachOf(double radius) const {
  return kSeedGap * params_.step * radius;
}

CrestStatistics CrestTracer::statistics() const {
  CrestStatistics s = statistics_;
  s.requests = field_.numRequests();
  return s;
}

bool CrestTracer::refuse(const CrestSeed& seed, std::uint64_t& counter) {
  ++counter;
  refused_.add(seed.position, reachOf(seed_radius_), 0);
  return false;
}

void CrestTracer::follow(const CrestSeed& seed) {
  ++statistics_.seeds;
  if (traced_.holds(seed.position, 1) || refused_.holds(seed.position, 1)) {
    ++statistics_.seeds_on_lines;
    return;
  }
  field_.restart(mean_radius_);
  const ProbeScale scale = field_.scaleAt(seed.position, seed.normal);
  seed_radius_ = scale.radius;
  if (!(seed_radius_ > 0)) {
    ++statistics_.seeds_failed;
    return;
  }
  CrestVertex first;
  if (!begin(seed, scale, first)) return;
  if (traced_.holds(first.position, kJoinGap / kSeedGap)) {
    refuse(seed, statistics_.seeds_on_lines);
    return;
  }
  own_.clear();
  own_.add(first.position, reachOf(first.radius), kMiddle);
  std::vector<CrestVertex> forward = {first}, backward = {first};
  const End end = walk(forward, true);
  count(end);
  if (end != End::kClosed) count(walk(backward, false));
  keep(std::move(forward), backward, end == End::kClosed);
  // A seed next to a line that begins a little away would otherwise be followed again and again.
  refused_.add(seed.position, reachOf(seed_radius_), 0);
}

/** The line's vertex next to a seed, if noise cannot explain the seed by itself. */
bool CrestTracer::begin(const CrestSeed& seed, const ProbeScale& scale, CrestVertex& first) {
  CrestVertex v;
  v.position = seed.position;
  v.normal = seed.normal;
  v.t = normalized(along(seed.t, -dot(seed.t, seed.normal), seed.normal));
  v.k = seed.k;
  v.radius = scale.radius;
  v.reach = CrestField::reachAt(v);
  CrestSample samples[3];
  field_.sampleSeed(v, samples);
  const double z = noise_.significance(v.prominence, scale.radius, scale.equivalent_count);
  if (!(z >= kSeedShare * params_.significance)) {
    return refuse(seed, statistics_.seeds_insignificant);
  }
  return stepper_.start(v, samples, first) || refuse(seed, statistics_.seeds_failed);
}

/** One vertex more. \param[in] number of it among the line's own, counted both ways from the first.
 */
CrestTracer::End CrestTracer::advance(std::vector<CrestVertex>& line, std::int64_t number) {
  CrestVertex next;
  if (!stepper_.advance(line, next)) return End::kLost;
  constexpr double kShare = kJoinGap / kSeedGap;
  const std::int64_t other =
      traced_.nearest(next.position, kShare, [](std::int64_t) { return true; });
  if (other != PlaceGrid::kNothing) {
    line.push_back(vertices_[static_cast<std::size_t>(other)]);
    return End::kJoined;
  }
  const std::int64_t own = own_.nearest(
      next.position, kShare, [&](std::int64_t n) { return std::abs(n - number) > kOwnGap; });
  if (own != PlaceGrid::kNothing) return std::abs(own - kMiddle) <= 2 ? End::kClosed : End::kJoined;
  own_.add(next.position, reachOf(next.radius), number);
  line.push_back(next);
  return End::kGoesOn;
}

CrestTracer::End CrestTracer::walk(std::vector<CrestVertex>& line, bool forward) {
  if (!forward) {
    stepper_.forget();
    line.front().ahead = scaled(line.front().ahead, -1.0);
  }
  std::size_t measured = forward ? 0 : 1;  // they share their first
  for (std::size_t i = 1; i < kMostSteps; ++i) {
    const auto offset = static_cast<std::int64_t>(i);
    const End end = advance(line, forward ? kMiddle + offset : kMiddle - offset);
    if (end != End::kGoesOn) {
      measure(line, measured, line.size());
      return end;
    }
    if (line.size() == measured + kChunk) {
      if (faded(line, measured)) return End::kFaded;
      measured = line.size();
    }
  }
  return End::kLost;
}

void CrestTracer::measure(std::vector<CrestVertex>& line, std::size_t begin, std::size_t end) {
  for (; begin < end; begin += kChunk) {
    const std::size_t some = std::min(kChunk, end - begin);
    field_.findProminence(line.data() + begin, some);
    for (std::size_t i = begin; i < begin + some; ++i) {
      CrestVertex& v = line[i];
      v.significance = noise_.significance(v.prominence, v.radius, v.equivalent_count);
    }
  }
}

/** Measures the last vertices. \return whether they are noise on average: a continuation has seeds
 * of its own if it is significant again. */
bool CrestTracer::faded(std::vector<CrestVertex>& line, std::size_t begin) {
  measure(line, begin, line.size());
  double sum = 0;
  for (std::size_t i = begin; i < line.size(); ++i) sum += line[i].significance;
  return sum < params_.significance * static_cast<double>(line.size() - begin);
}

void CrestTracer::count(End end) {
  switch (end) {
    case End::kJoined: ++statistics_.joined; return;
    case End::kLost: ++statistics_.ended; return;
    case End::kFaded: ++statistics_.faded; return;
    default: return;
  }
}

void CrestTracer::keep(std::vector<CrestVertex> forward, const std::vector<CrestVertex>& backward,
                       bool closed) {
  ++statistics_.traced;
  TracedLine line;
  line.closed = closed;
  for (std::size_t i = backward.size(); i-- > 1;) {
    line.vertices.push_back(backward[i]);
    line.vertices.back().ahead = scaled(line.vertices.back().ahead, -1.0);
  }
  line.vertices.insert(line.vertices.end(), forward.begin(), forward.end());
  for (const CrestVertex& v : line.vertices) {
    traced_.add(v.position, reachOf(v.radius), static_cast<std::int64_t>(vertices_.size()));
    vertices_.push_back(v);
  }
  lines_.push_back(std::move(line));
}

}  // namespace pcl_slim::detail
