// SPDX-License-Identifier: BSD-3-Clause
// Splats of samples of a surface, beside those of the noisy points that it was fitted to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "painted_clouds.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/fit/fit_colors.h"
#include "pcl_slim/query/surface_samples.h"
#include "support/lab/painted_object.h"

namespace pcl_slim {
namespace {

using namespace pcl_slim_test;

PaintedCloud duck(std::size_t count, std::uint64_t seed, double noise, double color_noise) {
  const measure::PaintedObject object = measure::paintDuck(count, seed);
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<double> normal;
  PaintedCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> p, n;
    std::array<int, 3> rgb;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = object.xyz[3 * i + a] + noise * normal(random);
      n[a] = object.normals[3 * i + a];
      const auto byte = static_cast<double>(object.rgb[i] >> (16 - 8 * a) & 255u);
      rgb[a] = static_cast<int>(std::lround(byte + color_noise * normal(random)));
    }
    cloud.add(p, n, rgb);
  }
  return cloud;
}

PaintedCloud cloudOf(const SurfaceSamples& samples) {
  PaintedCloud cloud;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& n = samples.normal[i];
    const auto& rgb = samples.color[i];
    cloud.add(samples.position[i], {n[0], n[1], n[2]}, {rgb[0], rgb[1], rgb[2]});
  }
  return cloud;
}

/** How splats differ from the truth; each counts as many times as there are points behind it, so that
 * parts with many small splats count like others. */
struct SplatErrors {
  double position = 0;       ///< RMS distance from the surface, world units
  double normal = 0;         ///< RMS angle [deg]
  double color = 0;          ///< mean Delta E from the nearest exact point
  std::size_t compared = 0;  ///< splats
};

/** Compares splats with exact points: with the tangent plane and the colour of the nearest one. */
SplatErrors errorsOf(const SplatSet& splats, const PaintedCloud& exact) {
  Cloud both{exact.points, {}};
  for (std::size_t i = 0; i < splats.size(); ++i)
    both.add(splats.origin[0] + splats.x[i], splats.origin[1] + splats.y[i],
             splats.origin[2] + splats.z[i]);
  const PointStore store = storeOf(both);
  NeighborSearch search(store);
  std::vector<std::uint32_t> found;
  std::vector<float> squared;
  const LabTable lab;
  SplatErrors errors;
  double total = 0;
  for (std::size_t i = 0; i < store.size(); ++i) {
    if (store.orderOfStore()[i] < exact.size()) continue;
    const std::size_t splat = store.orderOfStore()[i] - exact.size();
    search.nearest(i, 64, found, squared);
    const auto near = std::find_if(found.begin(), found.end(), [&](std::uint32_t j) {
      return store.orderOfStore()[j] < exact.size();
    });
    if (near == found.end()) continue;
    const std::size_t e = store.orderOfStore()[*near];
    double height = 0, cosine = 0;
    const float n[3] = {splats.nx[splat], splats.ny[splat], splats.nz[splat]};
    for (std::size_t a = 0; a < 3; ++a) {
      height += (store.position(i)[a] - store.position(*near)[a]) * exact.normals[3 * e + a];
      cosine += n[a] * exact.normals[3 * e + a];
    }
    const double weight = splats.confidence[splat];
    total += weight;
    errors.position += weight * std::pow(height * store.scale(), 2);
    errors.normal += weight * std::pow(std::acos(std::min(1.0, std::abs(cosine))) * 180 / M_PI, 2);
    float is[3], was[3];
    const std::uint32_t rgb = splats.rgb[splat];
    lab.convert(static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
                static_cast<std::uint8_t>(rgb), is);
    lab.convert(exact.bgr[3 * e + 2], exact.bgr[3 * e + 1], exact.bgr[3 * e], was);
    errors.color += weight * std::hypot(is[0] - was[0], is[1] - was[1], is[2] - was[2]);
    ++errors.compared;
  }
  errors.position = std::sqrt(errors.position / total);
  errors.normal = std::sqrt(errors.normal / total);
  errors.color /= total;
  return errors;
}

void report(const char* name, std::size_t splats, const SplatErrors& errors) {
  std::printf("%s: %zu splats, position %.5f, normals %.2f deg, colour %.2f Delta E\n", name,
              splats, errors.position, errors.normal, errors.color);
}

TEST(SurfaceSplats, AreNearerToTheTruthThanThoseOfNoisyPoints) {
  constexpr double kNoise = 0.01;  // .5 % of the duck's length
  const PaintedCloud exact = duck(200000, 7, 0, 0), scan = duck(60000, 1, kNoise, 8);
  const SplatSet of_points = sampled(scan, oneThread(), nullptr, false);

  const Cloud points{scan.points, {}};
  Fitted f = fitted(points);
  ASSERT_FALSE(fitColors(f.store, points.view(), scan.colors(), 1, f.surface));
  SurfaceSampleParams even;
  even.count = scan.size();
  even.threads = 1;
  SurfaceSamples samples;
  ASSERT_FALSE(sampleSurface(f.surface, even, samples));
  const PaintedCloud of_surface = cloudOf(samples);
  const SplatSet splats = sampled(of_surface, oneThread());

  const SplatErrors before = errorsOf(of_points, exact), after = errorsOf(splats, exact);
  report("points", of_points.size(), before);
  report("surface", splats.size(), after);
  EXPECT_GT(before.compared, of_points.size() * 9 / 10);
  EXPECT_EQ(after.compared, splats.size());
  // Measured: .22 and .21. The scan's noise is as large as its spacing.
  EXPECT_LT(after.position, 0.35 * before.position);
  EXPECT_LT(after.normal, 0.35 * before.normal);
  EXPECT_LT(after.color, 1.25 * before.color) << "with half as many splats; measured: 1.08";
  EXPECT_LT(splats.size(), 0.7 * static_cast<double>(of_points.size()));
  const HoleCheck holes = holesSeen(of_surface, splats, 20000);
  EXPECT_EQ(holes.missed, 0u);
  EXPECT_GT(holes.rays, 15000u);
}

}  // namespace
}  // namespace pcl_slim
