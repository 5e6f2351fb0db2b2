// SPDX-License-Identifier: BSD-3-Clause
#include "point_window.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "octree_key.h"
#include "point_fetcher.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kFew = 64;  ///< points that are sorted by insertion

}  // namespace

const std::uint32_t*
PointWindow::fetchOrder(const OctreeCloud& cloud, const OctreeSource& source)
{
  constexpr std::size_t kMore = PointFetcher::kBlock + PointFetcher::kAhead;
  const std::size_t n = end_ - begin_;
  order_.resize(n + kMore);
  for (std::size_t i = 0; i < n; ++i) order_[i] = cloud.order(begin_ + i);
  std::fill_n(order_.data() + n, kMore, order_[n - 1]);
  if (!source.cloud.indices) return order_.data();
  inputs_.resize(n + kMore);
  for (std::size_t i = 0; i < n + kMore; ++i) {
    inputs_[i] = static_cast<std::uint32_t>(source.cloud.inputIndex(order_[i]));
  }
  return inputs_.data();
}

void
PointWindow::load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                  std::size_t end)
{
  begin_ = begin;
  end_ = end;
  const std::size_t n = end - begin;
  std::array<float*, kNumColumns> columns;
  for (std::size_t c = 0; c < kNumColumns; ++c) {
    columns_[c].resize(n + PointFetcher::kBlock);
    columns[c] = columns_[c].data();
    std::fill_n(columns[c] + n, PointFetcher::kBlock, 0.0f);
    // What no point has stays zero.
    const bool missing = c >= kL ? !source.colors.bgr : c >= kNormalX && !source.cloud.normal;
    if (missing) std::fill_n(columns[c], n, 0.0f);
  }
  PointFetcher(cloud.frame(), source).run(fetchOrder(cloud, source), n, columns);
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
