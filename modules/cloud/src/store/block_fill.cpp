// SPDX-License-Identifier: BSD-3-Clause
// The last step of a store: sorted points, scattered over the caller's cloud, become blocks.
#include <algorithm>
#include <cmath>
#include <vector>

#include "pcl_slim/core/extent.h"
#include "pcl_slim/core/parallel.h"
#include "store/point_store_builder.h"

namespace pcl_slim {

using namespace detail;

namespace {

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr std::size_t kTask = 2048;      ///< blocks a thread takes at a time
constexpr std::size_t kBlocksAhead = 3;  ///< whose input is prefetched
constexpr float kBlockGrid = 0x1p22f;    ///< block origins are multiples of its inverse

}  // namespace

std::array<float, 3>
PointStoreBuilder::mergedNormal(std::size_t i) const
{
  const auto stored = static_cast<std::uint32_t>(i);
  auto n = reader_.normal(cloud_.inputIndex(order_[i]));
  auto it =
      std::lower_bound(store_.merged_.begin(), store_.merged_.end(), stored,
                       [](const auto& entry, std::uint32_t value) { return entry[1] < value; });
  if (it == store_.merged_.end() || (*it)[1] != stored) return n;
  // Each normal once, sorted: the result must not depend on how often and in which order points are given.
  std::vector<std::array<float, 3>> normals = {n};
  for (; it != store_.merged_.end() && (*it)[1] == stored; ++it) {
    normals.push_back(reader_.normal(cloud_.inputIndex((*it)[0])));
  }
  std::sort(normals.begin(), normals.end());
  normals.erase(std::unique(normals.begin(), normals.end()), normals.end());
  if (normals.size() == 1) return n;
  std::array<float, 3> sum{};
  for (const auto& m : normals) {
    for (int a = 0; a < 3; ++a) sum[a] += m[a];
  }
  const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  if (!(length > 1e-3f)) return normals.front();
  for (int a = 0; a < 3; ++a) n[a] = sum[a] / length;
  return n;
}

/** Prefetches the input of a block's points. */
void
PointStoreBuilder::prefetchBlock(std::size_t block) const
{
  const std::size_t begin = block * kBlock, end = std::min(store_.size_, begin + kBlock);
  for (std::size_t i = begin; i < end; ++i) {
    reader_.prefetch(cloud_.inputIndex(order_[i]), with_normals_);
  }
}

void
PointStoreBuilder::fillNormals(std::size_t begin, std::size_t count)
{
  float n[3][kBlock], scale[kBlock];
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::uint32_t order = order_[begin + std::min(i, count - 1)];
    const auto given = reader_.givenNormal(cloud_.inputIndex(order));
    for (int a = 0; a < 3; ++a) n[a][i] = given[a];
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    scale[i] = 1.0f / std::sqrt(n[0][i] * n[0][i] + n[1][i] * n[1][i] + n[2][i] * n[2][i]);
  }
  float* const columns[3] = {store_.nx_.data(), store_.ny_.data(), store_.nz_.data()};
  for (int a = 0; a < 3; ++a) {
    float* const column = columns[a] + begin;
    for (std::size_t i = 0; i < kBlock; ++i) column[i] = n[a][i] * scale[i];
    std::fill(column + count, column + kBlock, 0.0f);
  }
  for (std::size_t i = begin; !store_.merged_.empty() && i < begin + count; ++i) {
    const auto mean = mergedNormal(i);
    for (int a = 0; a < 3; ++a) columns[a][i] = mean[a];
  }
}

void
PointStoreBuilder::fillBlock(std::size_t block, BlockTree::Level& boxes)
{
  prefetchBlock(block + kBlocksAhead);
  const std::size_t begin = block * kBlock, count = std::min(kBlock, store_.size_ - begin);
  double local[3][kBlock];
  for (std::size_t i = 0; i < kBlock; ++i) {
    const std::uint32_t order = order_[begin + std::min(i, count - 1)];
    const auto p = reader_.position(cloud_.inputIndex(order));
    for (int a = 0; a < 3; ++a) local[a][i] = p[a];
  }
  float* const columns[3] = {store_.x_.data(), store_.y_.data(), store_.z_.data()};
  float* const origins[3] = {store_.block_origin_x_.data(), store_.block_origin_y_.data(),
                             store_.block_origin_z_.data()};
  float* const lows[3] = {boxes.min_x.data(), boxes.min_y.data(), boxes.min_z.data()};
  float* const highs[3] = {boxes.max_x.data(), boxes.max_y.data(), boxes.max_z.data()};
  for (int a = 0; a < 3; ++a) {
    for (double& p : local[a]) p = (p - store_.frame_.origin[a]) * inverse_scale_;
    const float origin = static_cast<float>(std::round(local[a][0] * kBlockGrid)) / kBlockGrid;
    float* const column = columns[a] + begin;
    for (std::size_t i = 0; i < kBlock; ++i) column[i] = static_cast<float>(local[a][i] - origin);
    const Extent extent = extentOf(column, kBlock);
    origins[a][block] = origin;
    lows[a][block] = origin + extent.low;
    highs[a][block] = origin + extent.high;
    std::fill(column + count, column + kBlock, PointStore::kFarAway);
  }
  if (with_normals_) fillNormals(begin, count);
}

void
PointStoreBuilder::fillBlocks()
{
  const std::size_t blocks = (store_.size_ + kBlock - 1) / kBlock;
  for (auto* column : {&store_.x_, &store_.y_, &store_.z_}) column->resize(blocks * kBlock);
  if (with_normals_) {
    for (auto* column : {&store_.nx_, &store_.ny_, &store_.nz_}) column->resize(blocks * kBlock);
  }
  for (auto* column : {&store_.block_origin_x_, &store_.block_origin_y_, &store_.block_origin_z_}) {
    column->resize(blocks);
  }
  BlockTree::Level boxes;
  boxes.allocate(blocks);
  parallelFor(blocks, threads_, kTask, [&](std::size_t b, int) { fillBlock(b, boxes); });
  store_.tree_ = BlockTree(std::move(boxes));
  store_.keys_ = std::move(keys_);
  store_.order_of_store_ = std::move(order_);
}

}  // namespace pcl_slim
