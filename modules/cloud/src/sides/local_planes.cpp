// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/sides.h"

#include "noise/patch.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

std::vector<std::array<double, 3>>
feetOnLocalPlanes(const PointStore& store, std::size_t k, int threads)
{
  threads = resolveThreads(threads);
  std::vector<std::array<double, 3>> feet(store.size());
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads), NeighborSearch(store));
  parallelFor(store.size(), threads, 256, [&](std::size_t i, int thread) {
    thread_local Patch patch;
    // The next point's patch is about as wide as the last one's.
    patchAbout(store, searches[static_cast<std::size_t>(thread)], i, k, patch,
               probableSquare(patch.radius, 1));
    const Eigen::Vector3d normal = principalAxes(patch.points).eigenvectors().col(0);
    const Eigen::Vector3d sum = kernels::sumPatch(patch.points).first;
    const double height = normal.dot(sum) / static_cast<double>(patch.points.size());
    const std::array<double, 3> at = store.position(i);
    for (std::size_t a = 0; a < 3; ++a)
      feet[i][a] = at[a] + height * normal[static_cast<Eigen::Index>(a)];
  });
  return feet;
}

}  // namespace pcl_slim::detail
