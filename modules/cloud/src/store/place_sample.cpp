// SPDX-License-Identifier: BSD-3-Clause
#include "store/place_sample.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSample = 4096;
constexpr std::size_t kLeast = 8;  ///< fewest places in which a stray can be found
constexpr double kReach = 0x1p14;

/** Of a finite position; equal ones have equal hashes. */
std::uint64_t
hashOf(const std::array<double, 3>& p)
{
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

double
quantile(const std::vector<double>& values, double share)
{
  return kthSmallest(
      values, static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5));
}

}  // namespace

void
PlaceSample::offer(const std::array<double, 3>& place)
{
  offer({hashOf(place), place});
}

void
PlaceSample::offer(const Entry& entry)
{
  std::uint64_t& recent = recent_[entry.hash % recent_.size()];
  if (entry.hash >= bound_ || recent == entry.hash) return;
  recent = entry.hash;
  entries_.push_back(entry);
  if (entries_.size() == 2 * kSample) shrink();
}

void
PlaceSample::merge(PlaceSample& other)
{
  other.shrink();
  for (const Entry& entry : other.entries_) offer(entry);
}

void
PlaceSample::shrink()
{
  std::sort(entries_.begin(), entries_.end());
  entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
  if (entries_.size() < kSample) return;
  entries_.resize(kSample);
  bound_ = entries_.back().hash;
}

std::vector<std::array<double, 3>>
PlaceSample::places()
{
  shrink();
  std::vector<std::array<double, 3>> places;
  for (const Entry& entry : entries_) places.push_back(entry.place);
  return places;
}

Bulk
PlaceSample::bulk()
{
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

}  // namespace pcl_slim::detail
