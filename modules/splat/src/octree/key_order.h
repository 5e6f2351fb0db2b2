// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "octree/point_blocks.h"
#include "pcl_slim/cloud/morton_sort.h"

/** \brief The order of an octree's points. */
namespace pcl_slim::detail {

/** Orders points with equal leading bits of keys by their whole keys and then by their attributes,
 * and keeps one of those that are equal in place, normal and colour, so that nothing depends on the
 * order in which their owner has them. One per thread: it keeps its scratch memory. */
template <typename T>
class CanonicalOrder {
 public:
  CanonicalOrder(const CloudView& cloud, const ColorView& colors, const Reader<T>& read,
                 const PointBlocks<T>& blocks, int depth)
      : cloud_(cloud), colors_(colors), read_(read), blocks_(blocks), depth_(depth) {}

  /** Brings n points and their keys into that order, those kept to the front. \return how many */
  std::size_t arrange(std::uint64_t* keys, std::uint32_t* points, std::size_t n) {
    entries_.clear();
    for (std::size_t first = 0; first < n; first += PointBlock::kSize) {
      addEntries(points + first, std::min(PointBlock::kSize, n - first));
    }
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      keys[i] = entries_[i].key;
      points[i] = entries_[i].point;
    }
    return entries_.size();
  }

 private:
  /** What distinguishes points, in the order of comparison; the point comes last. */
  struct Entry {
    std::uint64_t key;
    std::array<T, 3> place;
    std::array<unsigned char, 3 * sizeof(float) + 3> look;  ///< normal and colour
    std::uint32_t point;

    bool operator==(const Entry& other) const { return place == other.place && look == other.look; }
    bool operator<(const Entry& other) const {
      if (key != other.key) return key < other.key;
      if (place != other.place) return place < other.place;
      return look != other.look ? look < other.look : point < other.point;
    }
  };

  void addEntries(const std::uint32_t* points, std::size_t n) {
    std::uint64_t keys[PointBlock::kSize];
    blocks_.fillListed(points, n, block_);
    splat_kernels::mortonKeys(block_.x, block_.y, block_.z, n, depth_, keys);
    for (std::size_t k = 0; k < n; ++k) entries_.push_back(entryOf(keys[k], points[k]));
  }

  Entry entryOf(std::uint64_t key, std::uint32_t point) const {
    Entry entry{key, {}, {}, point};
    read_(point, entry.place.data());
    const std::size_t input = cloud_.inputIndex(point);
    if (cloud_.normal != nullptr) {
      std::memcpy(entry.look.data(),
                  static_cast<const unsigned char*>(cloud_.normal) + input * cloud_.normal_stride,
                  3 * sizeof(float));
    }
    if (colors_.bgr != nullptr) {
      std::memcpy(entry.look.data() + 3 * sizeof(float),
                  static_cast<const unsigned char*>(colors_.bgr) + input * colors_.stride, 3);
    }
    return entry;
  }

  const CloudView& cloud_;
  const ColorView& colors_;
  const Reader<T>& read_;
  const PointBlocks<T>& blocks_;
  int depth_;
  PointBlock block_;
  std::vector<Entry> entries_;
};

/** Orders a cloud's points by the Morton codes of their cells, equal points once.
 *
 * Leading bits separate nearly all points of a scan: whole keys are made again for the others. */
template <typename T>
class KeyOrder {
 public:
  /** depth: of keys below root cells. */
  KeyOrder(const PointBlocks<T>& blocks, int depth, int threads)
      : blocks_(blocks), depth_(depth), threads_(threads) {}

  /** \param[out] keys ascending; below the leading bits they are 0 where those separate a point
   * from all others. \param[out] order the points they are of. */
  void run(CanonicalOrder<T> ties, AlignedVector<std::uint64_t>& keys,
           AlignedVector<std::uint32_t>& order) const {
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
  void makeKeys(AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& finite) const {
    keys.resize(blocks_.count());
    if (!blocks_.allFinite()) finite.resize(keys.size());
    blocks_.forEach([&](std::size_t place, const PointBlock& block) {
      std::uint64_t part[PointBlock::kSize];
      splat_kernels::mortonKeys(block.x, block.y, block.z, PointBlock::kSize, depth_, part);
      std::copy_n(part, block.count, keys.data() + place);
      if (!finite.empty()) std::copy_n(block.index, block.count, finite.data() + place);
    });
  }

  std::vector<Run> tiedRuns(const AlignedVector<std::uint64_t>& keys) const {
    const std::size_t n = keys.size();
    std::vector<std::vector<Run>> parts((n + kSlice - 1) / kSlice);
    // A run belongs to the slice it begins in.
    forEachSlice(n, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
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
               AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& order) const {
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
