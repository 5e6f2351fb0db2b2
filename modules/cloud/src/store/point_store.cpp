// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/point_store.h"

#include <algorithm>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/stopwatch.h"
#include "store/point_store_builder.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** The steps after a builder's measure(). */
Result<PointStore>
finished(PointStoreBuilder& builder)
{
  if (Error error = builder.measure()) return error;
  builder.sortPoints();
  builder.mergeDuplicates();
  if (Error error = builder.fillSensors()) return error;
  builder.fillFrames();
  builder.fillBlocks();
  return builder.take();
}

}  // namespace

Result<PointStore>
PointStore::build(const CloudView& cloud, int threads, const PointStore* frame)
{
  const Stopwatch watch;
  PointStoreBuilder builder(cloud, resolveThreads(threads), frame);
  Result<PointStore> store = finished(builder);
  if (!store) return store;
  store->frame_.sensor = cloud.sensor;
  store->statistics_.seconds = watch.seconds();
  return store;
}

Result<PointStore>
PointStore::build(const CloudView& cloud, const StoreFrame& frame, int threads)
{
  const Stopwatch watch;
  PointStoreBuilder builder(cloud, resolveThreads(threads), frame);
  Result<PointStore> store = finished(builder);
  if (!store) return store;
  store->statistics_.seconds = watch.seconds();
  return store;
}

std::vector<std::uint32_t>
PointStore::storeOfInput() const
{
  std::vector<std::uint32_t> map(statistics_.input_points, kSkipped);
  for (std::size_t i = 0; i < size_; ++i) map[order_of_store_[i]] = static_cast<std::uint32_t>(i);
  for (const auto& [order, stored] : merged_) map[order] = stored;
  return map;
}

void
PointStore::setSides(const std::vector<std::array<float, 3>>& normals)
{
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

void
PointStore::clearSides()
{
  if (!found_sides_) return;
  for (auto* column : {&nx_, &ny_, &nz_}) *column = {};
  found_sides_ = false;
}

std::size_t
PointStore::memoryBytes() const
{
  const std::size_t floats = x_.size() + y_.size() + z_.size() + nx_.size() + ny_.size() +
                             nz_.size() + 3 * block_origin_x_.size();
  return floats * sizeof(float) + order_of_store_.size() * sizeof(std::uint32_t) +
         keys_.size() * sizeof(std::uint64_t) + sensors_.size() * sizeof(sensors_[0]) +
         frame_numbers_.size() * sizeof(frame_numbers_[0]) + merged_.size() * sizeof(merged_[0]) +
         tree_.memoryBytes();
}

}  // namespace pcl_slim
