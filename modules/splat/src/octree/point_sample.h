// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "octree/octree_grid.h"

namespace pcl_slim::detail {

/** Some of a cloud's places, drawn by a hash of their coordinates: neither the order of the points nor
 * how often one is given changes which. Their hashes also tell how many distinct places there are. */
class PlaceSample {
 public:
  static constexpr std::size_t kMost = std::size_t{1} << 15;  ///< places that suffice for a grid

  /** finite: points that are. */
  template <typename T>
  PlaceSample(const octree_grid::Reader<T>& read, std::size_t n, std::size_t finite, int threads)
  {
    int shift = 0;
    while (finite >> shift > 4 * kMost) ++shift;
    collect(read, n, shift, threads);
    if (shift > 0 && drawn_.size() < kMost) collect(read, n, 0, threads);  // many are repeated
    distinct_ = static_cast<double>(drawn_.size());
    if (drawn_.size() < kMost) return;
    // The k-th smallest of m hashes spread evenly lies at k / m (Bar-Yossef et al. 2002).
    drawn_.resize(kMost);
    distinct_ =
        static_cast<double>(kMost - 1) / (static_cast<double>(drawn_.back().first) * 0x1p-64);
  }

  /** Distinct places: exact for fewer than kMost, else within about 1 %. */
  double distinct() const { return distinct_; }
  std::size_t size() const { return drawn_.size(); }
  /** A point at the k-th place drawn. */
  std::size_t point(std::size_t k) const { return drawn_[k].second; }

 private:
  using Drawn = std::pair<std::uint64_t, std::uint32_t>;  ///< hash and point

  static std::uint64_t mixed(std::uint64_t x)
  {
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ x >> 27) * 0x94d049bb133111ebULL;
    return x ^ x >> 31;
  }

  template <typename T>
  static std::uint64_t hashOf(const T p[3])
  {
    std::uint64_t hash = 0;
    for (int a = 0; a < 3; ++a) {
      const double value = static_cast<double>(p[a]) + 0.0;  // -0 is 0
      std::uint64_t bits;
      std::memcpy(&bits, &value, sizeof(bits));
      hash = (hash ^ bits ^ bits >> 32) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 29;
    }
    return mixed(hash);
  }

  /** Draws the places whose hashes begin with so many zeros, by hash, each once. */
  template <typename T>
  void collect(const octree_grid::Reader<T>& read, std::size_t n, int zeros, int threads)
  {
    std::vector<std::vector<Drawn>> parts((n + octree_grid::kSlice - 1) / octree_grid::kSlice);
    octree_grid::forEachSlice(n, threads, [&](std::size_t s, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        T p[3];
        read(i, p);
        if (!octree_grid::isFinite(p)) continue;
        const std::uint64_t hash = hashOf(p);
        if (zeros > 0 && hash >> (64 - zeros) != 0) continue;
        parts[s].emplace_back(hash, static_cast<std::uint32_t>(i));
      }
    });
    drawn_.clear();
    for (const auto& part : parts) drawn_.insert(drawn_.end(), part.begin(), part.end());
    std::sort(drawn_.begin(), drawn_.end());
    const auto same = [](const Drawn& a, const Drawn& b) { return a.first == b.first; };
    drawn_.erase(std::unique(drawn_.begin(), drawn_.end(), same), drawn_.end());
  }

  std::vector<Drawn> drawn_;
  double distinct_ = 0;
};

}  // namespace pcl_slim::detail
