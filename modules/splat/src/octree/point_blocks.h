// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <type_traits>
#include <vector>

#include "octree/octree_grid.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

/** Positions of some finite points in root cells, and their indices. */
struct PointBlock {
  static constexpr std::size_t kSize = 256;

  alignas(64) float x[kSize] = {}, y[kSize] = {}, z[kSize] = {};
  alignas(64) std::uint32_t index[kSize] = {};
  std::size_t count = 0;
};

/** A cloud's finite points in blocks. */
template <typename T>
class PointBlocks {
 public:
  /** first: finite points before each slice of octree_grid::kSlice points, and behind the last. */
  PointBlocks(const octree_grid::Reader<T>& read, std::size_t points, const OctreeFrame& frame,
              const std::vector<std::size_t>& first, int threads)
      : read_(read), points_(points), frame_(frame), first_(first), threads_(threads)
  {
  }

  /** How many points are finite. */
  std::size_t count() const { return first_.back(); }
  bool allFinite() const { return count() == points_; }

  /** Runs body(place, block) for all blocks; place: finite points before them. */
  template <typename Body>
  void forEach(const Body& body) const
  {
    octree_grid::forEachSlice(points_, threads_,
                              [&](std::size_t s, std::size_t begin, std::size_t end) {
                                std::size_t place = first_[s];
                                PointBlock block;
                                for (; begin < end; begin += PointBlock::kSize) {
                                  fill(begin, std::min(end, begin + PointBlock::kSize), block);
                                  body(place, block);
                                  place += block.count;
                                }
                              });
  }

  /** Some points of a list, at most as many as fit a block. */
  void fillListed(const std::uint32_t* points, std::size_t count, PointBlock& block) const
  {
    for (std::size_t k = 0; k < count; ++k) {
      T p[3];
      read_(points[k], p);
      put(p, points[k], k, block);
    }
    finish(count, block);
  }

 private:
  void fill(std::size_t begin, std::size_t end, PointBlock& block) const
  {
    const bool all_finite = allFinite();
    const bool whole = end - begin == PointBlock::kSize && end < points_;
    if (all_finite && whole && fillWhole(begin, block)) return;
    if (all_finite) {
      fillEach<true>(begin, end, block);
    } else {
      fillEach<false>(begin, end, block);
    }
  }

  /** For a whole block of finite points with others behind it: four floats at a time. \return false
   * where their layout does not allow that. */
  bool fillWhole(std::size_t begin, PointBlock& block) const
  {
    if (!std::is_same_v<T, float> || read_.indices || read_.stride < 4 * sizeof(float)) {
      return false;
    }
    std::iota(block.index, block.index + PointBlock::kSize, static_cast<std::uint32_t>(begin));
    splat_kernels::gatherVectors(read_.base, read_.stride, block.index, PointBlock::kSize, block.x,
                                 block.y, block.z);
    splat_kernels::toCells(frame_, block.x, block.y, block.z, PointBlock::kSize);
    block.count = PointBlock::kSize;
    return true;
  }

  template <bool kAllFinite>
  void fillEach(std::size_t begin, std::size_t end, PointBlock& block) const
  {
    std::size_t k = 0;
    for (std::size_t i = begin; i < end; ++i) {
      T p[3];
      read_(i, p);
      if (!kAllFinite && !isFinite(p)) continue;
      put(p, static_cast<std::uint32_t>(i), k++, block);
    }
    finish(k, block);
  }

  void put(const T p[3], std::uint32_t index, std::size_t k, PointBlock& block) const
  {
    float q[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    if constexpr (std::is_same_v<T, double>) frame_.position(p, q);
    block.x[k] = q[0], block.y[k] = q[1], block.z[k] = q[2];
    block.index[k] = index;
  }

  void finish(std::size_t count, PointBlock& block) const
  {
    constexpr std::size_t kWhole = 16;  // points of the widest vectors
    block.count = count;
    if constexpr (std::is_same_v<T, float>) {
      const std::size_t n = (count + kWhole - 1) / kWhole * kWhole;
      splat_kernels::toCells(frame_, block.x, block.y, block.z, n);
    }
  }

  const octree_grid::Reader<T>& read_;
  std::size_t points_;
  const OctreeFrame& frame_;
  const std::vector<std::size_t>& first_;
  int threads_;
};

}  // namespace pcl_slim::detail
