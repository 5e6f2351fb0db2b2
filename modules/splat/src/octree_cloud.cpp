// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/octree_cloud.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree_cloud_builder.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

Result<OctreeCloud>
OctreeCloud::build(const CloudView& cloud, const ColorView& colors, const LabTable& table,
                   const RootGrid& grid, int threads)
{
  return OctreeCloudBuilder(cloud, colors, table, resolveThreads(threads)).run(grid);
}

double
OctreeCloud::edge(int shift) const
{
  return std::ldexp(1.0, shift - depth_);
}

std::array<double, 3>
OctreeCloud::center(std::size_t i, int shift) const
{
  std::array<std::uint64_t, 3> corner{};
  for (int bit = kBits - 1; bit >= shift; --bit) {
    const std::uint64_t octant = keys_[i] >> 3 * bit;
    corner[0] |= (octant >> 2 & 1) << bit;
    corner[1] |= (octant >> 1 & 1) << bit;
    corner[2] |= (octant & 1) << bit;
  }
  std::array<double, 3> c;
  for (std::size_t a = 0; a < 3; ++a) {
    c[a] = std::ldexp(static_cast<double>(corner[a]), -depth_) + 0.5 * edge(shift);
  }
  return c;
}

std::size_t
OctreeCloud::countCells(int shift, int threads) const
{
  using octree_cloud::kSlice;
  const std::size_t n = size(), slices = (n + kSlice - 1) / kSlice;
  std::vector<std::size_t> parts(slices, 0);
  parallelFor(slices, resolveThreads(threads), 1, [&](std::size_t s, int) {
    std::size_t count = s == 0 ? 1 : 0;
    for (std::size_t i = std::max<std::size_t>(1, s * kSlice); i < std::min(n, (s + 1) * kSlice);
         ++i) {
      count += (keys_[i] ^ keys_[i - 1]) >> 3 * shift != 0;
    }
    parts[s] = count;
  });
  std::size_t total = 0;
  for (const std::size_t part : parts) total += part;
  return total;
}

}  // namespace pcl_slim
