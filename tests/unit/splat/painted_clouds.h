// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "pcl_slim/splat/hole_check.h"
#include "pcl_slim/splat/splat_sampling.h"
#include "support/clouds.h"

namespace pcl_slim_test {

/** Coloured points that a test owns. */
struct PaintedCloud : Cloud {
  std::vector<std::uint8_t> bgr;

  pcl_slim::CloudView view(bool with_normals = true) const {
    pcl_slim::CloudView view = viewOf(points, normals);
    if (!with_normals) view.normal = nullptr;
    return view;
  }

  pcl_slim::ColorView colors() const { return {bgr.data(), 3}; }

  void add(const std::array<double, 3>& p, const std::array<double, 3>& n,
           const std::array<int, 3>& rgb) {
    Cloud::add(p, n);
    for (int c = 2; c >= 0; --c) {
      bgr.push_back(
          static_cast<std::uint8_t>(std::clamp(rgb[static_cast<std::size_t>(c)], 0, 255)));
    }
  }
};

/** Where painted() has its dark eye. */
inline bool inEye(const std::array<double, 3>& p) {
  return std::hypot(p[0] - 0.7, p[1] - 0.4) < 0.12 && p[2] > 0.0;
}

/** An ellipsoid with stripes and an eye. noise: standard deviation of each byte of colour. */
inline PaintedCloud painted(std::size_t count, double noise = 0.0,
                            std::array<double, 3> place = {0, 0, 0}) {
  PaintedCloud cloud;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const std::array<double, 3> axes = {1.0, 0.8, 0.6};
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> d = {normal(random), normal(random), normal(random)}, p, n;
    const double length = std::hypot(d[0], d[1], d[2]);
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = axes[a] * d[a] / length;
      n[a] = d[a] / axes[a];
    }
    const double scale = std::hypot(n[0], n[1], n[2]);
    for (double& value : n) value /= scale;
    std::array<int, 3> rgb = {240, 200, 60};
    // Aslant, as stripes along the grid would coincide with its cells' faces.
    if (std::fmod(0.36 * p[0] + 0.48 * p[1] + 0.8 * p[2] + 2.0, 0.3) < 0.1) rgb = {220, 60, 40};
    if (inEye(p)) rgb = {20, 20, 30};
    for (int& c : rgb) c = static_cast<int>(std::lround(c + noise * normal(random)));
    for (std::size_t a = 0; a < 3; ++a) p[a] += place[a];
    cloud.add(p, n, rgb);
  }
  return cloud;
}

inline pcl_slim::SplatSet sampled(const PaintedCloud& cloud, const pcl_slim::SplatParams& params,
                                  pcl_slim::SplatStatistics* statistics = nullptr,
                                  bool with_normals = true) {
  pcl_slim::SplatSet splats;
  const pcl_slim::Error error =
      sampleSplats(cloud.view(with_normals), cloud.colors(), params, splats, statistics);
  EXPECT_FALSE(error) << error.message;
  return splats;
}

inline pcl_slim::SplatParams oneThread() {
  pcl_slim::SplatParams params;
  params.threads = 1;
  return params;
}

/** Every column of two sets of splats. */
inline void expectSame(const pcl_slim::SplatSet& a, const pcl_slim::SplatSet& b) {
  using pcl_slim::SplatSet;
  for (const auto column :
       {&SplatSet::x, &SplatSet::y, &SplatSet::z, &SplatSet::nx, &SplatSet::ny, &SplatSet::nz,
        &SplatSet::radius, &SplatSet::confidence, &SplatSet::normal_variance}) {
    EXPECT_EQ(a.*column, b.*column);
  }
  EXPECT_EQ(a.rgb, b.rgb);
  EXPECT_EQ(a.kept, b.kept);
  EXPECT_EQ(a.gradient, b.gradient);
}

inline std::size_t countOf(const PaintedCloud& cloud, const pcl_slim::SplatParams& params) {
  return sampled(cloud, params).size();
}

inline pcl_slim::HoleCheck holesSeen(const PaintedCloud& cloud, const pcl_slim::SplatSet& splats,
                                     std::uint64_t rays) {
  const auto store = pcl_slim::PointStore::build(cloud.view(), 1);
  EXPECT_TRUE(store);
  pcl_slim::HoleCheckParams params;
  params.rays = rays;
  params.threads = 1;
  const auto check = checkHoles(*store, splats, params);
  EXPECT_TRUE(check) << check.error().message;
  return *check;
}

/** Every number is finite, normals are unit, radii positive, each kept point is one of the cloud's,
 * and the splats' points add up. */
inline void expectSound(const pcl_slim::SplatSet& s, std::size_t points) {
  double total = 0;
  std::vector<bool> seen;
  for (std::size_t i = 0; i < s.size(); ++i) {
    ASSERT_TRUE(std::isfinite(s.x[i]) && std::isfinite(s.y[i]) && std::isfinite(s.z[i])) << i;
    ASSERT_NEAR(std::hypot(s.nx[i], s.ny[i], s.nz[i]), 1.0f, 1e-5f) << i;
    ASSERT_TRUE(std::isfinite(s.radius[i]) && s.radius[i] > 0.0f) << i;
    ASSERT_TRUE(s.normal_variance[i] >= 0.0f && s.normal_variance[i] <= 0.67f) << i;
    ASSERT_GE(s.confidence[i], 1.0f) << i;
    if (seen.size() <= s.kept[i]) seen.resize(s.kept[i] + 1u, false);
    ASSERT_FALSE(seen[s.kept[i]]) << "kept twice";
    seen[s.kept[i]] = true;
    total += s.confidence[i];
  }
  EXPECT_EQ(total, static_cast<double>(points));
}

}  // namespace pcl_slim_test
