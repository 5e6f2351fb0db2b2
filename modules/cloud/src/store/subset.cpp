// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/extent.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr float kBlockGrid = 0x1p22f;  ///< block origins are multiples of its inverse

/** The stored points that are left, ascending. */
std::vector<std::uint32_t>
othersThan(const std::vector<std::uint32_t>& dropped, std::size_t size)
{
  std::vector<std::uint32_t> kept;
  kept.reserve(size - dropped.size());
  auto next = dropped.begin();
  for (std::uint32_t i = 0; i < size; ++i) {
    if (next != dropped.end() && *next == i) {
      ++next;
    } else {
      kept.push_back(i);
    }
  }
  return kept;
}

/** One coordinate of some points, cut into blocks. */
struct BlockedColumn {
  AlignedVector<float> offset, origin, low, high;

  template <typename Value>
  BlockedColumn(std::size_t size, const Value& value)
  {
    const std::size_t blocks = (size + kBlock - 1) / kBlock;
    offset.resize(blocks * kBlock);
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * kBlock, count = std::min(kBlock, size - begin);
      origin.push_back(static_cast<float>(std::round(value(begin) * kBlockGrid)) / kBlockGrid);
      for (std::size_t i = begin; i < begin + kBlock; ++i) {
        offset[i] = static_cast<float>(value(std::min(i, begin + count - 1)) - origin.back());
      }
      const Extent extent = extentOf(offset.data() + begin, kBlock);
      low.push_back(origin.back() + extent.low);
      high.push_back(origin.back() + extent.high);
      std::fill_n(offset.begin() + static_cast<std::ptrdiff_t>(begin + count), kBlock - count,
                  PointStore::kFarAway);
    }
  }
};

}  // namespace

PointStore
PointStore::without(const std::vector<std::uint32_t>& dropped) const
{
  const std::vector<std::uint32_t> kept = othersThan(dropped, size_);
  PointStore store;
  store.size_ = kept.size();
  store.bulk_center_ = bulk_center_;
  store.bulk_reach_ = bulk_reach_;
  store.bulk_between_ = bulk_between_;
  store.origin_ = origin_;
  store.scale_ = scale_;
  store.diagonal_ = diagonal_;
  store.bulk_diagonal_ = bulk_diagonal_;
  store.center_grid_ = center_grid_;
  store.statistics_ = statistics_;
  store.sensor_ = sensor_;
  for (const std::uint32_t i : kept) {
    store.keys_.push_back(keys_[i]);
    store.order_of_store_.push_back(order_of_store_[i]);
    if (hasSensors()) store.sensors_.push_back(sensors_[i]);
  }
  for (const auto& [order, stored] : merged_) {
    const auto place = std::lower_bound(kept.begin(), kept.end(), stored);
    if (place == kept.end() || *place != stored) continue;
    store.merged_.push_back({order, static_cast<std::uint32_t>(place - kept.begin())});
  }
  store.copyColumns(*this, kept);
  return store;
}

/** Positions and normals of some of another store's points, as blocks of this. */
void
PointStore::copyColumns(const PointStore& from, const std::vector<std::uint32_t>& points)
{
  BlockTree::Level boxes;
  boxes.allocate((points.size() + kBlock - 1) / kBlock);
  const auto fill = [&](std::size_t axis, AlignedVector<float>& offsets,
                        AlignedVector<float>& origins, AlignedVector<float>& lows,
                        AlignedVector<float>& highs) {
    BlockedColumn column(points.size(),
                         [&](std::size_t i) { return from.position(points[i])[axis]; });
    offsets = std::move(column.offset);
    origins = std::move(column.origin);
    std::copy(column.low.begin(), column.low.end(), lows.begin());
    std::copy(column.high.begin(), column.high.end(), highs.begin());
  };
  fill(0, x_, block_origin_x_, boxes.min_x, boxes.max_x);
  fill(1, y_, block_origin_y_, boxes.min_y, boxes.max_y);
  fill(2, z_, block_origin_z_, boxes.min_z, boxes.max_z);
  tree_ = BlockTree(std::move(boxes));
  if (!from.hasSides()) return;
  found_sides_ = from.found_sides_;
  const AlignedVector<float>* const given[3] = {&from.nx_, &from.ny_, &from.nz_};
  AlignedVector<float>* const copied[3] = {&nx_, &ny_, &nz_};
  for (std::size_t a = 0; a < 3; ++a) {
    copied[a]->assign(x_.size(), 0.0f);
    for (std::size_t i = 0; i < points.size(); ++i) (*copied[a])[i] = (*given[a])[points[i]];
  }
}

}  // namespace pcl_slim
