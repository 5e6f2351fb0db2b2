// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/scene.h"

#include <pcl/search/kdtree.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "pcl_slim/core/order_statistics.h"

namespace pcl_slim::comparison {

namespace {

using Point = std::array<double, 3>;
constexpr double kCubeHalf = 1.0;

/** A scene whose clean points are the cube's, spread evenly, as measure::makeScene does for others. */
measure::Scene
makeCube(std::size_t count, double noise, std::uint64_t seed, double normal_noise)
{
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
measure::Truth
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
  measure::Truth truth;
  truth.distance = inside > 0 ? std::sqrt(outside) : inside;
  truth.normal[axis] = p[axis] < 0 ? -1 : 1;
  return truth;
}

}  // namespace

pcl::PointCloud<pcl::PointXYZ>::Ptr
toCloud(const std::vector<double>& xyz)
{
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  cloud->reserve(xyz.size() / 3);
  for (std::size_t i = 0; i < xyz.size(); i += 3) {
    cloud->push_back(pcl::PointXYZ(static_cast<float>(xyz[i]), static_cast<float>(xyz[i + 1]),
                                   static_cast<float>(xyz[i + 2])));
  }
  return cloud;
}

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
  return std::sqrt(median(std::move(tenth)) * M_PI / kNeighbours);
}

const std::vector<std::string>&
shapeNames()
{
  static const std::vector<std::string> names = {"sphere", "torus", "bumpy", "relief", "cube"};
  return names;
}

Result<Scene>
makeScene(const std::string& shape, std::size_t count, double noise, std::uint64_t seed,
          double normal_noise)
{
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

}  // namespace pcl_slim::comparison
