// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/point_store.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/extent.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "pcl_slim/core/vector3.h"
#include "store/store.h"

namespace pcl_slim {

namespace detail {

namespace {

constexpr std::size_t kBlock = PointStore::kBlock;
constexpr std::size_t kKeyBatch = kernels::kMortonBatch;
constexpr std::size_t kTask = 2048;      ///< blocks a thread takes at a time
constexpr std::size_t kBlocksAhead = 3;  ///< whose input is prefetched

}  // namespace

/** \brief The steps of PointStore::build, in order. */
class PointStoreBuilder {
 public:
  PointStoreBuilder(const CloudView& cloud, int threads, const PointStore* frame);
  PointStoreBuilder(const CloudView& cloud, int threads, const StoreFrame& given);

  Error measure();         ///< which points count, their box, origin and scale
  void sortPoints();       ///< Morton keys, sorted
  void mergeDuplicates();  ///< equal positions become one entry
  Error fillSensors();     ///< where each point was seen from, if the cloud knows it
  void fillFrames();       ///< which frame each point is from, likewise
  void fillBlocks();       ///< block origins, offsets, normals, boxes
  PointStore take() { return std::move(store_); }

 private:
  std::array<double, 3> localPosition(std::uint32_t order) const;
  bool usable(const std::array<double, 3>& position, std::size_t input) const;
  bool allUsable() const { return store_.size_ == cloud_.count(); }
  Bulk bulkOfPoints() const;
  void adopt(const StoreFrame& frame);
  std::size_t countUsable(std::size_t begin, std::size_t end) const;
  void makeKeys(std::size_t begin, std::size_t end, std::size_t out);
  void mergeRun(std::size_t begin, std::size_t end, std::size_t& kept);
  void prefetchBlock(std::size_t block) const;
  void fillBlock(std::size_t block, BlockTree::Level& boxes);
  void fillNormals(std::size_t begin, std::size_t count);
  std::array<float, 3> mergedNormal(std::size_t i) const;

  const CloudView& cloud_;
  CloudReader reader_;
  int threads_;
  const PointStore* larger_ = nullptr;  ///< store of a larger cloud, or null
  const StoreFrame* given_ = nullptr;   ///< units that are not to be measured, or null
  bool with_normals_ = false;
  double inverse_scale_ = 1;
  Bulk bulk_;  ///< of the usable points
  PointStore store_;
  AlignedVector<std::uint64_t> keys_;
  AlignedVector<std::uint32_t> usable_;  ///< position in the caller's sequence, where some are not
  AlignedVector<std::uint32_t> order_;   ///< position in the caller's sequence, per sorted point
};

PointStoreBuilder::PointStoreBuilder(const CloudView& cloud, int threads, const PointStore* frame)
    : cloud_(cloud), reader_(cloud_), threads_(threads), larger_(frame) {}

PointStoreBuilder::PointStoreBuilder(const CloudView& cloud, int threads, const StoreFrame& given)
    : cloud_(cloud), reader_(cloud_), threads_(threads), given_(&given) {}

/** \brief Which of the points are strays: by the given frame, the store this one belongs to, or
 * these points themselves. */
Bulk PointStoreBuilder::bulkOfPoints() const {
  if (given_) return {given_->bulk_center, given_->bulk_between, given_->bulk_reach};
  if (larger_)
    return {larger_->frame().bulk_center, larger_->frame().bulk_between,
            larger_->frame().bulk_reach};
  return findBulk(cloud_, reader_, threads_);
}

Error PointStoreBuilder::measure() {
  if (Error error = cloud_.validate()) return error;
  bulk_ = bulkOfPoints();
  CloudSummary all = summarizeAll(cloud_, reader_, bulk_, given_ && given_->with_normals, threads_);
  if (all.near == 0) return CloudView::nothingFinite();
  with_normals_ = given_ ? given_->with_normals : all.with_normal > 0;
  if (!given_ && with_normals_ && all.with_normal < all.near)
    all = summarizeAll(cloud_, reader_, bulk_, true, threads_);
  store_.size_ = with_normals_ ? all.with_normal : all.near;
  if (store_.size_ == 0) return CloudView::nothingFinite();
  store_.statistics_.input_points = cloud_.count();
  store_.statistics_.non_finite = cloud_.count() - all.finite;
  store_.statistics_.far_away = all.finite - all.near;
  store_.statistics_.without_normal = all.near - store_.size_;
  StoreFrame own;
  const double least = larger_ ? larger_->diagonal() * larger_->scale() : 0.0;
  if (!given_) {
    if (Error error = setUnits(all.min, all.max, bulk_, least, own)) return error;
  }
  adopt(given_ ? *given_ : own);
  return {};
}

void PointStoreBuilder::adopt(const StoreFrame& frame) {
  store_.frame_ = frame;
  inverse_scale_ = 1.0 / store_.frame_.scale;
}

bool PointStoreBuilder::usable(const std::array<double, 3>& position, std::size_t input) const {
  return isFinite(position) && bulk_.holds(position) &&
         (!with_normals_ || reader_.hasNormal(input));
}

std::array<double, 3> PointStoreBuilder::localPosition(std::uint32_t order) const {
  auto p = reader_.position(cloud_.inputIndex(order));
  for (int a = 0; a < 3; ++a) p[a] = (p[a] - store_.frame_.origin[a]) * inverse_scale_;
  return p;
}

void PointStoreBuilder::sortPoints() {
  const std::size_t n = cloud_.count();
  const std::size_t slices = (n + kSlice - 1) / kSlice;
  std::vector<std::size_t> first(slices + 1, 0);
  const auto sliceEnd = [&](std::size_t s) { return std::min(n, (s + 1) * kSlice); };
  parallelFor(slices, threads_, 1,
              [&](std::size_t s, int) { first[s + 1] = countUsable(s * kSlice, sliceEnd(s)); });
  for (std::size_t s = 0; s < slices; ++s) first[s + 1] += first[s];
  keys_.resize(store_.size_);
  if (!allUsable()) usable_.resize(store_.size_);
  parallelFor(slices, threads_, 1,
              [&](std::size_t s, int) { makeKeys(s * kSlice, sliceEnd(s), first[s]); });
  sortByKey(keys_, order_, threads_);
  if (!allUsable()) {
    for (std::uint32_t& order : order_) order = usable_[order];
  }
}

std::size_t PointStoreBuilder::countUsable(std::size_t begin, std::size_t end) const {
  if (allUsable()) return end - begin;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t input = cloud_.inputIndex(i);
    count += usable(reader_.position(input), input);
  }
  return count;
}

/** Writes keys of the view's points from begin to end, in batches, from out on. */
void PointStoreBuilder::makeKeys(std::size_t begin, std::size_t end, std::size_t out) {
  alignas(64) double batch[3][kKeyBatch] = {};
  std::size_t count = 0;
  const auto flush = [&] {
    alignas(64) std::uint64_t codes[kKeyBatch];
    kernels::mortonCodes(batch, store_.frame_.origin.data(), inverse_scale_, codes);
    std::copy_n(codes, count, keys_.begin() + static_cast<std::ptrdiff_t>(out));
    out += count;
    count = 0;
  };
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t input = cloud_.inputIndex(i);
    const auto p = reader_.position(input);
    if (!allUsable()) {
      if (!usable(p, input)) continue;
      usable_[out + count] = static_cast<std::uint32_t>(i);
    }
    for (int a = 0; a < 3; ++a) batch[a][count] = p[a];
    if (++count == kKeyBatch) flush();
  }
  flush();
}

void PointStoreBuilder::mergeDuplicates() {
  const std::size_t n = keys_.size();
  std::size_t kept = 0, i = 0;
  const auto repeated = std::adjacent_find(keys_.begin(), keys_.end());
  kept = i = static_cast<std::size_t>(repeated - keys_.begin());
  while (i < n) {
    std::size_t end = i + 1;
    while (end < n && keys_[end] == keys_[i]) ++end;
    mergeRun(i, end, kept);
    i = end;
  }
  store_.statistics_.duplicates = n - kept;
  store_.size_ = kept;
  keys_.resize(kept);
  order_.resize(kept);
}

/** Points of one Morton cell, [begin, end): orders them by position and keeps one of each. */
void PointStoreBuilder::mergeRun(std::size_t begin, std::size_t end, std::size_t& kept) {
  const std::uint64_t key = keys_[begin];
  if (end - begin == 1) {
    keys_[kept] = key;
    order_[kept++] = order_[begin];
    return;
  }
  std::vector<std::pair<std::array<double, 3>, std::uint32_t>> run;
  for (std::size_t i = begin; i < end; ++i) run.emplace_back(localPosition(order_[i]), order_[i]);
  std::sort(run.begin(), run.end());
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (i > 0 && run[i].first == run[i - 1].first) {
      store_.merged_.push_back({run[i].second, static_cast<std::uint32_t>(kept - 1)});
    } else {
      keys_[kept] = key;
      order_[kept++] = run[i].second;
    }
  }
}

Error PointStoreBuilder::fillSensors() {
  if (cloud_.sensors == nullptr) return {};
  store_.sensors_.resize(store_.size_);
  parallelFor(store_.size_, threads_, kSlice, [&](std::size_t i, int) {
    const auto place = cloud_.sensorPosition(cloud_.inputIndex(order_[i]));
    for (std::size_t a = 0; a < 3; ++a) {
      const double local = (place[a] - store_.frame_.origin[a]) * inverse_scale_;
      store_.sensors_[i][a] = static_cast<float>(local);
    }
  });
  for (std::size_t i = 0; i < store_.size_; ++i) {
    const auto& s = store_.sensors_[i];
    if (isFinite(s)) continue;
    return badInput(
        "the sensor of point " + std::to_string(cloud_.inputIndex(order_[i])) +
        " is nowhere (NaN, infinite or too far away): give each point's place, or none");
  }
  return {};
}

void PointStoreBuilder::fillFrames() {
  if (cloud_.frame_numbers == nullptr) return;
  store_.frame_numbers_.resize(store_.size_);
  parallelFor(store_.size_, threads_, kSlice, [&](std::size_t i, int) {
    store_.frame_numbers_[i] = cloud_.frame_numbers[cloud_.inputIndex(order_[i])];
  });
}

// The last step: sorted points, scattered over the caller's cloud, become blocks.

std::array<float, 3> PointStoreBuilder::mergedNormal(std::size_t i) const {
  const auto stored = static_cast<std::uint32_t>(i);
  auto n = reader_.normal(cloud_.inputIndex(order_[i]));
  auto it =
      std::lower_bound(store_.merged_.begin(), store_.merged_.end(), stored,
                       [](const auto& entry, std::uint32_t value) { return entry[1] < value; });
  if (it == store_.merged_.end() || (*it)[1] != stored) return n;
  // Each normal once, sorted: the result must not depend on how often and in which order points are
  // given.
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
void PointStoreBuilder::prefetchBlock(std::size_t block) const {
  const std::size_t begin = block * kBlock, end = std::min(store_.size_, begin + kBlock);
  for (std::size_t i = begin; i < end; ++i) {
    reader_.prefetch(cloud_.inputIndex(order_[i]), with_normals_);
  }
}

void PointStoreBuilder::fillNormals(std::size_t begin, std::size_t count) {
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

void PointStoreBuilder::fillBlock(std::size_t block, BlockTree::Level& boxes) {
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

void PointStoreBuilder::fillBlocks() {
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

namespace {

/** The store that a builder's steps make. */
Result<PointStore> finished(PointStoreBuilder& builder) {
  if (Error error = builder.measure()) return error;
  builder.sortPoints();
  builder.mergeDuplicates();
  if (Error error = builder.fillSensors()) return error;
  builder.fillFrames();
  builder.fillBlocks();
  return builder.take();
}

}  // namespace

}  // namespace detail

using namespace detail;

Result<PointStore> PointStore::build(const CloudView& cloud, int threads, const PointStore* frame) {
  const Stopwatch watch;
  PointStoreBuilder builder(cloud, resolveThreads(threads), frame);
  Result<PointStore> store = finished(builder);
  if (!store) return store;
  store->frame_.sensor = cloud.sensor;
  store->statistics_.seconds = watch.seconds();
  return store;
}

Result<PointStore> PointStore::build(const CloudView& cloud, const StoreFrame& frame, int threads) {
  const Stopwatch watch;
  PointStoreBuilder builder(cloud, resolveThreads(threads), frame);
  Result<PointStore> store = finished(builder);
  if (!store) return store;
  store->statistics_.seconds = watch.seconds();
  return store;
}

std::vector<std::uint32_t> PointStore::storeOfInput() const {
  std::vector<std::uint32_t> map(statistics_.input_points, kSkipped);
  for (std::size_t i = 0; i < size_; ++i) map[order_of_store_[i]] = static_cast<std::uint32_t>(i);
  for (const auto& [order, stored] : merged_) map[order] = stored;
  return map;
}

void PointStore::setSides(const std::vector<std::array<float, 3>>& normals) {
  if (hasNormals() || normals.size() != size_) return;
  AlignedVector<float>* const columns[3] = {&nx_, &ny_, &nz_};
  for (std::size_t a = 0; a < 3; ++a) {
    AlignedVector<float>& column = *columns[a];
    column.resize(numBlocks() * kBlock);
    for (std::size_t i = 0; i < size_; ++i) column[i] = normals[i][a];
    std::fill(column.begin() + static_cast<std::ptrdiff_t>(size_), column.end(), 0.0f);
  }
  found_sides_ = true;
}

void PointStore::clearSides() {
  if (!found_sides_) return;
  for (auto* column : {&nx_, &ny_, &nz_}) *column = {};
  found_sides_ = false;
}

void PointStore::turnNormals(const std::vector<signed char>& signs) {
  if (!hasNormals() || signs.size() != size_) return;
  for (auto* column : {&nx_, &ny_, &nz_}) {
    for (std::size_t i = 0; i < size_; ++i) {
      if (signs[i] < 0) (*column)[i] = -(*column)[i];
    }
  }
}

void PointStore::dropNormals() {
  if (!hasNormals()) return;
  for (auto* column : {&nx_, &ny_, &nz_}) *column = {};
  frame_.with_normals = false;
}

std::size_t PointStore::memoryBytes() const {
  const std::size_t floats = x_.size() + y_.size() + z_.size() + nx_.size() + ny_.size() +
                             nz_.size() + 3 * block_origin_x_.size();
  return floats * sizeof(float) + order_of_store_.size() * sizeof(std::uint32_t) +
         keys_.size() * sizeof(std::uint64_t) + sensors_.size() * sizeof(sensors_[0]) +
         frame_numbers_.size() * sizeof(frame_numbers_[0]) + merged_.size() * sizeof(merged_[0]) +
         tree_.memoryBytes();
}

}  // namespace pcl_slim
