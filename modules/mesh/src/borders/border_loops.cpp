// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "borders/borders.h"

namespace pcl_slim::detail {

namespace {

constexpr double kKernelShare = 0.36;    ///< effective points of (1 - s^2)^4 over those in the ball
constexpr float kBorder = 0.5f;          ///< of SurfaceVertices::outside
constexpr std::size_t kMostPlaces = 64;  ///< of a loop at which the spacing is evaluated
/// Cosine between what closes a loop and the mesh around it below which it folds: -1 at the end of
/// a flat sheet, 0 at that of a pipe, 1 at a hole.
constexpr double kFolds = -0.3;
/// Of a component's area: a loop as long as a circle around more goes around a sheet.
constexpr double kSheet = 0.2;

/** The mean density of the points along each loop, local units. */
std::vector<double> densitiesAlong(const ProbeField& field, const std::vector<Loop>& loops,
                                   const SurfaceVertices& vertices) {
  std::vector<std::uint32_t> places;
  std::vector<std::size_t> begin(1, 0);
  for (const Loop& loop : loops) {
    const std::size_t step = (loop.size() + kMostPlaces - 1) / kMostPlaces;
    for (std::size_t i = 0; i < loop.size(); i += step) places.push_back(loop[i]);
    begin.push_back(places.size());
  }
  const std::vector<double> densities = densitiesAt(field, places, vertices);
  std::vector<double> means(loops.size(), 0);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    double known = 0;
    for (std::size_t k = begin[i]; k < begin[i + 1]; ++k) {
      means[i] += densities[k];
      known += densities[k] > 0 ? 1 : 0;
    }
    if (known > 0) means[i] /= known;
  }
  return means;
}

/** A border loop seen from the side that closes it. */
struct LoopView {
  double length = 0;    ///< local units
  bool folds = false;   ///< what closes it faces away from the mesh around it
  bool is_end = false;  ///< a sheet ends there: it folds, and goes around much of its component
  double spacing = 0;   ///< of the points around, local units; 0: unknown
  std::vector<BorderPiece> border;

  LoopView(const Loop& loop, double density, const BorderRings& rings,
           const SurfaceVertices& vertices) {
    Vector3 area{}, around{};
    const Vector3& origin = vertices.position[loop[0]];
    const auto next = [&](std::size_t i) { return loop[(i + 1) % loop.size()]; };
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Vector3 p = subtract(vertices.position[loop[i]], origin);
      const Vector3 q = subtract(vertices.position[next(i)], origin);
      const double size = pcl_slim::length(subtract(q, p));
      area = along(area, 0.5, cross(p, q));
      around = along(around, size, rings.normalAt(loop[i]));
      length += size;
    }
    const double flat = pcl_slim::length(area);
    folds = dot(area, around) < kFolds * flat * length;
    if (!(flat > 0) || !(density > 0)) return;
    spacing = 1 / std::sqrt(density);
    const PlaneView view(origin, normalized(area));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      border.push_back(view.piece(vertices.position[loop[i]], vertices.position[next(i)]));
    }
  }

  /** The widest disc [spacings], as widestDisc() has it. */
  double width(double least, double most) const {
    return spacing > 0 ? widestDisc(border, least * spacing, most * spacing) / spacing : least;
  }
};

/** Views of all loops. O(loops' vertices), and O(T) where one of them folds. */
std::vector<LoopView> viewLoops(const ProbeField& field, const BorderRings& rings,
                                const std::vector<Triangle>& triangles,
                                const SurfaceVertices& vertices) {
  const std::vector<Loop>& loops = rings.loops();
  const std::vector<double> densities = densitiesAlong(field, loops, vertices);
  std::vector<LoopView> views;
  bool folds = false;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    views.emplace_back(loops[i], densities[i], rings, vertices);
    folds = folds || views.back().folds;
  }
  if (!folds) return views;
  std::size_t count = 0;
  const auto component = componentsOf(triangles, vertices.count(), count);
  std::vector<double> area(count, 0);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    area[component[t]] += areaOf(triangles[t], vertices);
  }
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const double circle = views[i].length * views[i].length / (4 * M_PI);
    const double own = area[component[rings.trianglesAt(loops[i][0])[0]]];
    views[i].is_end = views[i].folds && circle > kSheet * own;
  }
  return views;
}

}  // namespace

std::vector<double> densitiesAt(const ProbeField& field, const std::vector<std::uint32_t>& which,
                                const SurfaceVertices& vertices) {
  std::vector<double> densities(which.size());
  forProbeBlocks(field, which.size(), [&](SurfaceProbe& probe, std::size_t first, std::size_t n) {
    for (std::size_t i = first; i < first + n; ++i) {
      const ProbeScale scale =
          probe.scaleAt(vertices.position[which[i]], vertices.normal[which[i]]);
      const double ball = M_PI * scale.radius * scale.radius * scale.filled;
      densities[i] = ball > 0 ? scale.effective_count / (kKernelShare * ball) : 0;
    }
  });
  return densities;
}

double areaOf(const Triangle& triangle, const SurfaceVertices& vertices) {
  const Vector3& p = vertices.position[triangle[0]];
  return 0.5 * length(cross(subtract(vertices.position[triangle[1]], p),
                            subtract(vertices.position[triangle[2]], p)));
}

ClosedLoops closeLoops(const ProbeField& field, const LoopChoice& choice,
                       std::vector<Triangle>& triangles, SurfaceVertices& vertices) {
  ClosedLoops closed;
  if (!choice.all && !(choice.width > 0)) return closed;
  const BorderRings rings(triangles, vertices, field.threads);
  const std::vector<Loop>& loops = rings.loops();
  const std::vector<LoopView> views = viewLoops(field, rings, triangles, vertices);
  std::vector<std::uint8_t> closes(loops.size(), 0);
  parallelFor(loops.size(), field.threads, 8, [&](std::size_t i, int) {
    const bool inside =
        !choice.inside || std::all_of(loops[i].begin(), loops[i].end(), [&](std::uint32_t v) {
          return vertices.outside[v] <= kBorder;
        });
    if (!inside) return;
    const bool narrow = !views[i].is_end && views[i].width(0, choice.width) < choice.width;
    closes[i] = choice.all || narrow ? 1 : 0;
  });
  const auto first = static_cast<std::uint32_t>(vertices.count());
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (closes[i] == 0) continue;
    closed.area += fillLoop(loops[i], rings, triangles, vertices).area;
    ++closed.count;
  }
  if (!choice.project) return closed;
  std::vector<std::uint32_t> made;
  for (std::uint32_t v = first; v < vertices.count(); ++v) made.push_back(v);
  putOnSurface(field, made, vertices);
  return closed;
}

void countLoops(const ProbeField& field, double scale, const std::vector<Triangle>& triangles,
                const SurfaceVertices& vertices, MeshStatistics& statistics) {
  const BorderRings rings(triangles, vertices, field.threads);
  constexpr double kAny = std::numeric_limits<double>::infinity();
  double widest = 0;
  bool hole = false;
  for (const LoopView& view : viewLoops(field, rings, triangles, vertices)) {
    ++statistics.border_loops;
    statistics.longest_loop = std::max(statistics.longest_loop, scale * view.length);
    if (view.is_end) {
      ++statistics.sheet_ends;
    } else {
      widest = view.width(widest, kAny);
      hole = true;
    }
  }
  if (hole) statistics.widest_hole = widest + kGrowth;
}

}  // namespace pcl_slim::detail
