// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/octree_cloud.h"

#include <algorithm>
#include <cmath>

#include "octree/octree_cloud_builder.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

using namespace detail;

Result<OctreeCloud>
OctreeCloud::build(const CloudView& cloud, const RootGrid& grid, int threads,
                   const ColorView& colors)
{
  return OctreeCloudBuilder(cloud, colors, resolveThreads(threads)).run(grid);
}

double
OctreeCloud::edge(int shift) const
{
  return std::ldexp(1.0, shift - depth_);
}

std::array<double, 3>
OctreeCloud::center(const std::array<float, 3>& position, int shift) const
{
  const double width = edge(shift);
  std::array<double, 3> c;
  for (std::size_t a = 0; a < 3; ++a) c[a] = (std::floor(position[a] / width) + 0.5) * width;
  return c;
}

std::size_t
OctreeCloud::rootOf(std::size_t point) const
{
  const auto after = std::upper_bound(roots_.begin(), roots_.end() - 1, point,
                                      [](std::size_t p, const Root& r) { return p < r.begin; });
  return static_cast<std::size_t>(after - roots_.begin()) - 1;
}

std::size_t
OctreeCloud::countCells(int growth) const
{
  std::size_t count = 1;
  for (std::size_t r = 1; r < numRoots(); ++r) {
    count += (roots_[r].key ^ roots_[r - 1].key) >> 3 * growth != 0;
  }
  return count;
}

}  // namespace pcl_slim
