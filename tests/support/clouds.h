// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/query/projection.h"
#include "support/array_view.h"
#include "support/lab/scenes.h"

namespace pcl_slim_test {

/** Points that a test owns, with or without normals. */
struct Cloud {
  std::vector<double> points;
  std::vector<float> normals;

  std::size_t size() const { return points.size() / 3; }

  void add(double x, double y, double z) { points.insert(points.end(), {x, y, z}); }

  /** \brief Adds a point with noise. Compilers differ in the order of a call's arguments: three
   * draws as arguments would make another cloud. */
  void addNoisy(const std::array<double, 3>& p, std::normal_distribution<double>& noise,
                std::mt19937_64& rng) {
    for (const double value : p) points.push_back(value + noise(rng));
  }

  void add(const std::array<double, 3>& p, const std::array<double, 3>& n) {
    points.insert(points.end(), p.begin(), p.end());
    for (const double value : n) normals.push_back(static_cast<float>(value));
  }

  pcl_slim::CloudView view() const { return viewOf(points, normals); }

  Cloud withoutNormals() const { return {points, {}}; }
};

/** An exact surface's points; noise is a share of the diagonal, normal_noise in rad. */
inline Cloud sceneCloud(pcl_slim::measure::Shape shape, std::size_t count, double noise,
                        double normal_noise = 0.0) {
  const auto scene = pcl_slim::measure::makeScene(shape, count, noise, normal_noise, 7);
  return {scene.points, scene.normals};
}

inline pcl_slim::PointStore storeOf(const Cloud& cloud, int threads = 1) {
  auto store = pcl_slim::PointStore::build(cloud.view(), threads);
  EXPECT_TRUE(store) << store.error().message;
  return store ? std::move(*store) : pcl_slim::PointStore();
}

/** A cloud brought into order, fitted and projected. */
struct Fitted {
  pcl_slim::PointStore store;
  pcl_slim::SLIMSurface surface;
  pcl_slim::FitStatistics statistics;
  pcl_slim::Projection projection;

  std::array<double, 3> world(const std::array<double, 3>& local) const {
    std::array<double, 3> p;
    for (std::size_t a = 0; a < 3; ++a) p[a] = store.origin()[a] + store.scale() * local[a];
    return p;
  }
};

/** \param[out] none why the cloud has no surface, which is a failure where this is null. */
inline Fitted fitted(const Cloud& cloud, pcl_slim::FitParams params = {}, bool curvature = false,
                     pcl_slim::Error* none = nullptr) {
  Fitted f;
  f.store = storeOf(cloud);
  params.threads = 1;
  const pcl_slim::Error fit = fitSurface(f.store, params, f.surface, &f.statistics);
  if (none && fit.code == pcl_slim::ErrorCode::kNoSurface) {
    *none = fit;
  } else {
    EXPECT_FALSE(fit) << fit.message;
  }
  pcl_slim::ProjectionParams projection;
  projection.curvature = curvature;
  projection.sharp_features = params.sharp_features;
  projection.threads = 1;
  const pcl_slim::Error project = projectPoints(f.store, f.surface, projection, f.projection);
  EXPECT_FALSE(project) << project.message;
  return f;
}

/** Angle between the lines along two vectors [rad]. */
inline double angleBetween(const std::array<float, 3>& a, const std::array<double, 3>& b) {
  double cross_sq = 0, dot = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    const double x = a[j] * b[k] - a[k] * b[j];
    cross_sq += x * x;
    dot += a[i] * b[i];
  }
  return std::atan2(std::sqrt(cross_sq), std::abs(dot));
}

/** RMS errors of projected points against an exact surface: position in scene units, normals in
 * rad, mean curvature relative to its own RMS. */
struct Errors {
  double position = 0, normal = 0, curvature = 0;
};

inline Errors errorsOf(pcl_slim::measure::Shape shape, const Fitted& f,
                       std::size_t first_inputs = SIZE_MAX) {
  Errors e;
  double curvature_sq = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    if (f.store.orderOfStore()[i] >= first_inputs) continue;
    const auto truth = pcl_slim::measure::truthAt(shape, f.world(f.projection.position[i]));
    if (truth.rim) continue;
    ++count;
    e.position += truth.distance * truth.distance;
    const double angle = angleBetween(f.projection.normal[i], truth.normal);
    e.normal += angle * angle;
    if (f.projection.curvature.empty()) continue;
    double dot = 0;
    for (std::size_t a = 0; a < 3; ++a) dot += f.projection.normal[i][a] * truth.normal[a];
    const double sign = dot < 0 ? -1.0 : 1.0;
    const double off = sign * f.projection.curvature[i][0] / f.store.scale() - truth.mean_curvature;
    e.curvature += off * off;
    curvature_sq += truth.mean_curvature * truth.mean_curvature;
  }
  const auto n = static_cast<double>(std::max<std::size_t>(count, 1));
  e.position = std::sqrt(e.position / n);
  e.normal = std::sqrt(e.normal / n);
  if (curvature_sq > 0) e.curvature = std::sqrt(e.curvature / curvature_sq);
  return e;
}

/** Every number a fit and a projection hand out is finite, normals are unit where supported, the
 * surface is valid, and points without support are counted and kept their place. */
inline void expectSound(const Fitted& f) {
  const pcl_slim::Error error = f.surface.validate();
  EXPECT_FALSE(error) << error.message;
  for (const float value : f.surface.error) ASSERT_TRUE(std::isfinite(value) && value >= 0.0f);
  for (const float value : f.surface.effective_count)
    ASSERT_TRUE(std::isfinite(value) && value > 0.0f);
  ASSERT_EQ(f.projection.position.size(), f.store.size());
  ASSERT_EQ(f.projection.normal.size(), f.store.size());
  std::uint64_t unsupported = 0;
  for (std::size_t i = 0; i < f.store.size(); ++i) {
    const auto& n = f.projection.normal[i];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    ASSERT_NEAR(length, f.projection.supported[i] ? 1.0 : 0.0, 1e-5) << i;
    for (const double value : f.projection.position[i]) ASSERT_TRUE(std::isfinite(value)) << i;
    if (!f.projection.supported[i]) {
      ++unsupported;
      ASSERT_EQ(f.projection.position[i], f.store.position(i));
    }
    if (f.projection.curvature.empty()) continue;
    for (const float value : f.projection.curvature[i]) ASSERT_TRUE(std::isfinite(value)) << i;
  }
  EXPECT_EQ(f.projection.num_unsupported, unsupported);
  EXPECT_LE(f.statistics.unsupported, f.statistics.uncovered);
}

/** A square of side 2 about a centre, at height z(x, y): count points spread at random. */
template <typename Height>
Cloud heightField(std::size_t count, std::uint32_t seed, const Height& height) {
  Cloud cloud;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = uniform(random), y = uniform(random);
    cloud.add(x, y, height(x, y));
  }
  return cloud;
}

/** Points of a box about the origin, with the normals of its faces; noise moves them in all
 * directions. */
inline Cloud boxCloud(const std::array<double, 3>& half, std::size_t count, double noise,
                      std::uint32_t seed = 11) {
  Cloud cloud;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> gauss;
  const double areas[3] = {half[1] * half[2], half[0] * half[2], half[0] * half[1]};
  std::discrete_distribution<std::size_t> faces(areas, areas + 3);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t face = faces(random);
    std::array<double, 3> p, normal{};
    for (std::size_t a = 0; a < 3; ++a) p[a] = half[a] * uniform(random);
    normal[face] = p[face] < 0 ? -1 : 1;
    p[face] = normal[face] * half[face];
    for (double& value : p) value += noise * gauss(random);
    cloud.add(p, normal);
  }
  return cloud;
}

/** A torus of radius 1 about z, sampled evenly, with white noise. */
inline Cloud thickRing(int count, double tube, double sigma, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  std::uniform_real_distribution<double> unit(0, 1);
  Cloud cloud;
  while (cloud.size() < static_cast<std::size_t>(count)) {
    const double turn = 2 * M_PI * unit(random), about = 2 * M_PI * unit(random);
    const double out = 1 + tube * std::cos(about);
    if (unit(random) * (1 + tube) > out) continue;
    cloud.add(out * std::cos(turn) + normal(random), out * std::sin(turn) + normal(random),
              tube * std::sin(about) + normal(random));
  }
  return cloud;
}

}  // namespace pcl_slim_test
