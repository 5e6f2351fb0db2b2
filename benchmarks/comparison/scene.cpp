// SPDX-License-Identifier: BSD-3-Clause

#include "comparison/scene.h"

#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <utility>

#include "comparison/mesh_surface.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/vector3.h"
#include "scan/cloud_file.h"

namespace pcl_slim::comparison {

namespace {

using Point = std::array<double, 3>;
constexpr double kCubeHalf = 1.0;

/** A scene whose clean points are the cube's, spread evenly, as measure::makeScene does for others.
 */
measure::Scene makeCube(std::size_t count, double noise, std::uint64_t seed, double normal_noise) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> side(-kCubeHalf, kCubeHalf);
  std::uniform_int_distribution<int> face(0, 5);
  std::normal_distribution<double> gauss;
  measure::Scene scene;
  scene.diagonal = 2 * kCubeHalf * std::sqrt(3.0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<std::size_t>(face(rng));
    Point p = {side(rng), side(rng), side(rng)}, n{};
    const double sign = f % 2 == 0 ? 1 : -1;
    p[f / 2] = sign * kCubeHalf;
    n[f / 2] = sign;
    double length = 0;
    for (double& value : n) {
      value += normal_noise * gauss(rng);
      length += value * value;
    }
    for (const double value : n) {
      scene.normals.push_back(static_cast<float>(value / std::sqrt(length)));
    }
    scene.points.insert(scene.points.end(), p.begin(), p.end());
  }
  for (double& value : scene.points) value += noise * scene.diagonal * gauss(rng);
  return scene;
}

/** Distance to the cube's surface, and the normal of the face nearest to a point. */
measure::Truth cubeTruth(const Point& p) {
  double outside = 0, inside = -kCubeHalf;
  std::size_t axis = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double beyond = std::abs(p[a]) - kCubeHalf;
    outside += std::pow(std::max(0.0, beyond), 2);
    inside = std::max(inside, beyond);
    if (std::abs(p[a]) > std::abs(p[axis])) axis = a;
  }
  measure::Truth truth;
  truth.distance = inside > 0 ? std::sqrt(outside) : inside;
  truth.normal[axis] = p[axis] < 0 ? -1 : 1;
  return truth;
}

}  // namespace

pcl::PointCloud<pcl::PointXYZ>::Ptr toCloud(const std::vector<double>& xyz) {
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(xyz.size() / 3);
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    cloud->push_back(pcl::PointXYZ(static_cast<float>(xyz[i]), static_cast<float>(xyz[i + 1]),
                                   static_cast<float>(xyz[i + 2])));
  }
  return cloud;
}

double spacingOf(const pcl::PointCloud<pcl::PointXYZ>::Ptr& clean) {
  constexpr int kNeighbours = 10;
  const std::size_t stride = std::max<std::size_t>(1, clean->size() / 2000);
  pcl::search::KdTree<pcl::PointXYZ> tree;
  tree.setInputCloud(clean);
  pcl::Indices found;
  std::vector<float> squared, tenth;
  for (std::size_t i = 0; i < clean->size(); i += stride) {
    if (tree.nearestKSearch((*clean)[i], kNeighbours + 1, found, squared) <= kNeighbours) continue;
    tenth.push_back(squared.back());
  }
  if (tenth.empty()) return 0;
  return std::sqrt(median(std::move(tenth)) * M_PI / kNeighbours);
}

const std::vector<std::string>& shapeNames() {
  static const std::vector<std::string> names = {"sphere", "torus", "bumpy", "relief", "cube"};
  return names;
}

Result<Scene> makeScene(const std::string& shape, std::size_t count, double noise,
                        std::uint64_t seed, double normal_noise) {
  measure::Shape kind = measure::Shape::kSphere;
  const bool cube = shape == "cube";
  if (!cube && !measure::parseShape(shape, kind)) {
    return Error{ErrorCode::kBadArgument,
                 "unknown shape '" + shape + "'; give sphere, torus, bumpy, relief or cube"};
  }
  const auto make = [&](double sigma) {
    return cube ? makeCube(count, sigma, seed, normal_noise)
                : measure::makeScene(kind, count, sigma, normal_noise, seed);
  };
  measure::Scene made = make(noise);
  Scene scene;
  scene.name = shape;
  scene.noise = noise;
  scene.points = toCloud(made.points);
  scene.normals = std::move(made.normals);
  scene.spacing = spacingOf(toCloud(make(0).points));
  scene.has_true_curvature = !cube;
  if (cube) {
    scene.truth = [](std::size_t, const Point& p) { return cubeTruth(p); };
  } else {
    scene.truth = [kind](std::size_t, const Point& p) { return measure::truthAt(kind, p); };
  }
  return scene;
}

// Scenes from files: a scan whose truth is known point by point, or as the surface of a mesh.

namespace {

/** Mean edge length of a mesh; 0 without faces. */
double meanEdge(const CloudFile& mesh) {
  const PointFile& file = mesh.file;
  const CloudView view = mesh.view(false);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    const std::uint32_t begin = file.face_begin[f], end = file.face_begin[f + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      const Point a = view.position(file.face_vertices[k]);
      const Point b = view.position(file.face_vertices[k + 1 < end ? k + 1 : begin]);
      const double length = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
      if (!std::isfinite(length)) continue;
      sum += length;
      ++count;
    }
  }
  return count ? sum / static_cast<double>(count) : 0;
}

/** Positions and normals of a truth given point by point, relative to an origin. */
struct PairTruth {
  std::vector<double> points;
  std::vector<std::array<float, 3>> normals;
};

measure::Truth pairTruth(const PairTruth& pair, std::size_t i, const Point& p) {
  measure::Truth truth;
  for (std::size_t a = 0; a < 3; ++a) {
    truth.distance += std::pow(p[a] - pair.points[3 * i + a], 2);
    if (!pair.normals.empty()) truth.normal[a] = pair.normals[i][a];
  }
  truth.distance = std::sqrt(truth.distance);
  return truth;
}

/** Brings the points that are finite in both files into the scene and its truth. \return the
 * point, in the files, that both are relative to. */
Point joinPair(const CloudView& input, const CloudView& clean, Scene& scene, PairTruth& pair) {
  std::vector<double> noisy;
  Point origin{};
  for (std::size_t i = 0; i < input.size; ++i) {
    const Point p = input.position(i), q = clean.position(i);
    if (!isFinite(p) || !isFinite(q)) continue;
    if (pair.points.empty()) origin = q;
    for (std::size_t a = 0; a < 3; ++a) {
      noisy.push_back(p[a] - origin[a]);
      pair.points.push_back(q[a] - origin[a]);
    }
    if (clean.normal) pair.normals.push_back(clean.givenNormal(i));
    if (!input.normal) continue;
    const std::array<float, 3> n = input.givenNormal(i);
    scene.normals.insert(scene.normals.end(), n.begin(), n.end());
  }
  scene.points = toCloud(noisy);
  return origin;
}

/** Triangles of a mesh relative to an origin, larger faces as fans; those with a corner that is not
 * finite are left out. */
std::shared_ptr<const MeshSurface> surfaceOf(const CloudFile& mesh, const Point& origin) {
  const PointFile& file = mesh.file;
  const CloudView view = mesh.view(false);
  std::vector<Point> vertices(view.size);
  for (std::size_t i = 0; i < view.size; ++i) {
    const Point p = view.position(i);
    vertices[i] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
  }
  std::vector<MeshSurface::Triangle> triangles;
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    for (std::uint32_t k = file.face_begin[f] + 2; k < file.face_begin[f + 1]; ++k) {
      const MeshSurface::Triangle t = {file.face_vertices[file.face_begin[f]],
                                       file.face_vertices[k - 1], file.face_vertices[k]};
      const bool finite =
          isFinite(vertices[t[0]]) && isFinite(vertices[t[1]]) && isFinite(vertices[t[2]]);
      if (finite) triangles.push_back(t);
    }
  }
  if (triangles.empty()) return nullptr;
  return std::make_shared<const MeshSurface>(std::move(vertices), std::move(triangles));
}

/** Compares a scan's points with a mesh: those near its surface, not over its holes or beyond
 * its border, and not farther from it than reach. */
void judgeByMesh(const std::shared_ptr<const MeshSurface>& surface, double reach, Scene& scene) {
  scene.judged.resize(scene.size());
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const pcl::PointXYZ& p = (*scene.points)[i];
    const MeshFoot foot = surface->nearest({p.x, p.y, p.z});
    scene.judged[i] = !foot.border && foot.distance <= reach;
  }
  scene.truth = [surface](std::size_t, const Point& p) {
    measure::Truth truth;
    truth.distance = surface->nearest(p).distance;
    return truth;
  };
}

Error noTruth(const std::string& input, const std::string& truth, std::size_t points,
              std::size_t others) {
  return {ErrorCode::kBadInput,
          "'" + input + "' has " + std::to_string(points) + " points and '" + truth + "' " +
              std::to_string(others) +
              " and no faces; name a truth with the same points in the same order, or a mesh"};
}

}  // namespace

Result<Scene> loadScene(const std::string& name, const std::string& input,
                        const std::string& truth) {
  const Result<CloudFile> noisy = loadCloudFile(input);
  if (!noisy) return noisy.error();
  const Result<CloudFile> clean = loadCloudFile(truth);
  if (!clean) return clean.error();
  const bool pointwise = noisy->size() == clean->size();
  if (!pointwise && clean->file.numFaces() == 0) {
    return noTruth(input, truth, noisy->size(), clean->size());
  }
  Scene scene;
  scene.name = name;
  scene.has_true_curvature = false;
  const auto pair = std::make_shared<PairTruth>();
  const Point origin =
      joinPair(noisy->view(), pointwise ? clean->view() : noisy->view(), scene, *pair);
  if (scene.size() == 0) {
    return Error{ErrorCode::kBadInput,
                 "'" + input + "' has no finite point with a truth; name other files"};
  }
  const double edge = meanEdge(*clean);
  scene.spacing = spacingOf(toCloud(pair->points));
  if (pointwise) {
    scene.unit_is_edge = edge > 0;
    scene.unit = edge > 0 ? edge : 1;
    scene.has_true_normals = !pair->normals.empty();
    scene.truth = [pair](std::size_t i, const Point& p) { return pairTruth(*pair, i, p); };
    return scene;
  }
  scene.has_true_normals = false;
  const auto surface = surfaceOf(*clean, origin);
  if (!surface) {
    return Error{ErrorCode::kBadInput, "'" + truth + "' has no finite face; name another mesh"};
  }
  judgeByMesh(surface, edge, scene);
  if (std::count(scene.judged.begin(), scene.judged.end(), 1) == 0) {
    return Error{ErrorCode::kBadInput, "no point of '" + input + "' lies by the surface of '" +
                                           truth + "'; name a mesh of the same object and place"};
  }
  return scene;
}

}  // namespace pcl_slim::comparison
