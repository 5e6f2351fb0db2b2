// SPDX-License-Identifier: BSD-3-Clause
#include "denoise/mesh_scan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <queue>
#include <random>

#include "mesh/bench_mesh.h"
#include "rivals/point_tree.h"

namespace pcl_slim::denoise {

namespace {

using comparison::MeshSurface;
using rivals::PointTree;

constexpr std::size_t kOversampling = 5;
constexpr double kUnit = 1e4;  ///< of errors as they are printed

/** Splits faces into triangles. */
std::vector<MeshSurface::Triangle> trianglesOf(const MeshFaces& faces) {
  std::vector<MeshSurface::Triangle> triangles;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const IndexRow corners = faces[f];
    for (std::size_t k = 2; k < corners.size(); ++k) {
      triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  return triangles;
}

/** Draws uniform points of the triangles, with normals; sets the area. */
void drawUniformly(std::size_t count, std::mt19937_64& rng, MeshScan& scan) {
  std::vector<double> areas;
  Points normals;
  for (const auto& t : scan.triangles) {
    const Vector3& a = scan.vertices[t[0]];
    const Vector3 n = cross(subtract(scan.vertices[t[1]], a), subtract(scan.vertices[t[2]], a));
    areas.push_back(length(n) / 2);
    normals.push_back(normalized(n));
  }
  scan.area = std::accumulate(areas.begin(), areas.end(), 0.0);
  std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t t = triangle(rng);
    const double root = std::sqrt(unit(rng)), v = root * (1 - unit(rng)), w = root - v;
    const Vector3 &a = scan.vertices[scan.triangles[t][0]],
                  &b = scan.vertices[scan.triangles[t][1]],
                  &c = scan.vertices[scan.triangles[t][2]];
    scan.points.push_back(along(along(a, v, subtract(b, a)), w, subtract(c, a)));
    scan.normals.push_back(normals[t]);
  }
}

/** The points that weighted sample elimination keeps, ascending. */
std::vector<std::size_t> eliminated(const MeshScan& scan, std::size_t keep) {
  constexpr double kAlpha = 8, kBeta = 0.65, kGamma = 1.5;
  const std::size_t count = scan.points.size();
  const double share = static_cast<double>(keep) / static_cast<double>(count);
  const double widest = 2 * std::sqrt(scan.area / (2 * std::sqrt(3.0) * static_cast<double>(keep)));
  const double least = widest * kBeta * (1 - std::pow(share, kGamma));
  const PointTree tree(scan.points);
  const auto weightOf = [&](std::size_t i, std::size_t j) {
    const double d = length(subtract(scan.points[i], scan.points[j]));
    return d < widest ? std::pow(1 - std::max(d, least) / widest, kAlpha) : 0.0;
  };
  std::vector<double> weight(count, 0);
  std::priority_queue<std::pair<double, std::size_t>> heaviest;
  for (std::size_t i = 0; i < count; ++i) {
    for (const std::size_t j : tree.within(scan.points[i], widest)) {
      if (j != i) weight[i] += weightOf(i, j);
    }
    heaviest.emplace(weight[i], i);
  }
  std::vector<char> kept(count, 1);
  for (std::size_t left = count; left > keep;) {
    const auto [w, i] = heaviest.top();
    heaviest.pop();
    if (!kept[i] || w != weight[i]) continue;  // an entry from before its weight fell
    kept[i] = 0;
    --left;
    for (const std::size_t j : tree.within(scan.points[i], widest)) {
      if (!kept[j]) continue;
      weight[j] -= weightOf(i, j);
      heaviest.emplace(weight[j], j);
    }
  }
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < count; ++i) {
    if (kept[i]) indices.push_back(i);
  }
  return indices;
}

void scaleToUnitSphere(MeshScan& scan) {
  Vector3 low = scan.points.front(), high = low;
  for (const Vector3& p : scan.points) {
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
  }
  const Vector3 middle = scaled(along(low, 1, high), 0.5);
  double reach = 0;
  for (const Vector3& p : scan.points) reach = std::max(reach, length(subtract(p, middle)));
  for (Points* points : {&scan.points, &scan.vertices}) {
    for (Vector3& p : *points) p = scaled(subtract(p, middle), 1 / reach);
  }
  scan.area /= reach * reach;
}

/** Mean squared distance from points to the nearest of others. */
double meanToNearest(const Points& from, const Points& to, const PointTree& tree) {
  double sum = 0;
  for (const Vector3& p : from) {
    const Vector3 off = subtract(p, to[tree.nearest(p, 1).front()]);
    sum += dot(off, off);
  }
  return sum / static_cast<double>(from.size());
}

/** Mean over triangles of the squared distance to their nearest point. */
double meanFromTriangles(const MeshScan& scan, const Points& points, const PointTree& tree) {
  double sum = 0;
  for (const auto& t : scan.triangles) {
    const Points corners = {scan.vertices[t[0]], scan.vertices[t[1]], scan.vertices[t[2]]};
    const MeshSurface triangle(corners, {{0, 1, 2}});
    const Vector3 middle = scaled(along(along(corners[0], 1, corners[1]), 1, corners[2]), 1 / 3.0);
    double reach = 0;
    for (const Vector3& c : corners) reach = std::max(reach, length(subtract(c, middle)));
    double best = triangle.nearest(points[tree.nearest(middle, 1).front()]).distance;
    for (const std::size_t i : tree.within(middle, best + reach)) {
      best = std::min(best, triangle.nearest(points[i]).distance);
    }
    sum += best * best;
  }
  return sum / static_cast<double>(scan.triangles.size());
}

}  // namespace

Result<MeshScan> loadMeshScan(const std::string& path, std::size_t points, std::uint64_t seed) {
  auto mesh = mesh_bench::loadMesh(path);
  if (!mesh) return mesh.error();
  MeshScan dense;
  dense.name = std::filesystem::path(path).stem().string();
  dense.triangles = trianglesOf(mesh->faces);
  dense.vertices = std::move(mesh->vertices);
  std::mt19937_64 rng(seed);
  drawUniformly(kOversampling * points, rng, dense);
  MeshScan scan = dense;
  scan.points.clear();
  scan.normals.clear();
  for (const std::size_t i : eliminated(dense, points)) {
    scan.points.push_back(dense.points[i]);
    scan.normals.push_back(dense.normals[i]);
  }
  scaleToUnitSphere(scan);
  return scan;
}

Points noisy(const Points& points, double sigma, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss(0, sigma);
  Points result = points;
  for (Vector3& p : result) {
    for (double& x : p) x += gauss(rng);
  }
  return result;
}

Errors errorsOf(const MeshScan& scan, const Points& points) {
  Points moved;
  for (const Vector3& p : points) {
    if (std::isfinite(p[0] + p[1] + p[2])) moved.push_back(p);
  }
  const PointTree clean(scan.points), tree(moved);
  const MeshSurface mesh(scan.vertices, scan.triangles);
  double to_mesh = 0;
  for (const Vector3& p : moved) to_mesh += std::pow(mesh.nearest(p).distance, 2);
  Errors errors;
  errors.chamfer =
      kUnit * (meanToNearest(moved, scan.points, clean) + meanToNearest(scan.points, moved, tree));
  errors.sides[0] = kUnit * to_mesh / static_cast<double>(moved.size());
  errors.sides[1] = kUnit * meanFromTriangles(scan, moved, tree);
  errors.mesh = errors.sides[0] + errors.sides[1];
  return errors;
}

}  // namespace pcl_slim::denoise
