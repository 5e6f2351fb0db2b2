// SPDX-License-Identifier: BSD-3-Clause
#include "store/point_store_builder.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "store/cloud_summary.h"
#include "store/frame_units.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time
constexpr std::size_t kKeyBatch = kernels::kMortonBatch;

}  // namespace

PointStoreBuilder::PointStoreBuilder(const CloudView& cloud, int threads, const PointStore* frame)
    : cloud_(cloud), reader_(cloud_), threads_(threads), larger_(frame)
{
}

PointStoreBuilder::PointStoreBuilder(const CloudView& cloud, int threads, const StoreFrame& given)
    : cloud_(cloud), reader_(cloud_), threads_(threads), given_(&given)
{
}

/** \brief Which of the points are strays: by the given frame, the store this one belongs to, or these
 * points themselves. */
Bulk
PointStoreBuilder::bulkOfPoints() const
{
  if (given_) return {given_->bulk_center, given_->bulk_between, given_->bulk_reach};
  if (larger_)
    return {larger_->frame().bulk_center, larger_->frame().bulk_between,
            larger_->frame().bulk_reach};
  return findBulk(cloud_, reader_, threads_);
}

Error
PointStoreBuilder::measure()
{
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

void
PointStoreBuilder::adopt(const StoreFrame& frame)
{
  store_.frame_ = frame;
  inverse_scale_ = 1.0 / store_.frame_.scale;
}

bool
PointStoreBuilder::usable(const std::array<double, 3>& position, std::size_t input) const
{
  return isFinite(position) && bulk_.holds(position) &&
         (!with_normals_ || reader_.hasNormal(input));
}

std::array<double, 3>
PointStoreBuilder::localPosition(std::uint32_t order) const
{
  auto p = reader_.position(cloud_.inputIndex(order));
  for (int a = 0; a < 3; ++a) p[a] = (p[a] - store_.frame_.origin[a]) * inverse_scale_;
  return p;
}

void
PointStoreBuilder::sortPoints()
{
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

std::size_t
PointStoreBuilder::countUsable(std::size_t begin, std::size_t end) const
{
  if (allUsable()) return end - begin;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t input = cloud_.inputIndex(i);
    count += usable(reader_.position(input), input);
  }
  return count;
}

/** Writes keys of the view's points from begin to end, in batches, from out on. */
void
PointStoreBuilder::makeKeys(std::size_t begin, std::size_t end, std::size_t out)
{
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

void
PointStoreBuilder::mergeDuplicates()
{
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
void
PointStoreBuilder::mergeRun(std::size_t begin, std::size_t end, std::size_t& kept)
{
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

Error
PointStoreBuilder::fillSensors()
{
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

void
PointStoreBuilder::fillFrames()
{
  if (cloud_.frame_numbers == nullptr) return;
  store_.frame_numbers_.resize(store_.size_);
  parallelFor(store_.size_, threads_, kSlice, [&](std::size_t i, int) {
    store_.frame_numbers_[i] = cloud_.frame_numbers[cloud_.inputIndex(order_[i])];
  });
}

}  // namespace pcl_slim::detail
