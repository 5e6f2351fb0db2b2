// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "fill/loop_fill.h"

namespace pcl_slim::detail {

namespace {

constexpr double kContinues = 0.5;  ///< cosine from which on what closes a loop continues the mesh

constexpr double kMostCotangent = 50;  ///< of slivers

/** The cotangent Laplacian of the vertices of a fill and of its loop. Nodes are the fill's
 * vertices, then those of the mesh around the loop. */
struct Laplacian {
  struct Arm {
    std::uint32_t to;
    double weight;
  };
  std::vector<std::vector<Arm>> of;
  std::vector<double> area;  ///< a third of the triangles about each
  std::vector<Vector3> positions;

  Laplacian(const Loop& loop, const BorderRings& rings, const std::vector<Triangle>& triangles,
            const SurfaceVertices& vertices, const LoopFill& fill)
      : of(fill.positions.size()), area(fill.positions.size(), 0), positions(fill.positions) {
    for (const Triangle& t : fill.triangles) add(t);
    std::unordered_map<std::uint32_t, std::uint32_t> nodes;
    std::vector<std::uint32_t> around;
    for (std::uint32_t i = 0; i < loop.size(); ++i) {
      nodes[loop[i]] = i;
      const IndexRow row = rings.trianglesAt(loop[i]);
      around.insert(around.end(), row.begin(), row.end());
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    for (const std::uint32_t t : around) {
      Triangle own;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = triangles[t][k];
        const auto [at, fresh] = nodes.emplace(v, static_cast<std::uint32_t>(positions.size()));
        if (fresh) positions.push_back(vertices.position[v]);
        own[k] = at->second;
      }
      add(own);
    }
  }

 private:
  void add(const Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      const Vector3 ca = subtract(positions[a], positions[c]);
      const Vector3 cb = subtract(positions[b], positions[c]);
      const double size = length(cross(ca, cb));
      const double most = kMostCotangent * size;
      const double half = size > 0 ? 0.5 * std::clamp(dot(ca, cb), -most, most) / size : 0;
      if (a < of.size()) {
        of[a].push_back({b, half});
        area[a] += size / 6;
      }
      if (b < of.size()) of[b].push_back({a, half});
    }
  }
};

/** Whether the triangles that close a loop face the way the mesh around it does. */
bool continuesMesh(const Loop& loop, const BorderRings& rings, const LoopFill& fill) {
  Vector3 area{}, around{};
  for (const Triangle& t : fill.triangles) area = along(area, 1, fill.areaOf(t));
  for (const std::uint32_t v : loop) around = along(around, 1, rings.normalAt(v));
  return dot(area, around) > kContinues * length(area) * static_cast<double>(loop.size());
}

}  // namespace

void fairFill(const Loop& loop, const BorderRings& rings, const std::vector<Triangle>& triangles,
              const SurfaceVertices& vertices, LoopFill& fill) {
  const std::size_t n = loop.size(), unknown = fill.positions.size() - n;
  if (unknown == 0) return;
  const Laplacian laplacian(loop, rings, triangles, vertices, fill);
  // Least squares of the Laplacian over some vertices, each by its area: over the new ones alone
  // that is a membrane, with the loop's a plate.
  const std::size_t first = continuesMesh(loop, rings, fill) ? 0 : n;
  const auto rows = static_cast<Eigen::Index>(fill.positions.size() - first);
  const auto columns = static_cast<Eigen::Index>(unknown);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d known = Eigen::MatrixX3d::Zero(rows, 3);
  for (std::size_t i = first; i < fill.positions.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i - first);
    const double share = laplacian.area[i] > 0 ? 1 / std::sqrt(laplacian.area[i]) : 0;
    const auto add = [&](std::uint32_t node, double weight) {
      if (node >= n && node < fill.positions.size()) {
        entries.emplace_back(row, static_cast<Eigen::Index>(node - n), weight);
        return;
      }
      for (Eigen::Index a = 0; a < 3; ++a) {
        known(row, a) -= weight * laplacian.positions[node][static_cast<std::size_t>(a)];
      }
    };
    for (const Laplacian::Arm& arm : laplacian.of[i]) {
      add(arm.to, share * arm.weight);
      add(static_cast<std::uint32_t>(i), -share * arm.weight);
    }
  }
  Eigen::SparseMatrix<double> a(rows, columns);
  a.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> normal = a.transpose() * a;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  if (solver.info() != Eigen::Success) return;
  const Eigen::MatrixX3d solved = solver.solve(a.transpose() * known);
  if (!solved.allFinite()) return;
  for (std::size_t i = 0; i < unknown; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    fill.positions[n + i] = {solved(row, 0), solved(row, 1), solved(row, 2)};
  }
}

}  // namespace pcl_slim::detail
