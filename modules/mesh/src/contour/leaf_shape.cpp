// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "contour/contour.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/query/leaf_noise.h"

namespace pcl_slim::detail {

namespace {

constexpr double kWidest = 0.6;  ///< of r: no wider cells
constexpr double kPatch = 0.45;  ///< of r: radius about the centre where curvature is evaluated
constexpr int kSteps = 16;       ///< widths looked at from one to twice as much
/// Of the distance of a trim map's nodes, about the points' spacing: cells at a border are no wider.
constexpr double kBorderCell = 2;
constexpr double kGrading = 0.5;   ///< of a cell's width: nearer borders divide it, too
constexpr double kMapReach = 0.9;  ///< of r: farther out other leaves know the border better

/** Largest curvature on a leaf, 1/length. */
double curvatureOf(const SLIMSurface& surface, std::uint32_t i) {
  double most = 0;
  for (int a = -1; a <= 1; ++a) {
    for (int b = -1; b <= 1; ++b) {
      const HeightJet jet =
          evaluateJet(surface.degree[i], surface.coefficientsOf(i), kPatch * a, kPatch * b);
      const double hessian =
          std::sqrt(jet.huu * jet.huu + 2 * jet.huv * jet.huv + jet.hvv * jet.hvv);
      most = std::max(most, hessian / std::sqrt(1 + jet.hu * jet.hu + jet.hv * jet.hv));
    }
  }
  return most / surface.radius[i];
}

LeafShape shapeOf(const SLIMSurface& surface, std::uint32_t i, double tolerance,
                  double least_spacings, bool trim) {
  LeafShape shape{};
  const LocalFrame frame({surface.nx[i], surface.ny[i], surface.nz[i]});
  shape.center = {surface.cx[i], surface.cy[i], surface.cz[i]};
  for (std::size_t a = 0; a < 3; ++a) {
    shape.u[a] = static_cast<float>(frame.u[a]);
    shape.v[a] = static_cast<float>(frame.v[a]);
    shape.w[a] = static_cast<float>(frame.w[a]);
  }
  shape.radius = surface.radius[i];
  shape.degree = surface.degree[i];
  shape.c = surface.coefficientsOf(i);
  const double curvature = std::max(curvatureOf(surface, i), 1e-6);
  const double widest = kWidest * shape.radius;
  shape.cell_size = static_cast<float>(std::min(std::sqrt(4 * tolerance / curvature), widest));
  shape.least =
      static_cast<float>(std::min(least_spacings * leafSpacing(surface, i), 0.5 * widest));
  const TrimMap map = trim ? surface.trimMap(i) : TrimMap();
  if (!map.closed()) {
    shape.borders = BorderTable(map);
    shape.border_size = static_cast<float>(kBorderCell * 2 * shape.radius / (map.side - 1));
  }
  return shape;
}

}  // namespace

std::vector<LeafShape> shapesOf(const SLIMSurface& surface, double tolerance, double least_spacings,
                                bool trim, int threads) {
  const std::vector<std::uint32_t> leaves = surface.leaves();
  std::vector<LeafShape> shapes(leaves.size());
  parallelFor(leaves.size(), threads, 256, [&](std::size_t j, int) {
    shapes[j] = shapeOf(surface, leaves[j], tolerance, least_spacings, trim);
  });
  return shapes;
}

double thriftyCellSize(const std::vector<LeafShape>& shapes) {
  std::vector<float> sizes;
  for (const LeafShape& shape : shapes) sizes.push_back(std::max(shape.cell_size, shape.least));
  const double middle = median(std::move(sizes));
  double best = middle, fewest = 1e300;
  for (int step = 0; step < kSteps; ++step) {
    const double size = middle * std::exp2(static_cast<double>(step) / kSteps);
    double cells = 0;
    for (const LeafShape& shape : shapes) {
      // Leaves overlap about alike everywhere: each has an area like r^2.
      const double wanted = std::max(shape.cell_size, shape.least);
      const double levels = std::ceil(std::log2(size / wanted) - 1e-3);
      const double share = shape.radius / (size * std::exp2(-levels));
      cells += share * share;
    }
    if (cells >= fewest) continue;
    fewest = cells;
    best = size;
  }
  return best;
}

BorderTable::BorderTable(const TrimMap& map) : side_(map.side) {
  const auto width = static_cast<std::size_t>(side_) + 1;
  counts_.assign(width * width, 0);
  const double centre = 0.5 * (side_ - 1), most = kMapReach * centre;
  const auto isIn = [&](int column, int row) {
    return std::hypot(column - centre, row - centre) <= most;
  };
  for (int row = 0; row < side_; ++row) {
    unsigned int in_row = 0;
    for (int column = 0; column < side_; ++column) {
      const bool own = map.at(column, row);
      if (isIn(column, row) && ((isIn(column + 1, row) && map.at(column + 1, row) != own) ||
                                (isIn(column, row + 1) && map.at(column, row + 1) != own))) {
        ++in_row;
      }
      const std::size_t at =
          (static_cast<std::size_t>(row) + 1) * width + 1 + static_cast<std::size_t>(column);
      counts_[at] = static_cast<std::uint16_t>(counts_[at - width] + in_row);
    }
  }
}

bool BorderTable::any(const double (&at)[2], const double (&reach)[2]) const {
  std::size_t begin[2], end[2];
  const double middle = 0.5 * (side_ - 1);
  for (std::size_t a = 0; a < 2; ++a) {
    const double low = std::ceil(middle * (1 + at[a] - reach[a]));
    const double high = std::floor(middle * (1 + at[a] + reach[a])) + 1;
    begin[a] = static_cast<std::size_t>(std::clamp(low, 0.0, static_cast<double>(side_)));
    end[a] = static_cast<std::size_t>(std::clamp(high, 0.0, static_cast<double>(side_)));
    if (begin[a] >= end[a]) return false;
  }
  const auto below = [&](std::size_t column, std::size_t row) {
    return counts_[row * (static_cast<std::size_t>(side_) + 1) + column];
  };
  return below(end[0], end[1]) - below(begin[0], end[1]) - below(end[0], begin[1]) +
             below(begin[0], begin[1]) >
         0;
}

bool isNearBorder(const LeafShape& leaf, const Vector3& middle, double size) {
  const double half = 0.5 * size / leaf.radius, more = kGrading * size / leaf.radius;
  double at[2] = {0, 0}, reach[2] = {more, more};
  for (std::size_t a = 0; a < 3; ++a) {
    const double d = (middle[a] - leaf.center[a]) / leaf.radius;
    at[0] += d * leaf.u[a];
    at[1] += d * leaf.v[a];
    reach[0] += half * std::abs(leaf.u[a]);
    reach[1] += half * std::abs(leaf.v[a]);
  }
  return leaf.borders.any(at, reach);
}

}  // namespace pcl_slim::detail
