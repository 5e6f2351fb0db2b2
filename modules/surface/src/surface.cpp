// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface.h"

#include <algorithm>
#include <cmath>

#include "trim/trim_columns.h"

namespace pcl_slim {

using namespace detail;

std::size_t
SLIMSurface::numLeaves() const
{
  return static_cast<std::size_t>(
      std::count_if(flags.begin(), flags.end(), [](std::uint8_t f) { return f & kSurfelLeaf; }));
}

std::vector<std::uint32_t>
SLIMSurface::leaves() const
{
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = 0; i < size(); ++i) {
    if (isLeaf(i)) leaves.push_back(i);
  }
  return leaves;
}

std::size_t
SLIMSurface::numLevels() const
{
  std::array<bool, 256> seen{};
  for (const std::uint8_t k : level) seen[k] = true;
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
}

float
SLIMSurface::varianceWeight(std::size_t i) const
{
  constexpr double kNegligible = 1e-3;  // of r: residuals below it say nothing against a leaf
  const double r = radius[i], e = error[i];
  const double expected = std::max(0.0, info.lambda) * info.diagonal * info.diagonal +
                          kNegligible * kNegligible * r * r;
  return static_cast<float>(expected / (expected + e * e));
}

void
SLIMSurface::clear()
{
  resize(0);
  child_begin.clear();
  children.clear();
  roots.clear();
  root_ball = {};
}

void
SLIMSurface::resize(std::size_t count)
{
  for (auto* column : {&cx, &cy, &cz, &radius, &nx, &ny, &nz, &error, &effective_count}) {
    column->resize(count);
  }
  coefficients.resize(count * static_cast<std::size_t>(stride()));
  for (auto* column : {&degree, &level, &flags}) column->resize(count);
  dropTrimMaps();
}

void
SLIMSurface::flip(std::size_t i)
{
  nx[i] = -nx[i];
  ny[i] = -ny[i];
  nz[i] = -nz[i];
  flipCoefficients(degree[i], coefficients.data() + i * static_cast<std::size_t>(stride()));
  if (isOpen(i)) mirrorTrimMap(trim_maps.data() + trim_begin[i]);
}

Error
SLIMSurface::validate() const
{
  const std::size_t n = size();
  if (info.degree < 1 || info.degree > kMaxDegree) return badInput("surface degree is not 1..4");
  for (const auto* column : {&cy, &cz, &radius, &nx, &ny, &nz, &error, &effective_count}) {
    if (column->size() != n) return badInput("surface columns have different lengths");
  }
  if (degree.size() != n || level.size() != n || flags.size() != n ||
      coefficients.size() != n * static_cast<std::size_t>(stride())) {
    return badInput("surface columns have different lengths");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::string where = " of surfel " + std::to_string(i);
    if (degree[i] < 1 || degree[i] > info.degree)
      return badInput("degree" + where + " is out of range");
    if (!(radius[i] > 0.0f) || !std::isfinite(radius[i]))
      return badInput("radius" + where + " is not positive");
    const float length_sq = nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i];
    if (!(std::abs(length_sq - 1.0f) < 1e-3f))
      return badInput("normal" + where + " has not unit length");
    if (!std::isfinite(cx[i]) || !std::isfinite(cy[i]) || !std::isfinite(cz[i])) {
      return badInput("centre" + where + " is not finite");
    }
    const float* c = coefficientsOf(i);
    if (!std::all_of(c, c + stride(), [](float value) { return std::isfinite(value); })) {
      return badInput("a coefficient" + where + " is not finite");
    }
  }
  return checkTrimMaps(*this);
}

}  // namespace pcl_slim
