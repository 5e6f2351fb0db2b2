// SPDX-License-Identifier: BSD-3-Clause
#include "borders/coverage.h"

#include <algorithm>
#include <cmath>

#include "borders/mesh_parts.h"

namespace pcl_slim::borders {

CoverageGrid::CoverageGrid(const Sheet& sheet) : sheet_(sheet), low_(sheet.low) {
  const double width = sheet.high[0] - sheet.low[0], height = sheet.high[1] - sheet.low[1];
  if (sheet.isBand()) {
    columns_ = static_cast<int>(std::ceil(width / (kStep * kCell))) * kStep;
    cell_u_ = width / columns_;
  } else {
    low_[0] -= kMargin;
    columns_ = static_cast<int>(std::ceil((width + 2.0 * kMargin) / kCell));
  }
  const double margin = sheet.whole ? 0.0 : kMargin;
  low_[1] -= margin;
  rows_ = static_cast<int>(std::ceil((height + 2.0 * margin) / kCell));
  label();
  clear();
}

Flat CoverageGrid::middle(int column, int row) const {
  return {low_[0] + (column + 0.5) * cell_u_, low_[1] + (row + 0.5) * kCell};
}

/** The cell's number; -1 outside. */
std::int64_t CoverageGrid::cellAt(int column, int row) const {
  if (sheet_.isBand()) {
    column %= columns_;
    if (column < 0) column += columns_;
  }
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return -1;
  return static_cast<std::int64_t>(row) * columns_ + column;
}

void CoverageGrid::clear() {
  covered_.assign(labels_.size(), 0);
}

void CoverageGrid::label() {
  labels_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kOutside);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (!sheet_.isInOutline(middle(column, row))) continue;
      labels_[static_cast<std::size_t>(cellAt(column, row))] = kSurface;
    }
  }
  for (std::size_t h = 0; h < sheet_.holes.size(); ++h) labelHole(static_cast<std::int32_t>(h + 1));
}

/** Small holes may be closed or open: their cells and those around them count neither way. */
void CoverageGrid::labelHole(std::int32_t number) {
  const Hole& hole = sheet_.holes[static_cast<std::size_t>(number - 1)];
  const bool kept = hole.size() >= kKeptHole;
  const double wider = kept ? 0.0 : 1.0;
  const auto column = [&](double u) { return static_cast<int>((u - low_[0]) / cell_u_); };
  const auto row = [&](double v) { return static_cast<int>((v - low_[1]) / kCell); };
  const Flat &c = hole.centre, &half = hole.half;
  const int left = hole.cap ? 0 : column(c[0] - half[0] - 2.0);
  const int right = hole.cap ? columns_ - 1 : column(c[0] + half[0] + 2.0);
  const int below = std::max(0, row(c[1] - half[1] * 1.1 - 2.0));
  const int above = std::min(rows_ - 1, row(c[1] + half[1] * 1.1 + 2.0));
  for (int j = below; j <= above; ++j) {
    for (int i = left; i <= right; ++i) {
      const std::int64_t cell = cellAt(i, j);
      if (cell < 0 || labels_[static_cast<std::size_t>(cell)] != kSurface) continue;
      if (!sheet_.isInHole(hole, middle(i, j), wider)) continue;
      labels_[static_cast<std::size_t>(cell)] = kept ? number : kAny;
    }
  }
}

bool CoverageGrid::cover(std::array<Flat, 3> corners) {
  const double period = sheet_.isBand() ? sheet_.chart->period() : 0.0;
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  const double first = corners[0][0];
  for (Flat& c : corners) {
    if (period > 0.0) c[0] = first + std::remainder(c[0] - first, period);
    c[0] = (c[0] - low_[0]) / cell_u_ - 0.5;
    c[1] = (c[1] - low_[1]) / kCell - 0.5;
    for (std::size_t a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], c[a]);
      high[a] = std::max(high[a], c[a]);
    }
  }
  if (high[1] < 0.0 || low[1] > rows_ - 1) return false;
  if (period == 0.0 && (high[0] < 0.0 || low[0] > columns_ - 1)) return false;
  for (int row = static_cast<int>(std::ceil(low[1])); row <= high[1]; ++row) {
    double from = 1e300, to = -1e300;
    for (std::size_t k = 0; k < 3; ++k) {
      const Flat &a = corners[k], &b = corners[(k + 1) % 3];
      if (std::min(a[1], b[1]) > row || std::max(a[1], b[1]) < row) continue;
      // A level edge is between the ends of the others.
      if (a[1] == b[1]) continue;
      const double x = a[0] + (row - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
      from = std::min(from, x);
      to = std::max(to, x);
    }
    for (int column = static_cast<int>(std::ceil(from)); column <= to; ++column) {
      const std::int64_t cell = cellAt(column, row);
      if (cell >= 0) covered_[static_cast<std::size_t>(cell)] = 1;
    }
  }
  return true;
}

void CoverageGrid::cover(const RayTracer& tracer, const OpenScene& scene, double reach) {
  std::vector<WorldRay> rays;
  std::vector<WorldHit> hits;
  for (int row = 0; row < rows_; row += kStep) {
    for (int column = 0; column < columns_; column += kStep) {
      const Flat at{low_[0] + (column + 0.5 * kStep) * cell_u_,
                    low_[1] + (row + 0.5 * kStep) * kCell};
      const Vector3 n = sheet_.chart->normal(at);
      WorldRay ray;
      ray.origin = scene.fromCharts(along(sheet_.chart->place(at), reach, n));
      ray.direction = scene.fromCharts(scaled(n, -1.0));
      ray.farthest = 2.0 * reach;
      rays.push_back(ray);
    }
  }
  if (tracer.cast(rays, VisibleSides::kBoth, hits, 1)) return;
  std::size_t next = 0;
  for (int row = 0; row < rows_; row += kStep) {
    for (int column = 0; column < columns_; column += kStep) {
      if (!hits[next++].met()) continue;
      for (int k = 0; k < kStep * kStep; ++k) {
        const std::int64_t cell = cellAt(column + k % kStep, row + k / kStep);
        if (cell >= 0) covered_[static_cast<std::size_t>(cell)] = 1;
      }
    }
  }
}

/** Cells are reached in rings about those that are covered, by turns over sides alone and over
 * corners, too: the distance is that of octagons. */
double CoverageGrid::deepestMissing() const {
  std::vector<std::uint8_t> seen = covered_;
  std::vector<std::int64_t> front, next;
  std::size_t left = 0;
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    if (covered_[i] != 0) front.push_back(static_cast<std::int64_t>(i));
    left += covered_[i] == 0 && labels_[i] == kSurface ? 1 : 0;
  }
  int rings = 0;
  for (; left > 0 && !front.empty(); ++rings) {
    next.clear();
    for (const std::int64_t cell : front) {
      const int column = static_cast<int>(cell % columns_), row = static_cast<int>(cell / columns_);
      for (int k = 0; k < 9; ++k) {
        const int x = k % 3 - 1, y = k / 3 - 1;
        if (rings % 2 == 0 && x != 0 && y != 0) continue;
        const std::int64_t beside = cellAt(column + x, row + y);
        if (beside < 0 || seen[static_cast<std::size_t>(beside)] != 0) continue;
        const std::int32_t label = labels_[static_cast<std::size_t>(beside)];
        if (label != kSurface && label != kAny) continue;
        seen[static_cast<std::size_t>(beside)] = 1;
        left -= label == kSurface ? 1 : 0;
        next.push_back(beside);
      }
    }
    front.swap(next);
  }
  return left > 0 ? static_cast<double>(columns_) * cell_u_ : rings * kCell;
}

void CoverageGrid::addTo(Coverage& sum) const {
  sum.deepest = std::max(sum.deepest, deepestMissing());
  std::vector<std::array<std::size_t, 2>> holes(sheet_.holes.size());  // cells, covered ones
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const auto cell = static_cast<std::size_t>(cellAt(column, row));
      const std::int32_t label = labels_[cell];
      const double area = kCell * cell_u_ * sheet_.chart->stretch(middle(column, row));
      if (label == kSurface) sum.truth += area;
      if (label == kSurface && covered_[cell] == 0) sum.missing += area;
      if (label != kSurface && label != kAny && covered_[cell] != 0) sum.beyond += area;
      if (label <= 0) continue;
      auto& hole = holes[static_cast<std::size_t>(label - 1)];
      ++hole[0];
      hole[1] += covered_[cell];
    }
  }
  for (const auto& [cells, covered] : holes) {
    sum.to_keep += cells > 0 ? 1 : 0;
    sum.kept += cells > 0 && 2 * covered <= cells ? 1 : 0;
  }
}

SceneCoverage::SceneCoverage(const OpenScene& scene) : scene_(scene) {
  for (const Sheet& sheet : scene.sheets) grids_.emplace_back(sheet);
}

Coverage SceneCoverage::sum() const {
  Coverage sum;
  for (const CoverageGrid& grid : grids_) grid.addTo(sum);
  return sum;
}

Coverage SceneCoverage::ofMesh(const TriangleMesh& mesh) {
  for (CoverageGrid& grid : grids_) grid.clear();
  double off = 0.0;
  forParts(mesh, kPart, [&](const std::array<Vector3, 3>& part) {
    std::array<Vector3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = scene_.toCharts(part[k]);
    const Vector3 middle = middleOf(corners);
    std::size_t sheet = 0;
    double height = 1e300;
    for (std::size_t s = 0; s < grids_.size(); ++s) {
      const double h = std::abs(scene_.sheets[s].chart->foot(middle).height);
      if (h >= height) continue;
      height = h;
      sheet = s;
    }
    bool inside = false;
    if (height <= reach()) {
      std::array<Flat, 3> flat;
      for (std::size_t k = 0; k < 3; ++k) {
        flat[k] = scene_.sheets[sheet].chart->foot(corners[k]).at;
      }
      inside = grids_[sheet].cover(flat);
    }
    if (!inside) off += areaOf(corners);
  });
  Coverage coverage = sum();
  coverage.beyond += off;
  return coverage;
}

Coverage SceneCoverage::ofPicture(const RayTracer& tracer) {
  for (CoverageGrid& grid : grids_) {
    grid.clear();
    grid.cover(tracer, scene_, reach());
  }
  return sum();
}

}  // namespace pcl_slim::borders
