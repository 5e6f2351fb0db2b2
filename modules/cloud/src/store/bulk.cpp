// SPDX-License-Identifier: BSD-3-Clause
#include "store/bulk.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSample = 4096;
constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time
constexpr std::size_t kLeast = 8;  ///< places, below which nothing tells a stray from the others
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

/** The points whose hashes are the least, one of each hash. */
class LeastHashes {
 public:
  struct Entry {
    std::uint64_t hash;
    std::size_t point;

    bool operator<(const Entry& other) const
    {
      return hash != other.hash ? hash < other.hash : point < other.point;
    }
    bool operator==(const Entry& other) const { return hash == other.hash; }
  };

  void offer(const Entry& entry)
  {
    std::uint64_t& recent = recent_[entry.hash % kRecent];
    if (entry.hash >= bound_ || recent == entry.hash) return;
    recent = entry.hash;
    entries_.push_back(entry);
    if (entries_.size() == 2 * kSample) shrink();
  }

  const std::vector<Entry>& entries()
  {
    shrink();
    return entries_;
  }

 private:
  static constexpr std::size_t kRecent = 1024;

  void shrink()
  {
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
    if (entries_.size() < kSample) return;
    entries_.resize(kSample);
    bound_ = entries_.back().hash;
  }

  std::vector<Entry> entries_;
  std::array<std::uint64_t, kRecent> recent_{};  ///< what is there already, for points all alike
  std::uint64_t bound_ = std::numeric_limits<std::uint64_t>::max();
};

bool
isFinite(const std::array<double, 3>& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

std::vector<LeastHashes::Entry>
samplePlaces(const CloudView& cloud, const CloudReader& reader, int threads)
{
  const std::size_t n = cloud.count(), slices = (n + kSlice - 1) / kSlice;
  const auto most = static_cast<std::size_t>(resolveThreads(threads));
  const auto workers = static_cast<int>(std::clamp<std::size_t>(slices, 1, most));
  std::vector<LeastHashes> least(static_cast<std::size_t>(workers));
  parallelFor(slices, workers, 1, [&](std::size_t s, int thread) {
    for (std::size_t i = s * kSlice; i < std::min(n, (s + 1) * kSlice); ++i) {
      const auto p = reader.position(cloud.inputIndex(i));
      if (isFinite(p)) least[static_cast<std::size_t>(thread)].offer({hashOf(p), i});
    }
  });
  LeastHashes all;
  for (LeastHashes& part : least) {
    for (const LeastHashes::Entry& entry : part.entries()) all.offer(entry);
  }
  return all.entries();
}

double
quantile(std::vector<double>& values, double share)
{
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

Bulk
findBulk(const CloudView& cloud, const CloudReader& reader, int threads)
{
  Bulk bulk;
  std::vector<double> columns[3];
  for (const LeastHashes::Entry& entry : samplePlaces(cloud, reader, threads)) {
    const auto p = reader.position(cloud.inputIndex(entry.point));
    for (std::size_t a = 0; a < 3; ++a) columns[a].push_back(p[a]);
  }
  if (columns[0].size() < kLeast) return bulk;
  double between = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    bulk.median[a] = quantile(columns[a], 0.5);
    between = std::hypot(between, quantile(columns[a], 0.75) - quantile(columns[a], 0.25));
  }
  if (between > 0) {
    bulk.between = between;
    bulk.reach = kReach * between;
  }
  return bulk;
}

}  // namespace pcl_slim::detail
