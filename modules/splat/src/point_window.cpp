// SPDX-License-Identifier: BSD-3-Clause
#include "point_window.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "octree_grid.h"
#include "octree_key.h"
#include "splat_kernels.h"

#if defined(__GNUC__)
#define PCL_SLIM_PREFETCH(address) __builtin_prefetch(address)
#else
#define PCL_SLIM_PREFETCH(address) static_cast<void>(address)
#endif

namespace pcl_slim {

namespace {

constexpr std::size_t kAhead = 24;  ///< points between asking for one and using it
constexpr std::size_t kFew = 64;    ///< points that are sorted by insertion

/** Where a point's attributes lie in memory: stretches of bytes a stride apart. Attributes of one
 * record, as in PCL's clouds, are one stretch. */
class Stretches {
 public:
  struct Stretch {
    const unsigned char *begin, *last;
    std::size_t stride;
  };

  Stretches(const OctreeSource& source, std::size_t scalar)
  {
    add(source.cloud.xyz, source.cloud.xyz_stride, 3 * scalar);
    add(source.cloud.normal, source.cloud.normal_stride, 3 * sizeof(float));
    add(source.colors.bgr, source.colors.stride, 3);
  }

  int size() const { return size_; }
  const Stretch& operator[](int k) const { return all_[k]; }

 private:
  static constexpr std::size_t kLine = 64;

  void add(const void* first, std::size_t stride, std::size_t bytes)
  {
    if (!first) return;
    const auto* begin = static_cast<const unsigned char*>(first);
    const Stretch one = {begin, begin + bytes - 1, stride};
    Stretch& whole = all_[0];
    const bool together =
        size_ > 0 && whole.stride == stride && stride <= kLine &&
        std::less<>()(std::max(whole.last, one.last), std::min(whole.begin, one.begin) + kLine);
    if (!together) {
      all_[size_++] = one;
    } else {
      whole.begin = std::min(whole.begin, one.begin);
      whole.last = std::max(whole.last, one.last);
    }
  }

  Stretch all_[3] = {};
  int size_ = 0;
};

}  // namespace

void
PointWindow::fetchOrder(const OctreeCloud& cloud, const OctreeSource& source)
{
  const std::size_t n = end_ - begin_;
  order_.resize(n);
  for (std::size_t i = 0; i < n; ++i) order_[i] = cloud.order(begin_ + i);
  if (!source.cloud.indices) return;
  inputs_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    inputs_[i] = static_cast<std::uint32_t>(source.cloud.inputIndex(order_[i]));
  }
}

/** Reads records in any order into blocks of columns. */
template <typename T, bool kNormals, bool kColors>
class PointWindow::Fetcher {
 public:
  Fetcher(const OctreeFrame& frame, const OctreeSource& source, const std::uint32_t* inputs,
          std::size_t n)
      : frame_(frame), source_(source), inputs_(inputs), n_(n), stretches_(source, sizeof(T))
  {
  }

  /** Fetches everything. */
  void run(const std::array<float*, kNumColumns>& columns)
  {
    for (std::size_t begin = 0; begin < n_; begin += kBlock) {
      const std::size_t count = std::min(kBlock, n_ - begin);
      read(begin, count);
      convert();
      for (int c = 0; c < kNumColumns; ++c) {
        std::memcpy(columns[static_cast<std::size_t>(c)] + begin, block_[c], count * sizeof(float));
      }
    }
  }

 private:
  static constexpr std::size_t kBlock = 64;

  void read(std::size_t begin, std::size_t count)
  {
    const auto* xyz = static_cast<const unsigned char*>(source_.cloud.xyz);
    const auto* normals = static_cast<const unsigned char*>(source_.cloud.normal);
    const auto* colors = static_cast<const unsigned char*>(source_.colors.bgr);
    const std::size_t xyz_stride = source_.cloud.xyz_stride;
    const std::size_t normal_stride = source_.cloud.normal_stride;
    const std::size_t color_stride = source_.colors.stride;
    const LabTable& table = source_.table;
    const std::uint32_t* inputs = inputs_ + begin;
    const std::size_t last = n_ - 1 - begin;
    const Stretches::Stretch first = stretches_[0];
    for (std::size_t k = 0; k < count; ++k) {
      // Points lie in any order: each is asked for from memory some points ahead, at both ends. Not
      // in a function of its own, which GCC takes for one without effect.
      const std::size_t ahead = inputs[std::min(k + kAhead, last)];
      PCL_SLIM_PREFETCH(first.begin + ahead * first.stride);
      PCL_SLIM_PREFETCH(first.last + ahead * first.stride);

      for (int m = 1; m < stretches_.size(); ++m) {
        PCL_SLIM_PREFETCH(stretches_[m].begin + ahead * stretches_[m].stride);
      }
      const std::size_t input = inputs[k];
      T world[3];
      std::memcpy(world, xyz + input * xyz_stride, sizeof(world));
      if constexpr (sizeof(T) == sizeof(double)) {
        float cells[3];
        frame_.position(world, cells);
        for (int a = 0; a < 3; ++a) block_[kX + a][k] = cells[a];
      } else {
        for (int a = 0; a < 3; ++a) block_[kX + a][k] = world[a];
      }
      if constexpr (kNormals) {
        float normal[3];
        std::memcpy(normal, normals + input * normal_stride, sizeof(normal));
        for (int a = 0; a < 3; ++a) block_[kNormalX + a][k] = normal[a];
      }
      if constexpr (kColors) {
        const unsigned char* bgr = colors + input * color_stride;
        for (int a = 0; a < 3; ++a) block_[kL + a][k] = table.linear(bgr[2 - a]);
      }
    }
  }

  void convert()
  {
    if (sizeof(T) == sizeof(float)) {
      splat_kernels::toCells(frame_, block_[kX], block_[kY], block_[kZ], kBlock);
    }
    if (kNormals) {
      splat_kernels::normalize(block_[kNormalX], block_[kNormalY], block_[kNormalZ], kBlock);
    }
    if (kColors) source_.table.labOfLinear(block_[kL], block_[kA], block_[kB], kBlock);
  }

  const OctreeFrame frame_;
  const OctreeSource source_;
  const std::uint32_t* inputs_;
  std::size_t n_;
  Stretches stretches_;
  alignas(64) float block_[kNumColumns][kBlock] = {};
};

template <typename T>
void
PointWindow::fetch(const OctreeFrame& frame, const OctreeSource& source)
{
  const std::uint32_t* inputs = source.cloud.indices ? inputs_.data() : order_.data();
  std::array<float*, kNumColumns> columns;
  for (std::size_t c = 0; c < kNumColumns; ++c) columns[c] = columns_[c].data();
  const std::size_t n = end_ - begin_;
  if (source.cloud.normal && source.colors.bgr) {
    Fetcher<T, true, true>(frame, source, inputs, n).run(columns);
  } else if (source.cloud.normal) {
    Fetcher<T, true, false>(frame, source, inputs, n).run(columns);
  } else if (source.colors.bgr) {
    Fetcher<T, false, true>(frame, source, inputs, n).run(columns);
  } else {
    Fetcher<T, false, false>(frame, source, inputs, n).run(columns);
  }
}

void
PointWindow::load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                  std::size_t end)
{
  begin_ = begin;
  end_ = end;
  const std::size_t n = end - begin;
  // Vectors may be read from the last point on.
  for (auto& column : columns_) column.resize(n + 16);
  fetchOrder(cloud, source);
  if (source.cloud.scalar == CloudView::Scalar::kDouble) {
    fetch<double>(cloud.frame(), source);
  } else {
    fetch<float>(cloud.frame(), source);
  }
  for (auto& column : columns_) std::fill_n(column.data() + n, 16, 0.0f);
}

template <typename T>
void
PointWindow::permute(AlignedVector<T>& column, std::size_t first)
{
  static_assert(sizeof(T) == sizeof(std::uint32_t));
  T* values = column.data() + (first - begin_);
  for (std::size_t k = 0; k < keyed_.size(); ++k) {
    std::memcpy(&scratch_[k], values + keyed_[k].at, sizeof(T));
  }
  std::memcpy(values, scratch_.data(), keyed_.size() * sizeof(T));
}

void
PointWindow::sortRun(const OctreeCloud& cloud, std::size_t first, std::size_t last,
                     AlignedVector<std::uint64_t>& keys)
{
  const std::size_t n = last - first;
  keyed_.resize(n);
  for (std::uint32_t k = 0; k < n; ++k) {
    keyed_[k] = {mortonKey(position(first + k), cloud.depth()), k};
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
  keys.resize(n);
  for (std::size_t k = 0; k < n; ++k) keys[k] = keyed_[k].key;
  scratch_.resize(n);
  for (auto& column : columns_) permute(column, first);
  permute(order_, first);
}

}  // namespace pcl_slim

#undef PCL_SLIM_PREFETCH
