// SPDX-License-Identifier: BSD-3-Clause
#include "store/cloud_summary.h"

#include <algorithm>
#include <vector>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time

CloudSummary
summarize(const CloudView& cloud, const CloudReader& reader, std::size_t begin, std::size_t end,
          const Bulk& bulk, bool need_normal)
{
  CloudSummary sum;
  Bounds box;
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
    box.add(p);
  }
  sum.min = box.low;
  sum.max = box.high;
  sum.finite = finite;
  sum.near = near;
  sum.with_normal = with_normal;
  return sum;
}

}  // namespace

void
CloudSummary::add(const CloudSummary& other)
{
  for (std::size_t a = 0; a < 3; ++a) {
    min[a] = std::min(min[a], other.min[a]);
    max[a] = std::max(max[a], other.max[a]);
  }
  finite += other.finite;
  near += other.near;
  with_normal += other.with_normal;
}

CloudSummary
summarizeAll(const CloudView& cloud, const CloudReader& reader, const Bulk& bulk, bool need_normal,
             int threads)
{
  const std::size_t n = cloud.count();
  const std::size_t slices = (n + kSlice - 1) / kSlice;
  std::vector<CloudSummary> parts(slices);
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    parts[s] =
        summarize(cloud, reader, s * kSlice, std::min(n, (s + 1) * kSlice), bulk, need_normal);
  });
  CloudSummary all;
  for (const CloudSummary& part : parts) all.add(part);
  return all;
}

}  // namespace pcl_slim::detail
