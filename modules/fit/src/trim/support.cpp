// SPDX-License-Identifier: BSD-3-Clause
#include "trim/support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pcl_slim/surface/polynomial.h"

namespace pcl_slim::detail {

namespace {

/** Cells from a place's own on: its points are likely to be near enough. */
constexpr std::array<int, 3> kSteps{0, -1, 1};

}  // namespace

/** The spacing at which a disc about a point contains as many neighbours; in space, so that steep
 * parts of the surface count in full. */
double SupportTest::spacingAbout(const SheetPoints& points, std::size_t point) {
  std::array<double, kSupport.near_points> nearest;  // ascending
  nearest.fill(HUGE_VAL);
  for (std::size_t i = 0; i < points.count; ++i) {
    if (i == point) continue;
    const double du = points.u[i] - points.u[point], dv = points.v[i] - points.v[point],
                 dw = points.w[i] - points.w[point];
    double distance_sq = du * du + dv * dv + dw * dw;
    if (!(distance_sq < nearest.back())) continue;
    for (double& place : nearest)
      if (distance_sq < place) std::swap(distance_sq, place);
  }
  return std::sqrt(M_PI * nearest.back() / static_cast<double>(kSupport.near_points));
}

/** How many of 4 x 4 cells of the square about the disc have points of it. */
static int numFilledCells(const SheetPoints& points) {
  std::uint32_t cells = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const float u = points.u[i], v = points.v[i];
    if (u * u + v * v >= 1) continue;
    const auto cellOf = [](float x) { return std::min(3, static_cast<int>(2 * (x + 1))); };
    cells |= 1u << (4 * cellOf(v) + cellOf(u));
  }
  return __builtin_popcount(cells);
}

double SupportTest::spacingOf(SheetPoints& points) {
  const double by_sectors = detail::spacingOf(points);
  if (points.count <= kSupport.near_points || points.count >= kSupport.few_points)
    return by_sectors;
  // What fills less than a third of the disc is in about five cells; this saves time alone.
  if (numFilledCells(points) > kSupport.most_cells) return by_sectors;
  spacings_.clear();
  std::size_t inside = 0;
  const std::size_t step = std::max<std::size_t>(1, points.count / kSupport.looked_about);
  for (std::size_t i = 0; i < points.count; ++i) {
    if (points.u[i] * points.u[i] + points.v[i] * points.v[i] > 1) continue;
    if (inside++ % step == 0) spacings_.push_back(spacingAbout(points, i));
  }
  if (spacings_.empty()) return by_sectors;
  const auto middle = spacings_.begin() + static_cast<std::ptrdiff_t>(spacings_.size() / 2);
  std::nth_element(spacings_.begin(), middle, spacings_.end());
  const double area = static_cast<double>(inside) * *middle * *middle;
  return area < kSupport.filled * M_PI ? std::min(by_sectors, *middle) : by_sectors;
}

int SupportTest::cellAt(double coordinate) const {
  return std::clamp(static_cast<int>((coordinate + kTrim.known) / reach_), 0, side_ - 1);
}

/** Sorts points into cells as wide as their reach: a place's points are in its cell or next to it.
 */
void SupportTest::sortPoints(const SheetPoints& points, double reach) {
  reach_ = reach;
  side_ = static_cast<int>(2.0 * kTrim.known / reach) + 1;
  const auto cellOf = [&](std::size_t i) {
    return static_cast<std::size_t>(cellAt(points.v[i]) * side_ + cellAt(points.u[i]));
  };
  begin_.assign(static_cast<std::size_t>(side_ * side_) + 1, 0);
  for (std::size_t i = 0; i < points.count; ++i) ++begin_[cellOf(i) + 1];
  for (std::size_t k = 1; k < begin_.size(); ++k) begin_[k] += begin_[k - 1];
  next_.assign(begin_.begin(), begin_.end() - 1);
  sorted_.resize(points.count);
  for (std::size_t i = 0; i < points.count; ++i)
    sorted_[next_[cellOf(i)]++] = static_cast<std::uint32_t>(i);
}

bool SupportTest::isSupported(const SheetPoints& points, double u, double v, double w) const {
  const int column = cellAt(u), row = cellAt(v);
  const double reach_sq = reach_ * reach_;
  const auto isNear = [&](std::uint32_t i) {
    const double du = points.u[i] - u, dv = points.v[i] - v, dw = points.w[i] - w;
    return du * du + dv * dv + dw * dw < reach_sq;
  };
  for (const int dy : kSteps) {
    for (const int dx : kSteps) {
      const int x = column + dx, y = row + dy;
      if (x < 0 || y < 0 || x >= side_ || y >= side_) continue;
      const auto cell = static_cast<std::size_t>(y * side_ + x);
      if (std::any_of(sorted_.begin() + begin_[cell], sorted_.begin() + begin_[cell + 1], isNear))
        return true;
    }
  }
  return false;
}

bool SupportTest::standsOff(const SheetPoints& points, const SupportedSurface& surface) {
  const double reach = kSupport.opens * surface.spacing + kSupport.noises * surface.noise;
  if (reach >= 1) return false;
  sortPoints(points, reach);
  const int half = static_cast<int>(kSupport.looked_at / surface.spacing);
  const double most_sq = kSupport.looked_at * kSupport.looked_at;
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      const double u = surface.spacing * x, v = surface.spacing * y;
      if (u * u + v * v > most_sq) continue;
      const double w = evaluateHeight(surface.degree, surface.c, u, v);
      if (u * u + v * v + w * w <= most_sq && !isSupported(points, u, v, w)) return true;
    }
  }
  return false;
}

void SupportTest::cutMap(const SheetPoints& points, const SupportedSurface& surface, int side,
                         std::uint8_t* bits) {
  sortPoints(points, kSupport.kept * surface.spacing + kSupport.noises * surface.noise);
  constexpr double kFarthestSq = 1.1;  // a place in the ball blends nodes about it
  const double middle = 0.5 * (side - 1);
  for (int k = 0; k < side * side; ++k) {
    if ((bits[k >> 3] >> (k & 7) & 1) == 0) continue;
    const double u = k % side / middle - 1, v = k / side / middle - 1;
    const double w = evaluateHeight(surface.degree, surface.c, u, v);
    if (u * u + v * v + w * w > kFarthestSq || isSupported(points, u, v, w)) continue;
    bits[k >> 3] &= static_cast<std::uint8_t>(~(1 << (k & 7)));
  }
}

}  // namespace pcl_slim::detail
