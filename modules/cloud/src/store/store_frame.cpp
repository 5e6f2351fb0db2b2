// SPDX-License-Identifier: BSD-3-Clause
// A cloud as it is given, and the units of the store that is made of it.
#include "pcl_slim/cloud/store_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "store/store.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kTooMany =
    0xffffffffu;  ///< points are counted in 32 bits, one number is spare

}  // namespace

std::array<double, 3> CloudView::placeAt(const void* first, std::size_t offset, Scalar scalar) {
  const char* at = static_cast<const char*>(first) + offset;
  std::array<double, 3> place{};
  if (scalar == Scalar::kDouble) {
    std::memcpy(place.data(), at, sizeof(place));
  } else {
    std::array<float, 3> narrow{};
    std::memcpy(narrow.data(), at, sizeof(narrow));
    place = {narrow[0], narrow[1], narrow[2]};
  }
  return place;
}

std::array<float, 3> CloudView::givenNormal(std::size_t input) const {
  std::array<float, 3> given{};
  std::memcpy(given.data(), static_cast<const char*>(normal) + input * normal_stride,
              sizeof(given));
  return given;
}

Error CloudView::validate() const {
  const std::size_t n = count();
  if (n == 0 || xyz == nullptr) return badInput("the cloud has no points: give one that has");
  if (n >= kTooMany) return badInput("the cloud has more than 2^32 - 2 points: split it");
  for (std::size_t i = 0; indices != nullptr && i < n; ++i) {
    if (indices[i] < 0 || static_cast<std::size_t>(indices[i]) >= size) {
      return {ErrorCode::kBadArgument, "index " + std::to_string(indices[i]) +
                                           " lies outside the cloud of " + std::to_string(size) +
                                           " points"};
    }
  }
  return {};
}

Error CloudView::nothingFinite() {
  return badInput("every point of the cloud is NaN or infinite: nothing to work on");
}

namespace detail {

namespace {

/** At most 4096 places of a cloud: those whose hashes are the least, one of each hash, so that
 * neither the points' order nor their repetition changes anything. */
class PlaceSample {
 public:
  /** Offers a finite place. */
  void offer(const std::array<double, 3>& place);
  /** Offers the places of another part of the cloud. */
  void merge(PlaceSample& other);
  /** The places that are kept of those offered. */
  std::vector<std::array<double, 3>> places();
  /** The bulk of the cloud by the places offered so far. */
  Bulk bulk();

 private:
  struct Entry {
    std::uint64_t hash;
    std::array<double, 3> place;

    bool operator<(const Entry& other) const {
      return hash != other.hash ? hash < other.hash : place < other.place;
    }
    bool operator==(const Entry& other) const { return hash == other.hash; }
  };

  void offer(const Entry& entry);
  void shrink();

  std::vector<Entry> entries_;
  std::array<std::uint64_t, 1024> recent_{};  ///< what is there already, for points all alike
  std::uint64_t bound_ = std::numeric_limits<std::uint64_t>::max();
};

constexpr std::size_t kSample = 4096;
constexpr std::size_t kLeast = 8;  ///< fewest places in which a stray can be found
constexpr double kReach = 0x1p14;

/** Of a finite position; equal ones have equal hashes. */
std::uint64_t hashOf(const std::array<double, 3>& p) {
  std::uint64_t hash = 0x94d049bb133111ebu;  // what is zero throughout has a hash, too
  for (const double coordinate : p) {
    const double value = coordinate + 0.0;  // -0 is 0
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 32;
  }
  return hash * 0xbf58476d1ce4e5b9u;
}

double quantile(const std::vector<double>& values, double share) {
  return kthSmallest(
      values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5));
}

void PlaceSample::offer(const std::array<double, 3>& place) {
  offer({hashOf(place), place});
}

void PlaceSample::offer(const Entry& entry) {
  std::uint64_t& recent = recent_[entry.hash % recent_.size()];
  if (entry.hash >= bound_ || recent == entry.hash) return;
  recent = entry.hash;
  entries_.push_back(entry);
  if (entries_.size() == 2 * kSample) shrink();
}

void PlaceSample::merge(PlaceSample& other) {
  other.shrink();
  for (const Entry& entry : other.entries_) offer(entry);
}

void PlaceSample::shrink() {
  std::sort(entries_.begin(), entries_.end());
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
  if (entries_.size() < kSample) return;
  entries_.resize(kSample);
  bound_ = entries_.back().hash;
}

std::vector<std::array<double, 3>> PlaceSample::places() {
  shrink();
  std::vector<std::array<double, 3>> places;
  for (const Entry& entry : entries_) places.push_back(entry.place);
  return places;
}

Bulk PlaceSample::bulk() {
  shrink();
  Bulk bulk;
  if (entries_.size() < kLeast) return bulk;
  double between = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> column;
    for (const Entry& entry : entries_) column.push_back(entry.place[a]);
    bulk.median[a] = quantile(column, 0.5);
    between = std::hypot(between, quantile(column, 0.75) - quantile(column, 0.25));
  }
  if (between > 0) {
    bulk.between = between;
    bulk.reach = kReach * between;
  }
  return bulk;
}

}  // namespace

Bulk findBulk(const CloudView& cloud, const CloudReader& reader, int threads) {
  const std::size_t n = cloud.count(), slices = (n + kSlice - 1) / kSlice;
  const auto most = static_cast<std::size_t>(resolveThreads(threads));
  const auto workers = static_cast<int>(std::clamp<std::size_t>(slices, 1, most));
  std::vector<PlaceSample> parts(static_cast<std::size_t>(workers));
  parallelFor(slices, workers, 1, [&](std::size_t s, int thread) {
    for (std::size_t i = s * kSlice; i < std::min(n, (s + 1) * kSlice); ++i) {
      const auto p = reader.position(cloud.inputIndex(i));
      if (isFinite(p)) parts[static_cast<std::size_t>(thread)].offer(p);
    }
  });
  PlaceSample all;
  for (PlaceSample& part : parts) all.merge(part);
  return all.bulk();
}

namespace {

CloudSummary summarize(const CloudView& cloud, const CloudReader& reader, std::size_t begin,
                       std::size_t end, const Bulk& bulk, bool need_normal) {
  CloudSummary sum;
  Bounds box;
  std::size_t finite = 0, near = 0, with_normal = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t input = cloud.inputIndex(i);
    const auto p = reader.position(input);
    if (!isFinite(p)) continue;
    ++finite;
    if (!bulk.holds(p)) continue;
    ++near;
    const bool has_normal = cloud.normal != nullptr && reader.hasNormal(input);
    with_normal += has_normal;
    if (!has_normal && need_normal) continue;
    box.add(p);
  }
  sum.min = box.low;
  sum.max = box.high;
  sum.finite = finite;
  sum.near = near;
  sum.with_normal = with_normal;
  return sum;
}

}  // namespace

void CloudSummary::add(const CloudSummary& other) {
  for (std::size_t a = 0; a < 3; ++a) {
    min[a] = std::min(min[a], other.min[a]);
    max[a] = std::max(max[a], other.max[a]);
  }
  finite += other.finite;
  near += other.near;
  with_normal += other.with_normal;
}

CloudSummary summarizeAll(const CloudView& cloud, const CloudReader& reader, const Bulk& bulk,
                          bool need_normal, int threads) {
  const std::size_t n = cloud.count();
  const std::size_t slices = (n + kSlice - 1) / kSlice;
  std::vector<CloudSummary> parts(slices);
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    parts[s] =
        summarize(cloud, reader, s * kSlice, std::min(n, (s + 1) * kSlice), bulk, need_normal);
  });
  CloudSummary all;
  for (const CloudSummary& part : parts) all.add(part);
  return all;
}

namespace {

constexpr double kOriginGrid = 0x1p-10;    ///< the origin is a multiple of this share of the scale
constexpr double kLeastScale = 0x1p-1000;  ///< its inverse, and 2^-22 of it, are normal numbers

}  // namespace

Error setUnits(const std::array<double, 3>& low, const std::array<double, 3>& high,
               const Bulk& bulk, double least_span, StoreFrame& frame) {
  double half[3], farthest = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    half[a] = 0.5 * high[a] - 0.5 * low[a];
    frame.origin[a] = low[a] + half[a];
    farthest = std::max(farthest, std::abs(frame.origin[a]));
  }
  const double diagonal = 2.0 * std::hypot(half[0], half[1], half[2]);
  // The slack keeps coordinates inside [-1/2, 1/2] once the origin is rounded to its grid.
  const double one_place = std::max(farthest * 0x1p-20, 0x1p-100);
  const double span = std::max(diagonal > 0 ? diagonal : one_place, least_span);
  frame.scale = std::exp2(std::ceil(std::log2(span * (1.0 + 4 * kOriginGrid))));
  if (!std::isfinite(frame.scale)) {
    return {ErrorCode::kBadInput,
            "some coordinates come near the largest number there is: remove those points"};
  }
  if (frame.scale < kLeastScale) {
    return {
        ErrorCode::kBadInput,
        "the points differ by less than 1e-301, too little to compute with: give coordinates in a "
        "smaller unit"};
  }
  frame.diagonal = diagonal / frame.scale;
  constexpr double kQuartiles =
      4.0;  // of points spread evenly L is twice as wide as their quartiles
  frame.bulk_diagonal = std::min(frame.diagonal, kQuartiles * bulk.between / frame.scale);
  const double origin_grid = frame.scale * kOriginGrid;
  for (double& o : frame.origin) o = std::round(o / origin_grid) * origin_grid;
  const double reach = farthest / frame.scale + 0.5 + kOriginGrid;
  if (reach < kFarOrigin)
    frame.center_grid = std::max(0x1p-22, std::exp2(std::ceil(std::log2(reach)) - 24));
  frame.bulk_center = bulk.median;
  frame.bulk_between = bulk.between;
  frame.bulk_reach = bulk.reach;
  return {};
}

struct FrameMeasure::State {
  std::vector<PlaceSample> parts;  ///< one a thread
  Bulk bulk;                       ///< of the first pass: everything
  CloudSummary summary;            ///< of the pass under way
  std::uint64_t input = 0;
  bool need_normal = false;
  int passes = 0;
};

FrameMeasure::FrameMeasure() : state_(std::make_unique<State>()) {}
FrameMeasure::~FrameMeasure() = default;

void FrameMeasure::add(const CloudView& piece, int threads) {
  State& s = *state_;
  const CloudReader reader(piece);
  s.summary.add(summarizeAll(piece, reader, s.bulk, s.need_normal, threads));
  if (s.passes > 0) return;
  s.input += piece.count();
  s.parts.resize(static_cast<std::size_t>(threads));
  const std::size_t slices = s.parts.size(), n = piece.count();
  parallelFor(slices, threads, 1, [&](std::size_t slice, int) {
    for (std::size_t i = slice * n / slices; i < (slice + 1) * n / slices; ++i) {
      const auto p = reader.position(piece.inputIndex(i));
      if (isFinite(p)) s.parts[slice].offer(p);
    }
  });
}

std::vector<unsigned char> FrameMeasure::packed() {
  State& s = *state_;
  PlaceSample sample;
  for (PlaceSample& part : s.parts) sample.merge(part);
  const std::vector<std::array<double, 3>> places = sample.places();
  const std::size_t head = sizeof(s.input) + sizeof(s.summary),
                    rest = places.size() * sizeof(places[0]);
  std::vector<unsigned char> bytes(head + rest);
  std::memcpy(bytes.data(), &s.input, sizeof(s.input));
  std::memcpy(bytes.data() + sizeof(s.input), &s.summary, sizeof(s.summary));
  if (rest > 0) std::memcpy(bytes.data() + head, places.data(), rest);
  return bytes;
}

void FrameMeasure::merge(const std::vector<std::vector<unsigned char>>& parts) {
  State& s = *state_;
  std::uint64_t input = 0;
  PlaceSample all;
  s.summary = {};
  for (const std::vector<unsigned char>& bytes : parts) {
    std::uint64_t points;
    CloudSummary summary;
    std::memcpy(&points, bytes.data(), sizeof(points));
    std::memcpy(&summary, bytes.data() + sizeof(points), sizeof(summary));
    input += points;
    s.summary.add(summary);
    std::array<double, 3> place;
    for (std::size_t at = sizeof(points) + sizeof(summary); at < bytes.size();
         at += sizeof(place)) {
      std::memcpy(&place, bytes.data() + at, sizeof(place));
      all.offer(place);
    }
  }
  if (s.passes > 0) return;  // only the first one counts the input and samples places
  s.input = input;
  s.parts.assign(1, all);
}

bool FrameMeasure::needsAnotherPass() {
  State& s = *state_;
  ++s.passes;
  const CloudSummary& all = s.summary;
  const bool some_normals = all.with_normal > 0 && all.with_normal < all.near;
  bool again = some_normals && !s.need_normal;
  if (s.passes == 1) {
    PlaceSample places;
    for (PlaceSample& part : s.parts) places.merge(part);
    s.bulk = places.bulk();
    again = again || (all.finite > 0 && !(s.bulk.holds(all.min) && s.bulk.holds(all.max)));
  }
  if (!again) return false;
  s.need_normal = some_normals;
  s.summary = {};
  return true;
}

Error FrameMeasure::finish(StoreFrame& frame, FrameCounts& counts) const {
  const CloudSummary& all = state_->summary;
  if (all.near == 0) return CloudView::nothingFinite();
  frame.with_normals = all.with_normal > 0;
  counts = {state_->input, all.finite, all.near, all.with_normal,
            frame.with_normals ? all.with_normal : all.near};
  return setUnits(all.min, all.max, state_->bulk, 0.0, frame);
}

}  // namespace detail

namespace {

constexpr double kGrid =
    4.0;  ///< [scale]: what is left is below 4, so that 2^-22 of it is a float's step

}  // namespace

std::array<double, 3> fileShift(const std::array<double, 3>& origin, double scale) {
  double farthest = 0;
  for (const double o : origin) farthest = std::max(farthest, std::abs(o) / scale);
  if (farthest < detail::kFarOrigin - 1) return {};
  std::array<double, 3> shift;
  for (std::size_t a = 0; a < 3; ++a)
    shift[a] = std::round(origin[a] / (kGrid * scale)) * (kGrid * scale);
  return shift;
}

std::array<double, 3> fileShift(const std::array<double, 3>& low,
                                const std::array<double, 3>& high) {
  StoreFrame frame;
  if (detail::setUnits(low, high, {}, 0, frame)) return {};
  return fileShift(frame.origin, frame.scale);
}

std::array<double, 3> fileShift(const CloudView& cloud) {
  Bounds box;
  for (std::size_t k = 0; k < cloud.count(); ++k) {
    const auto p = cloud.position(cloud.inputIndex(k));
    if (isFinite(p)) box.add(p);
  }
  return box.low[0] <= box.high[0] ? fileShift(box.low, box.high) : std::array<double, 3>{};
}

std::vector<std::int32_t> withoutStrays(const CloudView& cloud, int threads) {
  const std::size_t n = cloud.count();
  if (cloud.validate() || n > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    return {};
  const detail::CloudReader reader(cloud);
  const detail::Bulk bulk = detail::findBulk(cloud, reader, threads);
  if (!std::isfinite(bulk.reach)) return {};
  std::vector<std::int32_t> kept(n);
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t input = cloud.inputIndex(i);
    const std::array<double, 3> p = reader.position(input);
    if (isFinite(p) && !bulk.holds(p)) continue;
    kept[count++] = static_cast<std::int32_t>(input);
  }
  kept.resize(count == n ? 0 : count);
  return kept;
}

}  // namespace pcl_slim
