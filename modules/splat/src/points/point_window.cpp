// SPDX-License-Identifier: BSD-3-Clause
#include "points/point_window.h"

#include <algorithm>

#include "points/point_fetcher.h"

namespace pcl_slim::detail {

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

void
PointWindow::loadAround(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                        std::size_t end, std::size_t reach)
{
  load(cloud, source, begin - std::min(begin, reach), std::min(cloud.size(), end + reach));
}

}  // namespace pcl_slim::detail
