// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/surface/surface.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/surface/surfel_color.h"
#include "trim/trim_columns.h"

namespace pcl_slim {

using namespace detail;

namespace {

// Local lengths are shares of a box of about 1. Within these bounds squares, and products of four
// coefficients, are normal floats, and centres in cells of the least radius fit into 64 bits.
constexpr float kMostLength = 0x1p20f;       ///< of a coordinate or a radius, local units
constexpr float kLeastRadius = 0x1p-40f;     ///< local units
constexpr float kMostCoefficient = 0x1p30f;  ///< of a polynomial in the unit ball
constexpr double kMostWorldLength =
    0x1p1000;                              ///< of origin and scale: world coordinates are finite
constexpr double kLeastScale = 0x1p-1000;  ///< its inverse is finite

/** Whether a value is in [low, high], which no NaN does. */
template <typename T>
bool
within(T value, T low, T high)
{
  return value >= low && value <= high;
}

Error
checkInfo(const SurfaceInfo& info)
{
  if (info.degree < 1 || info.degree > kMaxDegree) return badInput("surface degree is not 1..4");
  for (const double o : info.origin) {
    if (!within(o, -kMostWorldLength, kMostWorldLength))
      return badInput("the surface's origin is not finite or too far away; fit it again");
  }
  if (!within(info.scale, kLeastScale, kMostWorldLength))
    return badInput("the surface's scale is not a usable positive number; fit it again");
  if (!within(info.diagonal, 0.0, double{kMostLength}) || !within(info.lambda, 0.0, 0x1p40))
    return badInput("the surface's diagonal or noise variance is out of range; fit it again");
  if (!within(info.penalty, 0.0, 0x1p100) || !within(info.t_mdl, 0.0, 0x1p100))
    return badInput("the surface's penalty or T_MDL is negative or not finite; fit it again");
  const auto isShare = [](double value) { return value > 0.0 && value <= 1.0; };
  if (!isShare(info.cover_radius) || !isShare(info.cover_threshold))
    return badInput("the surface's cover radius or threshold is not within 0 to 1; fit it again");
  return {};
}

/** Checks the numbers of one surfel. */
Error
checkSurfel(const SLIMSurface& s, std::size_t i)
{
  const auto bad = [i](const std::string& what, const char* how) {
    return badInput(what + " of surfel " + std::to_string(i) + how);
  };
  if (s.degree[i] < 1 || s.degree[i] > s.info.degree) return bad("degree", " is out of range");
  if (!(s.radius[i] > 0.0f)) return bad("radius", " is not positive");
  if (!within(s.radius[i], kLeastRadius, kMostLength))
    return bad("radius", " is out of proportion to the surface");
  const float length_sq = s.nx[i] * s.nx[i] + s.ny[i] * s.ny[i] + s.nz[i] * s.nz[i];
  if (!(std::abs(length_sq - 1.0f) < 1e-3f)) return bad("normal", " has not unit length");
  for (const float c : {s.cx[i], s.cy[i], s.cz[i]}) {
    if (!std::isfinite(c)) return bad("centre", " is not finite");
    if (!within(c, -kMostLength, kMostLength))
      return bad("centre", " is out of proportion to the surface");
  }
  const float* c = s.coefficientsOf(i);
  for (int k = 0; k < s.stride(); ++k) {
    if (!std::isfinite(c[k])) return bad("a coefficient", " is not finite");
    if (!within(c[k], -kMostCoefficient, kMostCoefficient))
      return bad("a coefficient", " is too large for a polynomial in a unit ball");
  }
  const bool measured = within(s.error[i], 0.0f, kMostLength) && s.effective_count[i] >= 0.0f &&
                        std::isfinite(s.effective_count[i]);
  return measured ? Error() : bad("error or confidence", " is negative or not finite");
}

}  // namespace

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
  constexpr double kNegligible = 1e-3;  // of r: smaller residuals are no defect of a leaf
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
  colors.clear();
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
  if (hasColors()) flipColor(colors.data() + i * kColorBytes);
}

Error
SLIMSurface::validate() const
{
  const std::size_t n = size();
  if (Error defect = checkInfo(info)) return defect;
  for (const auto* column : {&cy, &cz, &radius, &nx, &ny, &nz, &error, &effective_count}) {
    if (column->size() != n) return badInput("surface columns have different lengths");
  }
  if (degree.size() != n || level.size() != n || flags.size() != n ||
      coefficients.size() != n * static_cast<std::size_t>(stride()) ||
      (hasColors() && colors.size() != n * kColorBytes)) {
    return badInput("surface columns have different lengths");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (Error defect = checkSurfel(*this, i)) return defect;
  }
  return checkTrimMaps(*this);
}

}  // namespace pcl_slim
