// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/knn.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/cloud/kernels.h"

namespace pcl_slim {

void
NeighborSearch::blockDistances(std::size_t block, const std::array<double, 3>& center,
                               float out[16]) const
{
  const float shift[3] = {static_cast<float>(store_.blockOriginX()[block] - center[0]),
                          static_cast<float>(store_.blockOriginY()[block] - center[1]),
                          static_cast<float>(store_.blockOriginZ()[block] - center[2])};
  const std::size_t first = block * PointStore::kBlock;
  kernels::blockDistances(store_.x() + first, store_.y() + first, store_.z() + first, shift, out);
}

/** Squared distance within which k points certainly lie: that of the k-th among the points of
 * the blocks before and after i in Morton order. */
float
NeighborSearch::boundRadiusSq(std::size_t i, std::size_t k, const std::array<double, 3>& center)
{
  const std::size_t blocks = store_.numBlocks();
  const std::size_t own = i / PointStore::kBlock;
  const std::size_t side = k / PointStore::kBlock + 1;
  std::size_t first = own > side ? own - side : 0;
  const std::size_t last = std::min(blocks - 1, own + side);
  while (first > 0 && (last - first) * PointStore::kBlock < k) --first;
  nearby_.clear();
  float distances[PointStore::kBlock];
  for (std::size_t b = first; b <= last; ++b) {
    blockDistances(b, center, distances);
    const std::size_t valid = std::min(PointStore::kBlock, store_.size() - b * PointStore::kBlock);
    nearby_.insert(nearby_.end(), distances, distances + valid);
  }
  const auto kth = nearby_.begin() + static_cast<std::ptrdiff_t>(std::min(k, nearby_.size()) - 1);
  std::nth_element(nearby_.begin(), kth, nearby_.end());
  return *kth;
}

void
NeighborSearch::nearest(std::size_t i, std::size_t k, std::vector<std::uint32_t>& neighbors,
                        std::vector<float>& distances_sq)
{
  k = std::min(k, store_.size());
  neighbors.resize(k);
  distances_sq.resize(k);
  if (k == 0) return;
  const auto center = store_.position(i);
  const float bound_sq = boundRadiusSq(i, k, center);
  const float c[3] = {static_cast<float>(center[0]), static_cast<float>(center[1]),
                      static_cast<float>(center[2])};
  // The margin covers the rounding of centre and boxes to float.
  const float radius = std::sqrt(bound_sq) * 1.000001f + 1e-7f;
  blocks_.clear();
  store_.tree().blocksInBall(c, radius, blocks_);
  candidates_.clear();
  float distances[PointStore::kBlock];
  for (const std::uint32_t b : blocks_) {
    blockDistances(b, center, distances);
    for (std::uint32_t lane = 0; lane < PointStore::kBlock; ++lane) {
      if (distances[lane] <= bound_sq) {
        candidates_.emplace_back(distances[lane],
                                 static_cast<std::uint32_t>(b * PointStore::kBlock + lane));
      }
    }
  }
  const auto end = candidates_.begin() + static_cast<std::ptrdiff_t>(k);
  std::partial_sort(candidates_.begin(), end, candidates_.end());
  for (std::size_t j = 0; j < k; ++j) {
    distances_sq[j] = candidates_[j].first;
    neighbors[j] = candidates_[j].second;
  }
}

}  // namespace pcl_slim
