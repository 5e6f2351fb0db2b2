// SPDX-License-Identifier: BSD-3-Clause
#include "store/bulk.h"

#include <algorithm>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "store/place_sample.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time

}  // namespace

Bulk
findBulk(const CloudView& cloud, const CloudReader& reader, int threads)
{
  const std::size_t n = cloud.count(), slices = (n + kSlice - 1) / kSlice;
  const auto most = static_cast<std::size_t>(resolveThreads(threads));
  const auto workers = static_cast<int>(std::clamp<std::size_t>(slices, 1, most));
  std::vector<PlaceSample> parts(static_cast<std::size_t>(workers));
  parallelFor(slices, workers, 1, [&](std::size_t s, int thread) {
    for (std::size_t i = s * kSlice; i < std::min(n, (s + 1) * kSlice); ++i) {
      const auto p = reader.position(cloud.inputIndex(i));
      if (isFinite(p)) parts[static_cast<std::size_t>(thread)].offer(p);
    }
  });
  PlaceSample all;
  for (PlaceSample& part : parts) all.merge(part);
  return all.bulk();
}

}  // namespace pcl_slim::detail
