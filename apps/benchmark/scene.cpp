// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/scene.h"

#include <pcl/search/kdtree.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>

#include "common/cloud_file.h"

namespace pcl_slim::comparison {

namespace {

using Point = std::array<double, 3>;
constexpr double kNormalNoise = 0.05;  // rad
constexpr double kCubeHalf = 1.0;

pcl::PointXYZ
toPcl(const double* p)
{
  return pcl::PointXYZ(static_cast<float>(p[0]), static_cast<float>(p[1]),
                       static_cast<float>(p[2]));
}

pcl::PointCloud<pcl::PointXYZ>::Ptr
toCloud(const std::vector<double>& xyz)
{
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(xyz.size() / 3);
  for (std::size_t i = 0; i < xyz.size(); i += 3) cloud->push_back(toPcl(&xyz[i]));
  return cloud;
}

/** sqrt(area / points) from the median distance to the 10th neighbour of clean points, as far as
 * they lie evenly on a surface. */
double
spacingOf(const pcl::PointCloud<pcl::PointXYZ>::Ptr& clean)
{
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
  std::nth_element(tenth.begin(), tenth.begin() + tenth.size() / 2, tenth.end());
  return std::sqrt(tenth[tenth.size() / 2] * M_PI / kNeighbours);
}

/** A scene whose clean points are the cube's, spread evenly, as bench::makeScene does for others. */
bench::Scene
makeCube(std::size_t count, double noise, std::uint64_t seed)
{
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> side(-kCubeHalf, kCubeHalf);
  std::uniform_int_distribution<int> face(0, 5);
  std::normal_distribution<double> gauss;
  bench::Scene scene;
  scene.diagonal = 2 * kCubeHalf * std::sqrt(3.0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<std::size_t>(face(rng));
    Point p = {side(rng), side(rng), side(rng)}, n{};
    const double sign = f % 2 == 0 ? 1 : -1;
    p[f / 2] = sign * kCubeHalf;
    n[f / 2] = sign;
    double length = 0;
    for (double& value : n) {
      value += kNormalNoise * gauss(rng);
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
bench::Truth
cubeTruth(const Point& p)
{
  double outside = 0, inside = -kCubeHalf;
  std::size_t axis = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double beyond = std::abs(p[a]) - kCubeHalf;
    outside += std::pow(std::max(0.0, beyond), 2);
    inside = std::max(inside, beyond);
    if (std::abs(p[a]) > std::abs(p[axis])) axis = a;
  }
  bench::Truth truth;
  truth.distance = inside > 0 ? std::sqrt(outside) : inside;
  truth.normal[axis] = p[axis] < 0 ? -1 : 1;
  return truth;
}

/** Coordinates as doubles, whatever the file holds. */
Point
positionOf(const CloudView& view, std::size_t i)
{
  const auto* address = static_cast<const char*>(view.xyz) + i * view.xyz_stride;
  Point p;
  if (view.scalar == CloudView::Scalar::kDouble) {
    std::memcpy(p.data(), address, sizeof(p));
    return p;
  }
  std::array<float, 3> f;
  std::memcpy(f.data(), address, sizeof(f));
  return {f[0], f[1], f[2]};
}

std::array<float, 3>
normalOf(const CloudView& view, std::size_t i)
{
  std::array<float, 3> n;
  std::memcpy(n.data(), static_cast<const char*>(view.normal) + i * view.normal_stride, sizeof(n));
  return n;
}

bool
isFinite(const Point& p)
{
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

/** Mean edge length of a mesh; 0 without faces. */
double
meanEdge(const CloudFile& mesh)
{
  const PointFile& file = mesh.file;
  const CloudView view = mesh.view(false);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < file.numFaces(); ++f) {
    const std::uint32_t begin = file.face_begin[f], end = file.face_begin[f + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      const Point a = positionOf(view, file.face_vertices[k]);
      const Point b = positionOf(view, file.face_vertices[k + 1 < end ? k + 1 : begin]);
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

bench::Truth
pairTruth(const PairTruth& pair, std::size_t i, const Point& p)
{
  bench::Truth truth;
  for (std::size_t a = 0; a < 3; ++a) {
    truth.distance += std::pow(p[a] - pair.points[3 * i + a], 2);
    if (!pair.normals.empty()) truth.normal[a] = pair.normals[i][a];
  }
  truth.distance = std::sqrt(truth.distance);
  return truth;
}

/** Brings the points that are finite in both files into the scene and its truth. */
void
joinPair(const CloudView& input, const CloudView& clean, Scene& scene, PairTruth& pair)
{
  std::vector<double> noisy;
  Point origin{};
  for (std::size_t i = 0; i < input.size; ++i) {
    const Point p = positionOf(input, i), q = positionOf(clean, i);
    if (!isFinite(p) || !isFinite(q)) continue;
    if (pair.points.empty()) origin = q;
    for (std::size_t a = 0; a < 3; ++a) {
      noisy.push_back(p[a] - origin[a]);
      pair.points.push_back(q[a] - origin[a]);
    }
    if (clean.normal) pair.normals.push_back(normalOf(clean, i));
    if (!input.normal) continue;
    const std::array<float, 3> n = normalOf(input, i);
    scene.normals.insert(scene.normals.end(), n.begin(), n.end());
  }
  scene.points = toCloud(noisy);
}

}  // namespace

const std::vector<std::string>&
shapeNames()
{
  static const std::vector<std::string> names = {"sphere", "torus", "bumpy", "relief", "cube"};
  return names;
}

Result<Scene>
makeScene(const std::string& shape, std::size_t count, double noise, std::uint64_t seed)
{
  bench::Shape kind = bench::Shape::kSphere;
  const bool cube = shape == "cube";
  if (!cube && !bench::parseShape(shape, kind)) {
    return Error{ErrorCode::kBadArgument,
                 "unknown shape '" + shape + "'; give sphere, torus, bumpy, relief or cube"};
  }
  const auto make = [&](double sigma) {
    return cube ? makeCube(count, sigma, seed)
                : bench::makeScene(kind, count, sigma, kNormalNoise, seed);
  };
  bench::Scene made = make(noise);
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
    scene.truth = [kind](std::size_t, const Point& p) { return bench::truthAt(kind, p); };
  }
  return scene;
}

Result<Scene>
loadScene(const std::string& name, const std::string& input, const std::string& truth)
{
  const Result<CloudFile> noisy = loadCloudFile(input);
  if (!noisy) return noisy.error();
  const Result<CloudFile> clean = loadCloudFile(truth);
  if (!clean) return clean.error();
  if (noisy->size() != clean->size()) {
    return Error{ErrorCode::kBadInput, "'" + input + "' has " + std::to_string(noisy->size()) +
                                           " points and '" + truth + "' " +
                                           std::to_string(clean->size()) +
                                           "; name a truth with the same points in the same order"};
  }
  Scene scene;
  scene.name = name;
  const auto pair = std::make_shared<PairTruth>();
  joinPair(noisy->view(), clean->view(), scene, *pair);
  if (scene.size() == 0) {
    return Error{ErrorCode::kBadInput,
                 "'" + input + "' has no finite point with a truth; name other files"};
  }
  const double edge = meanEdge(*clean);
  scene.unit_is_edge = edge > 0;
  scene.unit = edge > 0 ? edge : 1;
  scene.spacing = spacingOf(toCloud(pair->points));
  scene.has_true_curvature = false;
  scene.has_true_normals = !pair->normals.empty();
  scene.truth = [pair](std::size_t i, const Point& p) { return pairTruth(*pair, i, p); };
  return scene;
}

}  // namespace pcl_slim::comparison
