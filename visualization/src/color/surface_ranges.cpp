// SPDX-License-Identifier: BSD-3-Clause
#include "color/surface_ranges.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {
namespace {

using Weighted = std::pair<double, double>;  ///< value, area

/** \brief The value below which a share of the area lies. */
double
quantile(const std::vector<Weighted>& sorted, double share)
{
  double total = 0.0, sum = 0.0;
  for (const Weighted& entry : sorted) total += entry.second;
  for (const Weighted& entry : sorted) {
    sum += entry.second;
    if (sum >= share * total) return entry.first;
  }
  return 0.0;
}

/** \brief A leaf's curvature at its centre, of the kind a mode shows, 1 / radius or its square. */
double
curvatureAtCenter(const SLIMSurface& surface, std::size_t i, DisplayMode mode)
{
  const HeightJet jet = evaluateJet(surface.degree[i], surface.coefficientsOf(i), 0.0, 0.0);
  const double e = 1.0 + jet.hu * jet.hu, g = 1.0 + jet.hv * jet.hv, f = jet.hu * jet.hv;
  const double root = std::sqrt(e + g - 1.0);
  const double mean = -(g * jet.huu - 2.0 * f * jet.huv + e * jet.hvv) / (2.0 * root * root * root);
  const double gauss = (jet.huu * jet.hvv - jet.huv * jet.huv) / ((e + g - 1.0) * (e + g - 1.0));
  const double spread = std::sqrt(std::max(0.0, mean * mean - gauss));
  switch (mode) {
    case DisplayMode::kGauss: return gauss;
    case DisplayMode::kMax: return mean + spread;
    case DisplayMode::kMin: return mean - spread;
    default: return mean;
  }
}

double
valueOf(const SLIMSurface& surface, std::size_t i, DisplayMode mode)
{
  const double radius = surface.radius[i] * surface.info.scale;
  if (mode == DisplayMode::kSize) return radius;
  if (mode == DisplayMode::kLevel) return surface.level[i];
  if (mode == DisplayMode::kError) return surface.error[i] * surface.info.scale;
  const double unit = mode == DisplayMode::kGauss ? radius * radius : radius;
  return std::abs(curvatureAtCenter(surface, i, mode)) / unit;
}

/** \brief What is taken for rounding: a millionth of one over the surface's extent, or its square. */
double
leastShown(double scale, DisplayMode mode)
{
  constexpr double kShare = 1e-6;
  if (mode == DisplayMode::kError) return 0.0;
  return mode == DisplayMode::kGauss ? kShare * kShare / (scale * scale) : kShare / scale;
}

}  // namespace

std::array<double, 2>
surfaceRange(const SLIMSurface& surface, DisplayMode mode)
{
  std::vector<Weighted> values;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (!surface.isLeaf(i)) continue;
    // Leaves overlap alike, so a leaf stands for an area like its ball's cross-section.
    const double area = double{surface.radius[i]} * surface.radius[i];
    values.emplace_back(valueOf(surface, i, mode), area);
  }
  if (values.empty()) return {0.5, 1.0};
  std::sort(values.begin(), values.end());
  if (mode == DisplayMode::kLevel) return {values.front().first, values.back().first};
  if (mode == DisplayMode::kSize) return {quantile(values, 0.02), quantile(values, 0.98)};
  const double range = quantile(values, 0.95);
  // A flat surface has no curvature but by rounding, and that spans no colours: any range far above
  // it shows the surface grey.
  const double least = leastShown(surface.info.scale, mode);
  const double shown = range > least && std::isfinite(range) ? range : 1.0 / surface.info.scale;
  return {mode == DisplayMode::kError ? 0.0 : -shown, shown};
}

}  // namespace pcl_slim::detail
