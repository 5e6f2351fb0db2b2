// SPDX-License-Identifier: BSD-3-Clause
#include "rays/leaf_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {
namespace {

/** \brief An interval of heights over the disc u^2 + v^2 <= a^2, in radii. */
struct HeightRange {
  double low, high;

  HeightRange(const SLIMSurface& surface, std::size_t i, double a)
  {
    const float* c = surface.coefficientsOf(i);
    const double slope = a * std::hypot(c[1], c[2]);
    low = c[0] - slope;
    high = c[0] + slope;
    if (surface.degree[i] < 2) return;
    const double mean = 0.5 * (double{c[3]} + c[5]);
    const double spread = std::hypot(0.5 * (double{c[3]} - c[5]), 0.5 * double{c[4]});
    low += a * a * std::min(0.0, mean - spread);
    high += a * a * std::max(0.0, mean + spread);
    double power = a * a;
    for (int degree = 3, k = 6; degree <= surface.degree[i]; ++degree) {
      double sum = 0.0;
      for (int j = 0; j <= degree; ++j, ++k) sum += std::abs(double{c[k]});
      power *= a;
      low -= power * sum;
      high += power * sum;
    }
  }
};

}  // namespace

Box
boxOfLeaf(const SLIMSurface& surface, std::size_t i, double share, double slack)
{
  const HeightRange heights(surface, i, share);
  const double low = std::clamp(heights.low - slack, -share, share);
  const double high = std::clamp(heights.high + slack, -share, share);
  const float center[3] = {surface.cx[i], surface.cy[i], surface.cz[i]};
  const float normal[3] = {surface.nx[i], surface.ny[i], surface.nz[i]};
  Box box;
  for (int a = 0; a < 3; ++a) {
    const double n = normal[a], r = surface.radius[i];
    const double flat = share * std::sqrt(std::max(0.0, 1.0 - n * n));
    const double from = std::max(-share, std::min(low * n, high * n) - flat);
    const double to = std::min(share, std::max(low * n, high * n) + flat);
    box.low[a] = static_cast<float>(center[a] + r * from);
    box.high[a] = static_cast<float>(center[a] + r * to);
  }
  return box;
}

LeafBlocks::LeafBlocks(const SLIMSurface& surface, const std::vector<std::uint32_t>& leaves,
                       const std::vector<std::uint32_t>& order)
{
  const auto coefficients = static_cast<std::size_t>(std::max(6, surface.stride()));
  stride_ = kWide * (kBlockCoefficients + coefficients);
  const std::size_t blocks = order.size() / kWide;
  heads_.resize(blocks);
  columns_.assign(blocks * stride_, 0.0f);
  for (std::size_t block = 0; block < blocks; ++block) {
    std::uint32_t surfels[kWide];
    for (std::size_t k = 0; k < kWide; ++k) {
      const std::uint32_t place = order[block * kWide + k];
      surfels[k] = place == WideTree::kNothing ? WideTree::kNothing : leaves[place];
    }
    fill(surface, surfels, block);
  }
}

void
LeafBlocks::fill(const SLIMSurface& surface, const std::uint32_t* surfels, std::size_t block)
{
  constexpr float kFarAway = 1e15f;  // its square is still finite
  Head& head = heads_[block];
  float* lanes = columns_.data() + block * stride_;
  const std::uint32_t first = surfels[0];
  const std::array<float, 3> center{surface.cx[first], surface.cy[first], surface.cz[first]};
  std::copy(center.begin(), center.end(), head.center);
  std::copy(surfels, surfels + kWide, head.surfel);
  head.degree = 1;
  const auto at = [&](std::size_t column, std::size_t k) -> float& {
    return lanes[column * kWide + k];
  };
  for (std::size_t k = 0; k < kWide; ++k) {
    const std::uint32_t s = surfels[k];
    const bool is = s != WideTree::kNothing;
    at(kBlockX, k) = is ? surface.cx[s] - center[0] : kFarAway;
    at(kBlockY, k) = is ? surface.cy[s] - center[1] : 0.0f;
    at(kBlockZ, k) = is ? surface.cz[s] - center[2] : 0.0f;
    at(kBlockRadius, k) = is ? surface.radius[s] : 1.0f;
    at(kBlockInverseRadius, k) = is ? 1.0f / surface.radius[s] : 1.0f;
    at(kBlockNX, k) = is ? surface.nx[s] : 0.0f;
    at(kBlockNY, k) = is ? surface.ny[s] : 0.0f;
    at(kBlockNZ, k) = is ? surface.nz[s] : 1.0f;
    if (!is) continue;
    at(kBlockVariance, k) = surface.info.paper_mode ? 1.0f : surface.varianceWeight(s);
    head.degree = std::max(head.degree, static_cast<int>(surface.degree[s]));
    const float* c = surface.coefficientsOf(s);
    for (int j = 0; j < numCoefficients(surface.degree[s]); ++j) {
      at(kBlockCoefficients + static_cast<std::size_t>(j), k) = c[j];
    }
  }
}

}  // namespace pcl_slim::detail
