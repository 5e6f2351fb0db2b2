// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/knn.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim {

using namespace detail;

namespace {

using Keys = AlignedVector<std::uint64_t>;

constexpr float kEverywhere = 1e29f;    ///< squared; points are within 1, padding far beyond
constexpr std::size_t kManyKeys = 128;  ///< are sorted by digits
constexpr int kDigits = 4;              ///< of 8 bits, those of the distance
constexpr std::size_t kAround = 8;      ///< blocks that a small ball meets at its rim
constexpr std::size_t kManyBlocks =
    4;  ///< times the expected ones, for which a distance is too far

/** Distance and point in one number; distances are not negative, so their bits order them. */
std::uint64_t keyOf(float distance_sq, std::uint32_t point) {
  std::uint32_t bits;
  std::memcpy(&bits, &distance_sq, sizeof(bits));
  return static_cast<std::uint64_t>(bits) << 32 | point;
}

float distanceOf(std::uint64_t key) {
  const auto bits = static_cast<std::uint32_t>(key >> 32);
  float distance_sq;
  std::memcpy(&distance_sq, &bits, sizeof(bits));
  return distance_sq;
}

/** Sorts keys whose points ascend: counting passes over the distances' digits. */
void sortByDistance(Keys& keys, Keys& spare) {
  std::array<std::array<std::uint32_t, 256>, kDigits> counts{};
  const auto digit = [](std::uint64_t key, int k) { return key >> (32 + 8 * k) & 255u; };
  for (const std::uint64_t key : keys) {
    for (int k = 0; k < kDigits; ++k) ++counts[k][digit(key, k)];
  }
  spare.resize(keys.size());
  for (int k = 0; k < kDigits; ++k) {
    auto& count = counts[k];
    if (count[digit(keys.front(), k)] == keys.size()) continue;
    std::uint32_t begin = 0;
    for (std::uint32_t& c : count) {
      const std::uint32_t own = c;
      c = begin;
      begin += own;
    }
    for (const std::uint64_t key : keys) spare[count[digit(key, k)]++] = key;
    keys.swap(spare);
  }
}

/** Keeps the k least keys, in order; points ascend in what is given. */
void keepLeast(std::size_t k, Keys& keys, Keys& spare) {
  if (k < keys.size()) {
    spare = keys;
    const auto last = spare.begin() + static_cast<std::ptrdiff_t>(k - 1);
    std::nth_element(spare.begin(), last, spare.end());
    const std::uint64_t limit = *last;
    keys.erase(std::remove_if(keys.begin(), keys.end(),
                              [limit](std::uint64_t key) { return key > limit; }),
               keys.end());
  }
  if (k < kManyKeys) {
    std::sort(keys.begin(), keys.end());
  } else {
    sortByDistance(keys, spare);
  }
}

}  // namespace

/** Collects the points of the blocks at hand within a distance of a centre. */
void NeighborSearch::collect(const std::array<double, 3>& center, float limit_sq) {
  const std::size_t most = (blocks_.size() + 1) * PointStore::kBlock;
  distances_sq_.resize(most);
  points_.resize(most);
  std::size_t count = kernels::pointsUpTo(store_, blocks_.data(), blocks_.size(), center.data(),
                                          limit_sq, distances_sq_.data(), points_.data());
  if (stride_ > 1) count = dropUnsampled(count);
  distances_sq_.resize(count);
  points_.resize(count);
}

/** Keeps the sampled ones of the first collected points. \return how many are left. */
std::size_t NeighborSearch::dropUnsampled(std::size_t count) {
  const auto stride = static_cast<std::uint32_t>(stride_);
  std::size_t kept = 0;
  for (std::size_t j = 0; j < count; ++j) {
    distances_sq_[kept] = distances_sq_[j];
    const std::uint32_t point = points_[kept] = points_[j];
    kept += point % stride == 0;
  }
  return kept;
}

/** Squared distance that certainly contains k points: that of the k-th among the points of
 * the blocks before and after i in Morton order. */
float NeighborSearch::boundRadiusSq(std::size_t i, std::size_t k,
                                    const std::array<double, 3>& center) {
  const std::size_t blocks = store_.numBlocks();
  const std::size_t own = i / PointStore::kBlock;
  const std::size_t points = k * stride_;
  const std::size_t side = points / PointStore::kBlock + 1;
  std::size_t first = own > side ? own - side : 0;
  const std::size_t last = std::min(blocks - 1, own + side);
  while (first > 0 && (last - first) * PointStore::kBlock < points) --first;
  blocks_.clear();
  for (std::size_t b = first; b <= last; ++b) blocks_.push_back(static_cast<std::uint32_t>(b));
  collect(center, kEverywhere);
  return kernels::kthSmallest(distances_sq_.data(), distances_sq_.size(),
                              std::min(k, distances_sq_.size()));
}

/** Finds the blocks that may have points within a distance of a centre, in stored order. */
void NeighborSearch::findBlocks(const std::array<double, 3>& center, float limit_sq) {
  const float c[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                      static_cast<float>(center[2])};
  // The margin covers the rounding of centre and boxes to float.
  const float radius = std::sqrt(limit_sq) * 1.000001f + 1e-7f;
  blocks_.clear();
  store_.tree().blocksInBall(c, radius, blocks_);
}

/** Collects points among which the k nearest are, in stored order. \return k, or how many there
 * are. */
std::size_t NeighborSearch::collectNearest(std::size_t i, std::size_t k, float about) {
  k = std::min(k, (store_.size() + stride_ - 1) / stride_);
  if (k == 0) return 0;
  const auto center = store_.position(i);
  if (about > 0) {
    findBlocks(center, about);
    // Next to a stray point, a distance like its own contains much of a cloud.
    if (blocks_.size() <= kManyBlocks * (k * stride_ / PointStore::kBlock + kAround)) {
      collect(center, about);
      if (points_.size() >= k) return k;
    }
  }
  const float bound_sq = boundRadiusSq(i, k, center);
  findBlocks(center, bound_sq);
  collect(center, bound_sq);
  return k;
}

void NeighborSearch::nearest(std::size_t i, std::size_t k, std::vector<std::uint32_t>& neighbors,
                             std::vector<float>& distances_sq, float about) {
  k = collectNearest(i, k, about);
  neighbors.resize(k);
  distances_sq.resize(k);
  if (k == 0) return;
  keys_.resize(points_.size());
  for (std::size_t j = 0; j < keys_.size(); ++j) keys_[j] = keyOf(distances_sq_[j], points_[j]);
  keepLeast(k, keys_, spare_);
  for (std::size_t j = 0; j < k; ++j) {
    distances_sq[j] = distanceOf(keys_[j]);
    neighbors[j] = static_cast<std::uint32_t>(keys_[j]);
  }
}

float NeighborSearch::nearestSet(std::size_t i, std::size_t k,
                                 std::vector<std::uint32_t>& neighbors, float about) {
  k = collectNearest(i, k, about);
  neighbors.resize(k == 0 ? 0 : points_.size() + PointStore::kBlock);
  if (k == 0) return 0;
  const float limit = kernels::kthSmallest(distances_sq_.data(), distances_sq_.size(), k);
  const std::size_t count = kernels::valuesUpTo(distances_sq_.data(), points_.data(),
                                                points_.size(), limit, neighbors.data());
  neighbors.resize(count);
  if (count == k) return limit;
  // Of the points as far as the last one, those first in order.
  neighbors.clear();
  const auto isNearer = [limit](float d_sq) { return d_sq < limit; };
  auto ties = static_cast<std::ptrdiff_t>(k) -
              std::count_if(distances_sq_.begin(), distances_sq_.end(), isNearer);
  for (std::size_t j = 0; j < points_.size(); ++j) {
    if (distances_sq_[j] < limit || (distances_sq_[j] == limit && ties-- > 0))
      neighbors.push_back(points_[j]);
  }
  return limit;
}

}  // namespace pcl_slim
