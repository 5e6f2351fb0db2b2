// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/extent.h"
#include "pcl_slim/core/parallel.h"
#include "store/store.h"

namespace pcl_slim {

using detail::kBlockGrid;

namespace {

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr std::size_t kTask = 256;  ///< blocks a thread takes at a time

/** The stored points that are left, ascending. */
std::vector<std::uint32_t> othersThan(const std::vector<std::uint32_t>& dropped, std::size_t size) {
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

/** Keeps some values of a column, ascending. */
template <typename Column>
void keepOnly(const std::vector<std::uint32_t>& kept, Column& column) {
  for (std::size_t i = 0; i < kept.size(); ++i) column[i] = column[kept[i]];
  column.resize(kept.size());
}

/** Copies some values of a column, ascending. */
template <typename Column>
void copyOnly(const std::vector<std::uint32_t>& kept, int threads, const Column& column,
              Column& copied) {
  copied.resize(kept.size());
  parallelFor(kept.size(), threads, kTask * kBlock,
              [&](std::size_t i, int) { copied[i] = column[kept[i]]; });
}

/** Normals of the points that pad the last block. */
void padNormals(std::size_t size, std::size_t padded, AlignedVector<float>& normals) {
  normals.resize(padded);
  std::fill(normals.begin() + static_cast<std::ptrdiff_t>(size), normals.end(), 0.0f);
}

/** One coordinate of some points, cut into blocks. */
struct BlockedColumn {
  AlignedVector<float> offset, origin, low, high;

  template <typename Value>
  BlockedColumn(std::size_t size, int threads, const Value& value) {
    const std::size_t blocks = (size + kBlock - 1) / kBlock;
    offset.resize(blocks * kBlock);
    for (auto* column : {&origin, &low, &high}) column->resize(blocks);
    parallelFor(blocks, threads, kTask, [&](std::size_t b, int) {
      const std::size_t begin = b * kBlock, count = std::min(kBlock, size - begin);
      origin[b] = static_cast<float>(std::round(value(begin) * kBlockGrid)) / kBlockGrid;
      for (std::size_t i = begin; i < begin + kBlock; ++i)
        offset[i] = static_cast<float>(value(std::min(i, begin + count - 1)) - origin[b]);
      const Extent extent = extentOf(offset.data() + begin, kBlock);
      low[b] = origin[b] + extent.low;
      high[b] = origin[b] + extent.high;
      std::fill_n(offset.begin() + static_cast<std::ptrdiff_t>(begin + count), kBlock - count,
                  PointStore::kFarAway);
    });
  }
};

/** Those of merged points whose stored one is kept. */
std::vector<std::array<std::uint32_t, 2>> keptMerges(
    const std::vector<std::uint32_t>& kept,
    const std::vector<std::array<std::uint32_t, 2>>& merged) {
  std::vector<std::array<std::uint32_t, 2>> left;
  for (const auto& [order, stored] : merged) {
    const auto place = std::lower_bound(kept.begin(), kept.end(), stored);
    if (place == kept.end() || *place != stored) continue;
    left.push_back({order, static_cast<std::uint32_t>(place - kept.begin())});
  }
  return left;
}

}  // namespace

PointStore PointStore::without(const std::vector<std::uint32_t>& dropped, int threads) const {
  // What is dropped is not copied first: that takes longer than all that is done with a part.
  const std::vector<std::uint32_t> kept = othersThan(dropped, size_);
  threads = resolveThreads(threads);
  PointStore store;
  store.size_ = kept.size();
  store.frame_ = frame_;
  store.statistics_ = statistics_;
  store.found_sides_ = found_sides_;
  store.drift_ = drift_;
  store.merged_ = keptMerges(kept, merged_);
  copyOnly(kept, threads, keys_, store.keys_);
  copyOnly(kept, threads, order_of_store_, store.order_of_store_);
  if (hasSensors()) copyOnly(kept, threads, sensors_, store.sensors_);
  if (hasFrameNumbers()) copyOnly(kept, threads, frame_numbers_, store.frame_numbers_);
  store.cutColumns(
      kept.size(), [&](std::size_t i, std::size_t axis) { return coordinate(kept[i], axis); },
      threads);
  if (!hasSides()) return store;
  copyOnly(kept, threads, nx_, store.nx_);
  copyOnly(kept, threads, ny_, store.ny_);
  copyOnly(kept, threads, nz_, store.nz_);
  for (AlignedVector<float>* normals : {&store.nx_, &store.ny_, &store.nz_})
    padNormals(kept.size(), store.x_.size(), *normals);
  return store;
}

void PointStore::drop(const std::vector<std::uint32_t>& dropped, int threads) {
  const std::vector<std::uint32_t> kept = othersThan(dropped, size_);
  size_ = kept.size();
  keepOnly(kept, keys_);
  keepOnly(kept, order_of_store_);
  if (hasSensors()) keepOnly(kept, sensors_);
  if (hasFrameNumbers()) keepOnly(kept, frame_numbers_);
  merged_ = keptMerges(kept, merged_);
  cutColumns(
      size_, [&](std::size_t i, std::size_t axis) { return coordinate(kept[i], axis); },
      resolveThreads(threads));
  if (!hasSides()) return;
  for (AlignedVector<float>* normals : {&nx_, &ny_, &nz_}) {
    keepOnly(kept, *normals);
    padNormals(kept.size(), x_.size(), *normals);
  }
}

void PointStore::moveTo(const std::vector<std::array<double, 3>>& positions, int threads) {
  double farthest = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    const auto from = position(i);
    const auto& to = positions[i];
    farthest = std::max(farthest, std::hypot(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
  }
  drift_ += farthest;  // keys are of the places before the first move
  cutColumns(
      size_, [&](std::size_t i, std::size_t axis) { return positions[i][axis]; },
      resolveThreads(threads));
}

/** Cuts positions into new blocks. One column is copied at a time. \param[in] position of a point
 * along an axis */
template <typename Position>
void PointStore::cutColumns(std::size_t size, const Position& position, int threads) {
  BlockTree::Level boxes;
  boxes.allocate((size + kBlock - 1) / kBlock);
  const auto cut = [&](std::size_t axis, AlignedVector<float>& offsets,
                       AlignedVector<float>& origins, AlignedVector<float>& lows,
                       AlignedVector<float>& highs) {
    BlockedColumn column(size, threads, [&](std::size_t i) { return position(i, axis); });
    offsets = std::move(column.offset);
    origins = std::move(column.origin);
    std::copy(column.low.begin(), column.low.end(), lows.begin());
    std::copy(column.high.begin(), column.high.end(), highs.begin());
  };
  cut(0, x_, block_origin_x_, boxes.min_x, boxes.max_x);
  cut(1, y_, block_origin_y_, boxes.min_y, boxes.max_y);
  cut(2, z_, block_origin_z_, boxes.min_z, boxes.max_z);
  tree_ = BlockTree(std::move(boxes));
}

}  // namespace pcl_slim
