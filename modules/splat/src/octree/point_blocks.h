// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <type_traits>
#include <vector>

#include "kernels/splat_kernels.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/splat/octree_cloud.h"

/** \brief A cloud as an octree reads it: the box of its finite points, and these in blocks. */
namespace pcl_slim::detail {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time

/** Coordinates stored as T. */
template <typename T>
struct Reader {
  using Scalar = T;
  const unsigned char* base;
  std::size_t stride;
  const std::int32_t* indices;

  const unsigned char* address(std::size_t i) const {
    return base + (indices ? static_cast<std::size_t>(indices[i]) : i) * stride;
  }
  void operator()(std::size_t i, T p[3]) const { std::memcpy(p, address(i), 3 * sizeof(T)); }
};

template <typename T>
Reader<T> readerOf(const CloudView& view) {
  return {static_cast<const unsigned char*>(view.xyz), view.xyz_stride, view.indices};
}

/** Runs body(slice, begin, end) over [0, n). */
template <typename Body>
void forEachSlice(std::size_t n, int threads, const Body& body) {
  parallelFor((n + kSlice - 1) / kSlice, threads, 1,
              [&](std::size_t s, int) { body(s, s * kSlice, std::min(n, (s + 1) * kSlice)); });
}

struct FiniteBox {
  std::array<double, 3> min, max;
  std::size_t finite = 0;  ///< points inside; the others are NaN or infinite

  double longest() const { return std::max({max[0] - min[0], max[1] - min[1], max[2] - min[2]}); }
};

inline FiniteBox noBox() {
  const double inf = std::numeric_limits<double>::infinity();
  return {{inf, inf, inf}, {-inf, -inf, -inf}, 0};
}

inline FiniteBox unionOf(const std::vector<FiniteBox>& parts) {
  FiniteBox all = noBox();
  for (const FiniteBox& part : parts) {
    all.finite += part.finite;
    for (std::size_t a = 0; a < 3; ++a) {
      all.min[a] = std::min(all.min[a], part.min[a]);
      all.max[a] = std::max(all.max[a], part.max[a]);
    }
  }
  return all;
}

inline void extend(FiniteBox& box, double a0, double a1, double a2) {
  const double p[3] = {a0, a1, a2};
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = std::min(box.min[a], p[a]);
    box.max[a] = std::max(box.max[a], p[a]);
  }
}

/** FiniteBox of the finite points in [begin, end). */
template <typename T>
FiniteBox boxOf(const Reader<T>& read, std::size_t begin, std::size_t end) {
  FiniteBox box = noBox();
  std::size_t i = begin;
  // The last point may end its memory, so that no fourth float follows it.
  if (std::is_same_v<T, float> && !read.indices && read.stride >= 4 * sizeof(float)) {
    float low[3], high[3];
    const std::size_t n = end - begin - 1;
    if (n > 0 &&
        splat_kernels::boxOfPoints(read.base + begin * read.stride, read.stride, n, low, high)) {
      extend(box, low[0], low[1], low[2]);
      extend(box, high[0], high[1], high[2]);
      box.finite = n;
      i = begin + n;
    }
  }
  for (; i < end; ++i) {
    T p[3];
    read(i, p);
    if (!isFinite(p)) continue;
    ++box.finite;
    extend(box, p[0], p[1], p[2]);
  }
  return box;
}

template <typename T>
FiniteBox measure(const Reader<T>& read, std::size_t n, int threads,
                  std::vector<std::size_t>& finite) {
  std::vector<FiniteBox> parts((n + kSlice - 1) / kSlice);
  forEachSlice(n, threads, [&](std::size_t s, std::size_t begin, std::size_t end) {
    parts[s] = boxOf(read, begin, end);
  });
  finite.assign(1, 0);
  for (const FiniteBox& part : parts) finite.push_back(finite.back() + part.finite);
  return unionOf(parts);
}

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
  /** first: finite points before each slice of kSlice points, and behind the last. */
  PointBlocks(const Reader<T>& read, std::size_t points, const OctreeFrame& frame,
              const std::vector<std::size_t>& first, int threads)
      : read_(read), points_(points), frame_(frame), first_(first), threads_(threads) {}

  /** How many points are finite. */
  std::size_t count() const { return first_.back(); }
  bool allFinite() const { return count() == points_; }

  /** Runs body(place, block) for all blocks; place: finite points before them. */
  template <typename Body>
  void forEach(const Body& body) const {
    forEachSlice(points_, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
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
  void fillListed(const std::uint32_t* points, std::size_t count, PointBlock& block) const {
    for (std::size_t k = 0; k < count; ++k) {
      T p[3];
      read_(points[k], p);
      put(p, points[k], k, block);
    }
    finish(count, block);
  }

 private:
  void fill(std::size_t begin, std::size_t end, PointBlock& block) const {
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
  bool fillWhole(std::size_t begin, PointBlock& block) const {
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
  void fillEach(std::size_t begin, std::size_t end, PointBlock& block) const {
    std::size_t k = 0;
    for (std::size_t i = begin; i < end; ++i) {
      T p[3];
      read_(i, p);
      if (!kAllFinite && !isFinite(p)) continue;
      put(p, static_cast<std::uint32_t>(i), k++, block);
    }
    finish(k, block);
  }

  void put(const T p[3], std::uint32_t index, std::size_t k, PointBlock& block) const {
    float q[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    if constexpr (std::is_same_v<T, double>) frame_.position(p, q);
    block.x[k] = q[0], block.y[k] = q[1], block.z[k] = q[2];
    block.index[k] = index;
  }

  void finish(std::size_t count, PointBlock& block) const {
    constexpr std::size_t kWhole = 16;  // points of the widest vectors
    block.count = count;
    if constexpr (std::is_same_v<T, float>) {
      const std::size_t n = (count + kWhole - 1) / kWhole * kWhole;
      splat_kernels::toCells(frame_, block.x, block.y, block.z, n);
    }
  }

  const Reader<T>& read_;
  std::size_t points_;
  const OctreeFrame& frame_;
  const std::vector<std::size_t>& first_;
  int threads_;
};

}  // namespace pcl_slim::detail
