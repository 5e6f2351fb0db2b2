// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/normal_bound.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::detail {

namespace {

constexpr double kMedianOfTilt =
    0.6931;  ///< median of (1 - cos) / sigma^2 for tilts of sigma about each axis

/** Adds 1 - cos of the angles between a block's normals and their mean. */
void
addTilts(const PointStore& store, std::size_t block, const NormalBoundConstants& constants,
         std::vector<double>& tilts)
{
  const std::size_t begin = block * PointStore::kBlock;
  const std::size_t end = std::min(begin + PointStore::kBlock, store.size());
  if (end < begin + constants.least_points) return;
  double mean[3] = {};
  for (std::size_t i = begin; i < end; ++i) {
    const auto n = store.normal(i);
    for (std::size_t a = 0; a < 3; ++a) mean[a] += n[a];
  }
  const double length = std::sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
  if (length < constants.one_sheet * static_cast<double>(end - begin)) return;
  for (std::size_t i = begin; i < end; ++i) {
    const auto n = store.normal(i);
    tilts.push_back(1.0 - (n[0] * mean[0] + n[1] * mean[1] + n[2] * mean[2]) / length);
  }
}

}  // namespace

float
normalBound(const PointStore& store, const NormalBoundConstants& constants)
{
  std::vector<double> tilts;
  const double least_fall = store.hasNormals() ? constants.least_turn : 0;
  const std::size_t blocks = store.numBlocks(),
                    stride = std::max<std::size_t>(1, blocks / constants.blocks);
  for (std::size_t block = 0; block < blocks; block += stride)
    addTilts(store, block, constants, tilts);
  if (tilts.empty()) return static_cast<float>(-least_fall);
  const double sigma = std::sqrt(std::max(0.0, median(tilts)) / kMedianOfTilt);
  return static_cast<float>(
      std::min(-least_fall, -std::sin(std::min(constants.deviations * sigma, constants.widest))));
}

}  // namespace pcl_slim::detail
