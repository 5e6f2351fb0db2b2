// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/extent.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr float kBlockGrid = 0x1p22f;  ///< block origins are multiples of its inverse
constexpr std::size_t kTask = 256;     ///< blocks a thread takes at a time

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

/** Where a block's points go: offsets from an origin on a grid, and the box. */
struct BlockColumn {
  float* offsets;
  float &origin, &low, &high;
};

/** Writes one coordinate of a block's points, given by value(k). */
template <typename Value>
void
fillBlock(std::size_t count, const Value& value, const BlockColumn& block)
{
  block.origin = static_cast<float>(std::round(value(0) * kBlockGrid)) / kBlockGrid;
  for (std::size_t k = 0; k < kBlock; ++k)
    block.offsets[k] = static_cast<float>(value(std::min(k, count - 1)) - block.origin);
  const Extent extent = extentOf(block.offsets, kBlock);
  block.low = block.origin + extent.low;
  block.high = block.origin + extent.high;
  std::fill_n(block.offsets + count, kBlock - count, PointStore::kFarAway);
}

}  // namespace

PointStore
PointStore::without(const std::vector<std::uint32_t>& dropped, int threads) const
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
  for (const auto& [order, stored] : merged_) {
    const auto place = std::lower_bound(kept.begin(), kept.end(), stored);
    if (place == kept.end() || *place != stored) continue;
    store.merged_.push_back({order, static_cast<std::uint32_t>(place - kept.begin())});
  }
  store.copyPoints(*this, kept, resolveThreads(threads));
  return store;
}

/** What another store knows of some of its points, as blocks of this. */
void
PointStore::copyPoints(const PointStore& from, const std::vector<std::uint32_t>& points,
                       int threads)
{
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  BlockTree::Level boxes;
  boxes.allocate(blocks);
  AlignedVector<float>* const offsets[3] = {&x_, &y_, &z_};
  AlignedVector<float>* const origins[3] = {&block_origin_x_, &block_origin_y_, &block_origin_z_};
  AlignedVector<float>* const lows[3] = {&boxes.min_x, &boxes.min_y, &boxes.min_z};
  AlignedVector<float>* const highs[3] = {&boxes.max_x, &boxes.max_y, &boxes.max_z};
  const AlignedVector<float>* const given[3] = {&from.nx_, &from.ny_, &from.nz_};
  AlignedVector<float>* const normals[3] = {&nx_, &ny_, &nz_};
  found_sides_ = from.found_sides_;
  keys_.resize(points.size());
  order_of_store_.resize(points.size());
  if (from.hasSensors()) sensors_.resize(points.size());
  for (std::size_t a = 0; a < 3; ++a) {
    offsets[a]->resize(blocks * kBlock);
    origins[a]->resize(blocks);
    if (from.hasSides()) normals[a]->assign(blocks * kBlock, 0.0f);
  }
  parallelFor(blocks, threads, kTask, [&](std::size_t b, int) {
    const std::size_t begin = b * kBlock, count = std::min(kBlock, points.size() - begin);
    std::array<std::array<double, 3>, kBlock> places;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = points[begin + k];
      places[k] = from.position(i);
      keys_[begin + k] = from.keys_[i];
      order_of_store_[begin + k] = from.order_of_store_[i];
      if (from.hasSensors()) sensors_[begin + k] = from.sensors_[i];
      for (std::size_t a = 0; a < 3 && from.hasSides(); ++a)
        (*normals[a])[begin + k] = (*given[a])[i];
    }
    for (std::size_t a = 0; a < 3; ++a) {
      fillBlock(count, [&](std::size_t k) { return places[k][a]; },
                {offsets[a]->data() + begin, (*origins[a])[b], (*lows[a])[b], (*highs[a])[b]});
    }
  });
  tree_ = BlockTree(std::move(boxes));
}

}  // namespace pcl_slim
