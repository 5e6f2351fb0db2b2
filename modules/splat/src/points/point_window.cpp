// SPDX-License-Identifier: BSD-3-Clause
#include "points/point_window.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "points/point_fetcher.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kLanes = 8;  ///< keys that are made at a time
constexpr std::size_t kFew = 12;   ///< points for which counting digits does not pay
constexpr int kDigitBits = 6;      ///< two levels of the octree
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

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

void
PointWindow::loadAround(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                        std::size_t end, std::size_t reach)
{
  load(cloud, source, begin - std::min(begin, reach), std::min(cloud.size(), end + reach));
}

void
PointWindow::permute(std::size_t at, std::size_t n)
{
  const std::uint32_t* const from = from_.data();
  numbers_.resize(3 * n);
  places_.resize(n);
  float* const numbers = numbers_.data();
  static_assert(kNumColumns % 3 == 0);
  for (std::size_t c = 0; c < kNumColumns; c += 3) {  // a place is read once for three columns
    float* const columns[3] = {columns_[c].data() + at, columns_[c + 1].data() + at,
                               columns_[c + 2].data() + at};
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t place = from[k];
      numbers[k] = columns[0][place];
      numbers[n + k] = columns[1][place];
      numbers[2 * n + k] = columns[2][place];
    }
    for (std::size_t d = 0; d < 3; ++d) std::copy_n(numbers + d * n, n, columns[d]);
  }
  for (std::size_t k = 0; k < n; ++k) places_[k] = order_[at + from[k]];
  std::copy_n(places_.data(), n, order_.data() + at);
}

void
PointWindow::sortDigit(const std::uint64_t* keys, std::size_t n, int shift)
{
  std::array<std::uint32_t, kDigits> next{};
  for (std::size_t k = 0; k < n; ++k) ++next[keys[k] >> shift & (kDigits - 1)];
  std::uint32_t total = 0;
  for (std::uint32_t& place : next) {
    const std::uint32_t count = place;
    place = total;
    total += count;
  }
  for (std::uint32_t k = 0; k < n; ++k) from_[next[keys[k] >> shift & (kDigits - 1)]++] = k;
}

void
PointWindow::sortFew(const std::uint64_t* keys, std::size_t n)
{
  for (std::uint32_t k = 0; k < n; ++k) {
    std::uint32_t at = k;
    for (; at > 0 && keys[from_[at - 1]] > keys[k]; --at) from_[at] = from_[at - 1];
    from_[at] = k;
  }
}

int
PointWindow::sortRun(const OctreeCloud& cloud, std::size_t first, std::size_t last)
{
  const std::size_t n = last - first, at = first - begin_;
  unsorted_.resize(n + kLanes);
  from_.resize(n);
  keys_.resize(end_ - begin_);
  std::uint64_t* const unsorted = unsorted_.data();
  splat_kernels::mortonKeys(column(kX, first), column(kY, first), column(kZ, first), n,
                            cloud.depth(), unsorted);
  int lowest = 0;
  if (n <= kFew) {
    sortFew(unsorted, n);
  } else {
    std::uint64_t differences = 0;
    for (std::size_t k = 1; k < n; ++k) differences |= unsorted[k] ^ unsorted[0];
    for (differences >>= kDigitBits; differences != 0; differences >>= 3) ++lowest;
    sortDigit(unsorted, n, 3 * lowest);
  }
  for (std::size_t k = 0; k < n; ++k) keys_[at + k] = unsorted[from_[k]];
  permute(at, n);
  return lowest;
}

}  // namespace pcl_slim::detail
