// SPDX-License-Identifier: BSD-3-Clause
#include "store/point_store_builder.h"

#include <algorithm>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time
constexpr double kOriginGrid = 0x1p-10;  ///< the origin is a multiple of this share of the scale
constexpr std::size_t kKeyBatch = kernels::kMortonBatch;
constexpr double kFarOrigin = 256.0;       ///< beyond this many L, world floats cannot be exact
constexpr double kLeastScale = 0x1p-1000;  ///< its inverse, and 2^-22 of it, are normal numbers

/** What some points come to; the box is that of those that count. */
struct SliceSummary {
  std::array<double, 3> min, max;
  std::size_t finite = 0, near = 0, with_normal = 0;
};

bool
isFinite(const std::array<double, 3>& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

SliceSummary
summarize(const CloudView& cloud, const CloudReader& reader, std::size_t begin, std::size_t end,
          const Bulk& bulk, bool need_normal)
{
  const double inf = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{inf, inf, inf}, high{-inf, -inf, -inf};
  std::size_t finite = 0, near = 0, with_normal = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t input = cloud.inputIndex(i);
    const auto p = reader.position(input);
    if (!isFinite(p)) continue;
    ++finite;
    if (!bulk.holds(p)) continue;
    ++near;
    const bool has_normal = cloud.normal != nullptr && reader.hasNormal(input);
    with_normal += has_normal;
    if (!has_normal && need_normal) continue;
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  return {low, high, finite, near, with_normal};
}

SliceSummary
summarizeAll(const CloudView& cloud, const CloudReader& reader, const Bulk& bulk, bool need_normal,
             int threads)
{
  const std::size_t n = cloud.count();
  const std::size_t slices = (n + kSlice - 1) / kSlice;
  std::vector<SliceSummary> parts(slices);
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    parts[s] =
        summarize(cloud, reader, s * kSlice, std::min(n, (s + 1) * kSlice), bulk, need_normal);
  });
  SliceSummary all = parts.front();
  for (std::size_t s = 1; s < slices; ++s) {
    for (int a = 0; a < 3; ++a) {
      all.min[a] = std::min(all.min[a], parts[s].min[a]);
      all.max[a] = std::max(all.max[a], parts[s].max[a]);
    }
    all.finite += parts[s].finite;
    all.near += parts[s].near;
    all.with_normal += parts[s].with_normal;
  }
  return all;
}

}  // namespace

PointStoreBuilder::PointStoreBuilder(const CloudView& cloud, int threads, const PointStore* frame)
    : cloud_(cloud), reader_(cloud_), threads_(threads), frame_(frame)
{
}

Error
PointStoreBuilder::measure()
{
  if (Error error = cloud_.validate()) return error;
  bulk_ = frame_ ? Bulk{frame_->bulk_center_, frame_->bulk_between_, frame_->bulk_reach_}
                 : findBulk(cloud_, reader_, threads_);
  store_.bulk_center_ = bulk_.median;
  store_.bulk_between_ = bulk_.between;
  store_.bulk_reach_ = bulk_.reach;
  SliceSummary all = summarizeAll(cloud_, reader_, bulk_, false, threads_);
  if (all.near == 0) return CloudView::nothingFinite();
  with_normals_ = all.with_normal > 0;
  if (with_normals_ && all.with_normal < all.near) {
    all = summarizeAll(cloud_, reader_, bulk_, true, threads_);
  }
  store_.size_ = with_normals_ ? all.with_normal : all.near;
  store_.statistics_.input_points = cloud_.count();
  store_.statistics_.non_finite = cloud_.count() - all.finite;
  store_.statistics_.far_away = all.finite - all.near;
  store_.statistics_.without_normal = all.near - store_.size_;
  return setUnits(all.min, all.max);
}

/** Origin, scale, diagonal and the grid of centres, from the box of the points that count. */
Error
PointStoreBuilder::setUnits(const std::array<double, 3>& low, const std::array<double, 3>& high)
{
  double half[3], farthest = 0;
  for (int a = 0; a < 3; ++a) {
    half[a] = 0.5 * high[a] - 0.5 * low[a];
    store_.origin_[a] = low[a] + half[a];
    farthest = std::max(farthest, std::abs(store_.origin_[a]));
  }
  const double diagonal = 2.0 * std::hypot(half[0], half[1], half[2]);
  // The slack keeps coordinates inside [-1/2, 1/2] once the origin is rounded to its grid.
  const double least = frame_ ? frame_->diagonal_ * frame_->scale_ : 0.0;
  const double one_place = std::max(farthest * 0x1p-20, 0x1p-100);
  const double span = std::max(diagonal > 0 ? diagonal : one_place, least);
  store_.scale_ = std::exp2(std::ceil(std::log2(span * (1.0 + 4 * kOriginGrid))));
  if (!std::isfinite(store_.scale_)) {
    return {ErrorCode::kBadInput,
            "some coordinates come near the largest number there is: remove those points"};
  }
  if (store_.scale_ < kLeastScale) {
    return {
        ErrorCode::kBadInput,
        "the points differ by less than 1e-301, too little to compute with: give coordinates in a "
        "smaller unit"};
  }
  inverse_scale_ = 1.0 / store_.scale_;
  store_.diagonal_ = diagonal / store_.scale_;
  constexpr double kQuartiles =
      4.0;  // of points spread evenly L is twice as wide as their quartiles
  store_.bulk_diagonal_ = std::min(store_.diagonal_, kQuartiles * bulk_.between / store_.scale_);
  const double origin_grid = store_.scale_ * kOriginGrid;
  for (double& o : store_.origin_) o = std::round(o / origin_grid) * origin_grid;
  const double reach = farthest / store_.scale_ + 0.5 + kOriginGrid;
  if (reach < kFarOrigin) {
    store_.center_grid_ = std::max(0x1p-22, std::exp2(std::ceil(std::log2(reach)) - 24));
  }
  return {};
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
  for (int a = 0; a < 3; ++a) p[a] = (p[a] - store_.origin_[a]) * inverse_scale_;
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

/** Writes keys of the points asked for from begin to end, in batches, from out on. */
void
PointStoreBuilder::makeKeys(std::size_t begin, std::size_t end, std::size_t out)
{
  alignas(64) double batch[3][kKeyBatch] = {};
  std::size_t count = 0;
  const auto flush = [&] {
    alignas(64) std::uint64_t codes[kKeyBatch];
    kernels::mortonCodes(batch, store_.origin_.data(), inverse_scale_, codes);
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

}  // namespace pcl_slim::detail
