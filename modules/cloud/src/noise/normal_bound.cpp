// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/detail/normal_bound.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kBlocks = 1000;    ///< looked at, evenly strided
constexpr std::size_t kLeastPoints = 8;  ///< of a block, for a mean to say something
constexpr double kOneSheet = 0.5;        ///< a mean normal shorter than this mixes sheets
constexpr double kDeviations = 3.0;
constexpr double kWidest = 0.6435;        ///< asin(0.6)
constexpr double kMedianOfTilt = 0.6931;  ///< of (1 - cos) / sigma^2 for tilts of sigma an axis

/** Adds 1 - cos of the angles between a block's normals and their mean. */
void
addTilts(const PointStore& store, std::size_t block, std::vector<double>& tilts)
{
  const std::size_t begin = block * PointStore::kBlock;
  const std::size_t end = std::min(begin + PointStore::kBlock, store.size());
  if (end < begin + kLeastPoints) return;
  double mean[3] = {};
  for (std::size_t i = begin; i < end; ++i) {
    const auto n = store.normal(i);
    for (std::size_t a = 0; a < 3; ++a) mean[a] += n[a];
  }
  const double length = std::sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
  if (length < kOneSheet * static_cast<double>(end - begin)) return;
  for (std::size_t i = begin; i < end; ++i) {
    const auto n = store.normal(i);
    tilts.push_back(1.0 - (n[0] * mean[0] + n[1] * mean[1] + n[2] * mean[2]) / length);
  }
}

}  // namespace

float
normalBound(const PointStore& store)
{
  std::vector<double> tilts;
  const std::size_t blocks = store.numBlocks(), stride = std::max<std::size_t>(1, blocks / kBlocks);
  for (std::size_t block = 0; block < blocks; block += stride) addTilts(store, block, tilts);
  if (tilts.empty()) return 0.0f;
  const auto median = tilts.begin() + static_cast<std::ptrdiff_t>(tilts.size() / 2);
  std::nth_element(tilts.begin(), median, tilts.end());
  const double sigma = std::sqrt(std::max(0.0, *median) / kMedianOfTilt);
  return static_cast<float>(-std::sin(std::min(kDeviations * sigma, kWidest)));
}

}  // namespace pcl_slim::detail
