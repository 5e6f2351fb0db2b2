// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "points/splat_kernels.h"

/** \brief Coordinates as their owner has them, and a cloud's box. */
namespace pcl_slim::detail::octree_grid {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time

/** Coordinates stored as T. */
template <typename T>
struct Reader {
  using Scalar = T;
  const unsigned char* base;
  std::size_t stride;
  const std::int32_t* indices;

  const unsigned char* address(std::size_t i) const
  {
    return base + (indices ? static_cast<std::size_t>(indices[i]) : i) * stride;
  }
  void operator()(std::size_t i, T p[3]) const { std::memcpy(p, address(i), 3 * sizeof(T)); }
};

template <typename T>
Reader<T>
readerOf(const CloudView& view)
{
  return {static_cast<const unsigned char*>(view.xyz), view.xyz_stride, view.indices};
}

/** Runs body(slice, begin, end) over [0, n). */
template <typename Body>
void
forEachSlice(std::size_t n, int threads, const Body& body)
{
  parallelFor((n + kSlice - 1) / kSlice, threads, 1,
              [&](std::size_t s, int) { body(s, s * kSlice, std::min(n, (s + 1) * kSlice)); });
}

struct Box {
  std::array<double, 3> min, max;
  std::size_t finite = 0;  ///< points inside; the others are NaN or infinite

  double longest() const { return std::max({max[0] - min[0], max[1] - min[1], max[2] - min[2]}); }
};

inline Box
noBox()
{
  const double inf = std::numeric_limits<double>::infinity();
  return {{inf, inf, inf}, {-inf, -inf, -inf}, 0};
}

inline Box
unionOf(const std::vector<Box>& parts)
{
  Box all = noBox();
  for (const Box& part : parts) {
    all.finite += part.finite;
    for (std::size_t a = 0; a < 3; ++a) {
      all.min[a] = std::min(all.min[a], part.min[a]);
      all.max[a] = std::max(all.max[a], part.max[a]);
    }
  }
  return all;
}

inline void
extend(Box& box, double a0, double a1, double a2)
{
  const double p[3] = {a0, a1, a2};
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = std::min(box.min[a], p[a]);
    box.max[a] = std::max(box.max[a], p[a]);
  }
}

/** Box of the finite points in [begin, end). */
template <typename T>
Box
boxOf(const Reader<T>& read, std::size_t begin, std::size_t end)
{
  Box box = noBox();
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
Box
measure(const Reader<T>& read, std::size_t n, int threads, std::vector<std::size_t>& finite)
{
  std::vector<Box> parts((n + kSlice - 1) / kSlice);
  forEachSlice(n, threads, [&](std::size_t s, std::size_t begin, std::size_t end) {
    parts[s] = boxOf(read, begin, end);
  });
  finite.assign(1, 0);
  for (const Box& part : parts) finite.push_back(finite.back() + part.finite);
  return unionOf(parts);
}

}  // namespace pcl_slim::detail::octree_grid
