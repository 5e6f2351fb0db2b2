// SPDX-License-Identifier: BSD-3-Clause
#include "point_window.h"

#include <algorithm>
#include <cmath>

#include "octree_grid.h"
#include "octree_key.h"

#if defined(__GNUC__)
#define PCL_SLIM_PREFETCH(address) __builtin_prefetch(address)
#else
#define PCL_SLIM_PREFETCH(address) static_cast<void>(address)
#endif

namespace pcl_slim {

namespace {

constexpr std::size_t kAhead = 24;   ///< points between asking for one and using it
constexpr float kUnitSlack = 1e-3f;  ///< normals this near to unit length are left alone
constexpr std::size_t kFew = 64;     ///< points, nearly in order, that are sorted by insertion

void
readNormal(const unsigned char* at, float normal[3])
{
  std::memcpy(normal, at, 3 * sizeof(float));
  const float sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  if (std::abs(sq - 1.0f) < kUnitSlack) return;
  const bool usable = sq > 1e-24f && std::isfinite(sq);
  const float scale = usable ? 1.0f / std::sqrt(sq) : 0.0f;
  for (int a = 0; a < 3; ++a) normal[a] = usable ? normal[a] * scale : 0.0f;
}

template <typename T>
void
fetch(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin, std::size_t end,
      OctreePoint* out)
{
  const CloudView& view = source.cloud;
  const auto read = octree_grid::readerOf<T>(view);
  const auto* bgr = static_cast<const unsigned char*>(source.colors.bgr);
  const auto* normals = static_cast<const unsigned char*>(view.normal);
  for (std::size_t i = begin; i < end; ++i, ++out) {
    // Points lie in any order: each is asked for from memory some points ahead.
    if (i + kAhead < end) {
      const std::size_t ahead = view.inputIndex(cloud.order(i + kAhead));
      PCL_SLIM_PREFETCH(read.base + ahead * view.xyz_stride);
      if (normals) PCL_SLIM_PREFETCH(normals + ahead * view.normal_stride);
      if (bgr) PCL_SLIM_PREFETCH(bgr + ahead * source.colors.stride);
    }
    OctreePoint q{};
    q.order = cloud.order(i);
    T p[3];
    read(q.order, p);
    cloud.frame().position(p, q.position);
    const std::size_t input = view.inputIndex(q.order);
    if (normals) readNormal(normals + input * view.normal_stride, q.normal);
    if (bgr) {
      const unsigned char* c = bgr + input * source.colors.stride;
      source.table.convert(c[2], c[1], c[0], q.lab);
    }
    *out = q;
  }
}

}  // namespace

void
PointWindow::load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                  std::size_t end)
{
  begin_ = begin;
  points_.resize(end - begin);
  if (source.cloud.scalar == CloudView::Scalar::kDouble) {
    fetch<double>(cloud, source, begin, end, points_.data());
  } else {
    fetch<float>(cloud, source, begin, end, points_.data());
  }
}

void
PointWindow::sortRun(const OctreeCloud& cloud, std::size_t first, std::size_t last,
                     AlignedVector<std::uint64_t>& keys)
{
  const std::size_t n = last - first;
  OctreePoint* points = points_.data() + (first - begin_);
  keyed_.resize(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    keyed_[k] = {mortonKey(points[k].position, cloud.depth()), k};
  }
  if (n <= kFew) {
    for (std::size_t k = 1; k < n; ++k) {
      const Keyed one = keyed_[k];
      std::size_t at = k;
      for (; at > 0 && keyed_[at - 1].key > one.key; --at) keyed_[at] = keyed_[at - 1];
      keyed_[at] = one;
    }
  } else {
    std::sort(keyed_.begin(), keyed_.end(), [](const Keyed& a, const Keyed& b) {
      return a.key != b.key ? a.key < b.key : a.at < b.at;
    });
  }
  sorted_.resize(n);
  keys.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    sorted_[k] = points[keyed_[k].at];
    keys[k] = keyed_[k].key;
  }
  std::copy(sorted_.begin(), sorted_.end(), points);
}

}  // namespace pcl_slim

#undef PCL_SLIM_PREFETCH
