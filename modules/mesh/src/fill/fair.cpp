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

/** The neighbours of the vertices of a fill and of its loop, with weights. Nodes are the fill's
 * vertices, then those of the mesh around the loop. */
struct Stencils {
  struct Arm {
    std::uint32_t to;
    double weight;
  };
  std::vector<std::vector<Arm>> of;
  std::vector<Vector3> positions;

  Stencils(const Loop& loop, const BorderRings& rings, const SurfaceVertices& vertices,
           const LoopFill& fill)
      : of(fill.positions.size()), positions(fill.positions) {
    for (const Triangle& t : fill.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        of[t[k]].push_back({t[(k + 1) % 3], 0});
        of[t[k]].push_back({t[(k + 2) % 3], 0});
      }
    }
    std::unordered_map<std::uint32_t, std::uint32_t> nodes;
    for (std::uint32_t i = 0; i < loop.size(); ++i) nodes[loop[i]] = i;
    for (std::uint32_t i = 0; i < loop.size(); ++i) {
      for (const std::uint32_t v : rings.neighbours(loop[i])) {
        const auto [at, fresh] = nodes.emplace(v, static_cast<std::uint32_t>(positions.size()));
        if (fresh) positions.push_back(vertices.position[v]);
        of[i].push_back({at->second, 0});
      }
    }
    for (std::uint32_t i = 0; i < of.size(); ++i) finish(i);
  }

 private:
  /** Each neighbour once, weighed by the inverse of its distance; weights add up to 1. */
  void finish(std::uint32_t i) {
    std::vector<Arm>& arms = of[i];
    std::sort(arms.begin(), arms.end(), [](const Arm& a, const Arm& b) { return a.to < b.to; });
    arms.erase(std::unique(arms.begin(), arms.end(),
                           [](const Arm& a, const Arm& b) { return a.to == b.to; }),
               arms.end());
    double longest = 0, sum = 0;
    for (Arm& arm : arms) {
      arm.weight = length(subtract(positions[arm.to], positions[i]));
      longest = std::max(longest, arm.weight);
    }
    for (Arm& arm : arms) sum += arm.weight = 1 / std::max(arm.weight, 1e-3 * longest + 1e-30);
    for (Arm& arm : arms) arm.weight /= sum;
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

void fairFill(const Loop& loop, const BorderRings& rings, const SurfaceVertices& vertices,
              LoopFill& fill) {
  const std::size_t n = loop.size(), unknown = fill.positions.size() - n;
  if (unknown == 0) return;
  const Stencils stencils(loop, rings, vertices, fill);
  // Least squares: the sum over some vertices of the squared distance from the mean of the
  // neighbours. Over the new vertices alone that is a membrane, with the loop's a plate.
  const std::size_t first = continuesMesh(loop, rings, fill) ? 0 : n;
  const auto rows = static_cast<Eigen::Index>(fill.positions.size() - first);
  const auto columns = static_cast<Eigen::Index>(unknown);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d known = Eigen::MatrixX3d::Zero(rows, 3);
  for (std::size_t i = first; i < fill.positions.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i - first);
    const auto add = [&](std::uint32_t node, double weight) {
      if (node >= n && node < fill.positions.size()) {
        entries.emplace_back(row, static_cast<Eigen::Index>(node - n), weight);
        return;
      }
      for (Eigen::Index a = 0; a < 3; ++a) {
        known(row, a) -= weight * stencils.positions[node][static_cast<std::size_t>(a)];
      }
    };
    add(static_cast<std::uint32_t>(i), -1);
    for (const Stencils::Arm& arm : stencils.of[i]) add(arm.to, arm.weight);
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
