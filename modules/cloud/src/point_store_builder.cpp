// SPDX-License-Identifier: BSD-3-Clause
#include "point_store_builder.h"

#include <algorithm>
#include <limits>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time
constexpr double kOriginGrid = 0x1p-10;  ///< the origin is a multiple of this share of the scale
constexpr std::size_t kBlocksAhead = 3;  ///< whose input is asked for before it is read
constexpr float kBlockGrid = 0x1p22f;    ///< block origins are multiples of its inverse
constexpr double kFarOrigin = 256.0;     ///< beyond this many L, world floats cannot be exact

struct SliceSummary {
  double min[3], max[3];
  std::size_t finite = 0, with_normal = 0;
};

void
include(SliceSummary& s, const std::array<double, 3>& p)
{
  for (int a = 0; a < 3; ++a) {
    s.min[a] = std::min(s.min[a], p[a]);
    s.max[a] = std::max(s.max[a], p[a]);
  }
}

bool
isFinite(const std::array<double, 3>& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

bool
isZero(const std::array<float, 3>& n)
{
  return n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f;
}

SliceSummary
summarize(const CloudView& cloud, const CloudReader& reader, std::size_t begin, std::size_t end,
          bool need_normal)
{
  const double inf = std::numeric_limits<double>::infinity();
  SliceSummary s{{inf, inf, inf}, {-inf, -inf, -inf}};
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t input = cloud.inputIndex(i);
    const auto p = reader.position(input);
    if (!isFinite(p)) continue;
    ++s.finite;
    const bool has_normal = cloud.normal != nullptr && !isZero(reader.normal(input));
    s.with_normal += has_normal;
    if (has_normal || !need_normal) include(s, p);
  }
  return s;
}

SliceSummary
summarizeAll(const CloudView& cloud, const CloudReader& reader, bool need_normal, int threads)
{
  const std::size_t n = cloud.count();
  const std::size_t slices = (n + kSlice - 1) / kSlice;
  std::vector<SliceSummary> parts(slices);
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    parts[s] = summarize(cloud, reader, s * kSlice, std::min(n, (s + 1) * kSlice), need_normal);
  });
  SliceSummary all = parts.front();
  for (std::size_t s = 1; s < slices; ++s) {
    for (int a = 0; a < 3; ++a) {
      all.min[a] = std::min(all.min[a], parts[s].min[a]);
      all.max[a] = std::max(all.max[a], parts[s].max[a]);
    }
    all.finite += parts[s].finite;
    all.with_normal += parts[s].with_normal;
  }
  return all;
}

}  // namespace

PointStoreBuilder::PointStoreBuilder(const CloudView& cloud, int threads)
    : cloud_(cloud), reader_(cloud_), threads_(threads)
{
}

Error
PointStoreBuilder::measure()
{
  const std::size_t n = cloud_.count();
  if (n == 0 || cloud_.xyz == nullptr) {
    return {ErrorCode::kBadInput, "the cloud has no points: give one that has"};
  }
  if (n >= PointStore::kSkipped) {
    return {ErrorCode::kBadInput, "the cloud has more than 2^32 - 2 points: split it"};
  }
  for (std::size_t i = 0; cloud_.indices != nullptr && i < n; ++i) {
    if (cloud_.indices[i] < 0 || static_cast<std::size_t>(cloud_.indices[i]) >= cloud_.size) {
      return {ErrorCode::kBadArgument, "index " + std::to_string(cloud_.indices[i]) +
                                           " lies outside the cloud of " +
                                           std::to_string(cloud_.size) + " points"};
    }
  }
  SliceSummary all = summarizeAll(cloud_, reader_, false, threads_);
  if (all.finite == 0) {
    return {ErrorCode::kBadInput,
            "every point of the cloud is NaN or infinite: nothing to work on"};
  }
  with_normals_ = all.with_normal > 0;
  if (with_normals_ && all.with_normal < all.finite) {
    all = summarizeAll(cloud_, reader_, true, threads_);
  }
  store_.size_ = with_normals_ ? all.with_normal : all.finite;
  store_.statistics_.input_points = n;
  store_.statistics_.non_finite = n - all.finite;
  store_.statistics_.without_normal = all.finite - store_.size_;

  double half[3], farthest = 0;
  for (int a = 0; a < 3; ++a) {
    half[a] = 0.5 * all.max[a] - 0.5 * all.min[a];
    store_.origin_[a] = all.min[a] + half[a];
    farthest = std::max(farthest, std::abs(store_.origin_[a]));
  }
  const double diagonal = 2.0 * std::hypot(half[0], half[1], half[2]);
  // The slack keeps coordinates inside [-1/2, 1/2] once the origin is rounded to its grid.
  const double span = diagonal > 0 ? diagonal : std::max(farthest * 0x1p-20, 0x1p-100);
  store_.scale_ = std::exp2(std::ceil(std::log2(span * (1.0 + 4 * kOriginGrid))));
  if (!std::isfinite(store_.scale_)) {
    return {ErrorCode::kBadInput,
            "some coordinates come near the largest number there is: remove those points"};
  }
  store_.diagonal_ = diagonal / store_.scale_;
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
  return isFinite(position) && (!with_normals_ || !isZero(reader_.normal(input)));
}

std::array<double, 3>
PointStoreBuilder::localPosition(std::uint32_t order) const
{
  auto p = reader_.position(cloud_.inputIndex(order));
  const double inverse = 1.0 / store_.scale_;
  for (int a = 0; a < 3; ++a) p[a] = (p[a] - store_.origin_[a]) * inverse;
  return p;
}

void
PointStoreBuilder::sortPoints()
{
  const std::size_t n = cloud_.count();
  const std::size_t slices = (n + kSlice - 1) / kSlice;
  std::vector<std::size_t> first(slices + 1, 0);
  const bool all_usable = store_.size_ == n;
  const auto sliceEnd = [&](std::size_t s) { return std::min(n, (s + 1) * kSlice); };
  parallelFor(slices, threads_, 1, [&](std::size_t s, int) {
    std::size_t count = sliceEnd(s) - s * kSlice;
    if (!all_usable) {
      count = 0;
      for (std::size_t i = s * kSlice; i < sliceEnd(s); ++i) {
        const std::size_t input = cloud_.inputIndex(i);
        count += usable(reader_.position(input), input);
      }
    }
    first[s + 1] = count;
  });
  for (std::size_t s = 0; s < slices; ++s) first[s + 1] += first[s];
  keys_.resize(store_.size_);
  order_.resize(store_.size_);
  parallelFor(slices, threads_, 1, [&](std::size_t s, int) {
    std::size_t out = first[s];
    for (std::size_t i = s * kSlice; i < sliceEnd(s); ++i) {
      const std::size_t input = cloud_.inputIndex(i);
      if (!all_usable && !usable(reader_.position(input), input)) continue;
      const auto p = localPosition(static_cast<std::uint32_t>(i));
      keys_[out] = mortonCode(p[0], p[1], p[2]);
      order_[out++] = static_cast<std::uint32_t>(i);
    }
  });
  sortByKey(keys_, order_, threads_);
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

std::array<float, 3>
PointStoreBuilder::mergedNormal(std::size_t i) const
{
  const auto stored = static_cast<std::uint32_t>(i);
  auto n = reader_.normal(cloud_.inputIndex(order_[i]));
  auto it =
      std::lower_bound(store_.merged_.begin(), store_.merged_.end(), stored,
                       [](const auto& entry, std::uint32_t value) { return entry[1] < value; });
  if (it == store_.merged_.end() || (*it)[1] != stored) return n;
  std::array<float, 3> sum = n;
  for (; it != store_.merged_.end() && (*it)[1] == stored; ++it) {
    const auto m = reader_.normal(cloud_.inputIndex((*it)[0]));
    for (int a = 0; a < 3; ++a) sum[a] += m[a];
  }
  const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  if (length > 1e-3f) {
    for (int a = 0; a < 3; ++a) n[a] = sum[a] / length;
  }
  return n;
}

/** Asks for the input of a block's points, which lie anywhere in the cloud. */
void
PointStoreBuilder::prefetchBlock(std::size_t block) const
{
  const std::size_t begin = block * PointStore::kBlock;
  const std::size_t end = std::min(store_.size_, begin + PointStore::kBlock);
  for (std::size_t i = begin; i < end; ++i) {
    reader_.prefetch(cloud_.inputIndex(order_[i]), with_normals_);
  }
}

void
PointStoreBuilder::fillBlock(std::size_t block)
{
  prefetchBlock(block + kBlocksAhead);
  const std::size_t begin = block * PointStore::kBlock;
  const std::size_t end = std::min(store_.size_, begin + PointStore::kBlock);
  float* const columns[3] = {store_.x_.data(), store_.y_.data(), store_.z_.data()};
  float* const normals[3] = {store_.nx_.data(), store_.ny_.data(), store_.nz_.data()};
  float* const origins[3] = {store_.block_origin_x_.data(), store_.block_origin_y_.data(),
                             store_.block_origin_z_.data()};
  const auto first = localPosition(order_[begin]);
  for (int a = 0; a < 3; ++a) {
    origins[a][block] = static_cast<float>(std::round(first[a] * kBlockGrid)) / kBlockGrid;
  }
  for (std::size_t i = begin; i < end; ++i) {
    const auto p = localPosition(order_[i]);
    for (int a = 0; a < 3; ++a) columns[a][i] = static_cast<float>(p[a] - origins[a][block]);
    if (!with_normals_) continue;
    const auto n =
        store_.merged_.empty() ? reader_.normal(cloud_.inputIndex(order_[i])) : mergedNormal(i);
    for (int a = 0; a < 3; ++a) normals[a][i] = n[a];
  }
  for (std::size_t i = end; i < begin + PointStore::kBlock; ++i) {
    for (int a = 0; a < 3; ++a) columns[a][i] = PointStore::kFarAway;
    for (int a = 0; with_normals_ && a < 3; ++a) normals[a][i] = 0.0f;
  }
}

void
PointStoreBuilder::fillBlocks()
{
  const std::size_t blocks = (store_.size_ + PointStore::kBlock - 1) / PointStore::kBlock;
  const std::size_t padded = blocks * PointStore::kBlock;
  for (auto* column : {&store_.x_, &store_.y_, &store_.z_}) column->resize(padded);
  if (with_normals_) {
    for (auto* column : {&store_.nx_, &store_.ny_, &store_.nz_}) column->resize(padded);
  }
  for (auto* column : {&store_.block_origin_x_, &store_.block_origin_y_, &store_.block_origin_z_}) {
    column->resize(blocks);
  }
  BlockTree::Level boxes;
  boxes.allocate(blocks);
  parallelFor(blocks, threads_, kSlice / PointStore::kBlock, [&](std::size_t b, int) {
    fillBlock(b);
    const auto bound = [&](const AlignedVector<float>& column, float origin, float& low,
                           float& high) {
      const auto begin = column.begin() + static_cast<std::ptrdiff_t>(b * PointStore::kBlock);
      const std::size_t count = std::min(PointStore::kBlock, store_.size_ - b * PointStore::kBlock);
      const auto [lowest, highest] =
          std::minmax_element(begin, begin + static_cast<std::ptrdiff_t>(count));
      low = origin + *lowest;
      high = origin + *highest;
    };
    bound(store_.x_, store_.block_origin_x_[b], boxes.min_x[b], boxes.max_x[b]);
    bound(store_.y_, store_.block_origin_y_[b], boxes.min_y[b], boxes.max_y[b]);
    bound(store_.z_, store_.block_origin_z_[b], boxes.min_z[b], boxes.max_z[b]);
  });
  store_.tree_ = BlockTree(std::move(boxes));
  store_.keys_ = std::move(keys_);
  store_.order_of_store_ = std::move(order_);
}

}  // namespace pcl_slim
