// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/canonical_order.h"
#include "octree/octree_grid.h"
#include "octree/point_blocks.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/parallel.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

/** Orders a cloud's points by the Morton codes of their cells, equal points once.
 *
 * Leading bits tell nearly all points of a scan apart: whole keys are made again for the others. */
template <typename T>
class KeyOrder {
 public:
  /** depth: of keys below root cells. */
  KeyOrder(const PointBlocks<T>& blocks, int depth, int threads)
      : blocks_(blocks), depth_(depth), threads_(threads)
  {
  }

  /** \param[out] keys ascending; below the leading bits they are 0 where those tell a point from all
   * others. \param[out] order the points they are of. */
  void run(CanonicalOrder<T> ties, AlignedVector<std::uint64_t>& keys,
           AlignedVector<std::uint32_t>& order) const
  {
    AlignedVector<std::uint32_t> finite;
    makeKeys(keys, finite);
    sortByLeadingBits(keys, order, threads_);
    if (!finite.empty()) {
      for (std::uint32_t& point : order) point = finite[point];
    }
    arrange(ties, tiedRuns(keys), keys, order);
  }

 private:
  /** Points that share their leading bits, and how many of them are kept. */
  struct Run {
    std::size_t begin, end, kept;
  };

  /** \param[out] finite the points the keys are of; empty where that is all. */
  void makeKeys(AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& finite) const
  {
    keys.resize(blocks_.count());
    if (!blocks_.allFinite()) finite.resize(keys.size());
    blocks_.forEach([&](std::size_t place, const PointBlock& block) {
      std::uint64_t part[PointBlock::kSize];
      splat_kernels::mortonKeys(block.x, block.y, block.z, PointBlock::kSize, depth_, part);
      std::copy_n(part, block.count, keys.data() + place);
      if (!finite.empty()) std::copy_n(block.index, block.count, finite.data() + place);
    });
  }

  std::vector<Run> tiedRuns(const AlignedVector<std::uint64_t>& keys) const
  {
    const std::size_t n = keys.size();
    std::vector<std::vector<Run>> parts((n + octree_grid::kSlice - 1) / octree_grid::kSlice);
    // A run belongs to the slice it begins in.
    octree_grid::forEachSlice(n, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && i + 1 < n; ++i) {
        if (keys[i] != keys[i + 1] || (i > 0 && keys[i] == keys[i - 1])) continue;
        std::size_t last = i + 1;
        while (last < n && keys[last] == keys[i]) ++last;
        parts[s].push_back({i, last, last - i});
      }
    });
    std::vector<Run> runs;
    for (const auto& part : parts) runs.insert(runs.end(), part.begin(), part.end());
    return runs;
  }

  void arrange(const CanonicalOrder<T>& ties, std::vector<Run> runs,
               AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& order) const
  {
    if (runs.empty()) return;
    std::vector<CanonicalOrder<T>> of_thread(static_cast<std::size_t>(threads_), ties);
    parallelFor(runs.size(), threads_, 64, [&](std::size_t r, int thread) {
      Run& run = runs[r];
      run.kept = of_thread[static_cast<std::size_t>(thread)].arrange(
          keys.data() + run.begin, order.data() + run.begin, run.end - run.begin);
    });
    // Those behind close the gaps of points that were not kept.
    runs.push_back({keys.size(), keys.size(), 0});
    std::size_t to = runs.front().begin;
    for (std::size_t r = 0; r + 1 < runs.size(); ++r) {
      const auto move = [&](std::size_t begin, std::size_t end) {
        if (to != begin) {
          std::copy(keys.data() + begin, keys.data() + end, keys.data() + to);
          std::copy(order.data() + begin, order.data() + end, order.data() + to);
        }
        to += end - begin;
      };
      move(runs[r].begin, runs[r].begin + runs[r].kept);
      move(runs[r].end, runs[r + 1].begin);
    }
    keys.resize(to);
    order.resize(to);
  }

  const PointBlocks<T>& blocks_;
  int depth_, threads_;
};

}  // namespace pcl_slim::detail
