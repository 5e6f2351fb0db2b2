// SPDX-License-Identifier: BSD-3-Clause
#include "octree/leaf_shapes.h"

#include <algorithm>
#include <cmath>

#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr double kWidest = 0.6;  ///< of r: no wider cells
constexpr double kPatch = 0.45;  ///< of r: radius about the centre where curvature is evaluated
constexpr int kSteps = 16;       ///< widths looked at from one to twice as much

/** Largest curvature on a leaf, 1/length. */
double
curvatureOf(const SLIMSurface& surface, std::uint32_t i)
{
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

/** Mean distance of the points behind a leaf: with weights (1 - s^2)^4 the effective number of points
 * is .36 of those in the ball. */
double
spacingOf(const SLIMSurface& surface, std::uint32_t i)
{
  const double points = std::max(1.0, surface.effective_count[i] / 0.36);
  return surface.radius[i] * std::sqrt(M_PI / points);
}

LeafShape
shapeOf(const SLIMSurface& surface, std::uint32_t i, double tolerance, double least_spacings)
{
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
  shape.least = static_cast<float>(std::min(least_spacings * spacingOf(surface, i), 0.5 * widest));
  return shape;
}

}  // namespace

SheetOffset
offsetFrom(const LeafShape& leaf, const Vector3& place)
{
  float local[3] = {0, 0, 0};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto d = static_cast<float>((place[a] - leaf.center[a]) / leaf.radius);
    local[0] += d * leaf.u[a];
    local[1] += d * leaf.v[a];
    local[2] += d * leaf.w[a];
  }
  const float reach = std::sqrt(local[0] * local[0] + local[1] * local[1]);
  const float shrink = reach > 1 ? 1 / reach : 1;
  SheetOffset made;
  made.u = shrink * local[0];
  made.v = shrink * local[1];
  const HeightJet jet = evaluateJet(leaf.degree, leaf.c, made.u, made.v);
  const double slope = std::sqrt(1 + jet.hu * jet.hu + jet.hv * jet.hv);
  made.distance = static_cast<float>((local[2] - jet.h) / slope * leaf.radius);
  for (std::size_t a = 0; a < 3; ++a) {
    made.normal[a] = (leaf.w[a] - jet.hu * leaf.u[a] - jet.hv * leaf.v[a]) / slope;
  }
  return made;
}

std::vector<LeafShape>
shapesOf(const SLIMSurface& surface, double tolerance, double least_spacings, int threads)
{
  const std::vector<std::uint32_t> leaves = surface.leaves();
  std::vector<LeafShape> shapes(leaves.size());
  parallelFor(leaves.size(), threads, 256, [&](std::size_t j, int) {
    shapes[j] = shapeOf(surface, leaves[j], tolerance, least_spacings);
  });
  return shapes;
}

double
thriftyCellSize(const std::vector<LeafShape>& shapes)
{
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

}  // namespace pcl_slim::detail
