// SPDX-License-Identifier: BSD-3-Clause
// What benchmarks/README.md says of the default, on fewer points.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "pcl_slim/cloud/knn.h"
#include "sweep.h"

namespace {

using namespace pcl_slim_test;
using pcl_slim::comparison::kNormalNoise;
using pcl_slim::comparison::loadScene;
using pcl_slim::comparison::makeScene;
using pcl_slim::comparison::Treated;
using Point = std::array<double, 3>;

Scene exactScene(const std::string& shape, std::size_t count, double noise,
                 double normal_noise = kNormalNoise) {
  const auto scene = makeScene(shape, count, noise, 7, normal_noise);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? *scene : Scene();
}

/** Two square sheets with noise, .35 % of the diagonal apart, flat or with a gentle wave; normals
 * opposed, as those of a plate are. Even points are of the upper one. */
Scene sheets(bool waved, std::size_t count, double half_gap, double sigma) {
  const auto waveAt = [waved](double x) {
    return waved ? std::array<double, 2>{0.05 * std::sin(2 * x), 0.1 * std::cos(2 * x)}
                 : std::array<double, 2>{0, 0};
  };
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> gauss;
  Scene scene;
  scene.points.reset(new pcl::PointCloud<pcl::PointXYZ>);
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(rng), y = place(rng), side = i % 2 == 0 ? 1 : -1;
    const auto [height, slope] = waveAt(x);
    const double z = height + side * half_gap + sigma * gauss(rng), length = std::hypot(1.0, slope);
    scene.points->emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    for (const double value : {-side * slope / length, 0.0, side / length}) {
      scene.normals.push_back(static_cast<float>(value));
    }
  }
  scene.spacing = std::sqrt(4.0 / static_cast<double>(count));
  scene.has_true_curvature = false;
  scene.truth = [=](std::size_t i, const Point& p) {
    const auto [height, slope] = waveAt(p[0]);
    const double side = i % 2 == 0 ? 1 : -1;
    pcl_slim::measure::Truth truth;
    truth.distance = side * (p[2] - height - side * half_gap) / std::hypot(1.0, slope);
    return truth;
  };
  return scene;
}

Treated treated(const Scene& scene, Setting setting) {
  setting.threads = 1;
  const auto result = treat(scene, setting);
  EXPECT_TRUE(result) << setting.text() << ": " << result.error().message;
  return result ? *result : Treated();
}

TEST(Claims, SheetsStayApart) {
  const double diagonal = std::sqrt(8.0), half_gap = 0.5 * 0.0035 * diagonal;
  for (const bool waved : {false, true}) {
    const Scene scene = sheets(waved, 60000, half_gap, 1e-4 * diagonal);
    for (const bool normals : {false, true}) {
      const Treated result = treated(scene, slim(normals));
      ASSERT_EQ(result.points.size(), scene.size());
      std::size_t crossed = 0;
      for (std::size_t i = 0; i < scene.size(); ++i) {
        const auto& p = result.points[i];
        crossed += std::abs(scene.truth(i, {p.x, p.y, p.z}).distance) > half_gap;
      }
      EXPECT_EQ(crossed, 0u) << (waved ? "waved" : "flat") << (normals ? ", normals given" : "");
    }
  }
}

TEST(Claims, BadNormalsDoLittleHarm) {
  for (const char* shape : {"sphere", "torus", "bumpy", "relief"}) {
    for (const double noise : {0.001, 0.005}) {
      const Errors exact = errorsOf(exactScene(shape, 20000, noise, 0), slim(true));
      const Errors bad = errorsOf(exactScene(shape, 20000, noise, 0.3), slim(true));
      EXPECT_LE(bad.position, 1.1 * exact.position) << shape << ", " << noise;
      EXPECT_LE(bad.normal, 1.1 * exact.normal) << shape << ", " << noise;
    }
  }
}

TEST(Claims, RimsAreBesideThoseOfMls) {
  Scene scene = exactScene("relief", 20000, 0.001);
  // Within 1 % of the side from the border: that is what is judged.
  const Scene clean = exactScene("relief", 20000, 0);
  for (const auto& p : *clean.points) {
    scene.judged.push_back(std::max(std::abs(p.x), std::abs(p.y)) > 0.98);
  }
  const double rival = bestOf(scene, {mls(2, 60), mls(2, 120), mls(2, 240)}).position;
  Setting as_data = slim(true);
  as_data.data = true;
  for (const Setting& setting : {slim(false), slim(true), as_data}) {
    EXPECT_LE(errorsOf(scene, setting).position, rival) << setting.fullText();
  }
}

TEST(Claims, TheDefaultIsNearTheBestPenalty) {
  for (const char* shape : {"bumpy", "relief"}) {
    const Scene scene = exactScene(shape, 20000, 0.001);
    for (const bool normals : {false, true}) {
      Setting published = slim(normals);
      published.t_mdl = 0.01;
      const double own = errorsOf(scene, slim(normals)).position;
      const double best =
          bestOf(scene, {slim(normals, 0, 1), slim(normals, 0, 8), published}).position;
      EXPECT_LE(own, 1.15 * std::min(own, best)) << shape << (normals ? ", normals given" : "");
    }
  }
}

/** sqrt(area / points) around each point in the cloud's order, from its ten nearest distinct
 * neighbours; 0 where there are fewer. */
std::vector<double> localSpacings(const pcl_slim::PointStore& store) {
  pcl_slim::NeighborSearch search(store);
  std::vector<std::uint32_t> neighbours;
  std::vector<float> squared;
  std::vector<double> stored(store.size()), spacings;
  for (std::size_t i = 0; i < store.size(); ++i) {
    search.nearest(i, 11, neighbours, squared);
    if (squared.size() == 11) stored[i] = store.scale() * std::sqrt(squared.back() * M_PI / 10);
  }
  for (const std::uint32_t i : store.storeOfInput()) spacings.push_back(stored[i]);
  return spacings;
}

TEST(Claims, ScansAreMovedLittle) {
  const char* data = std::getenv("PCL_SLIM_DATA");
  int found = 0;
  for (const char* name : {"kinect_mosd_learn13.pcd", "lone_star_geyser_tls.pcd",
                           "angel_real_scan.ply", "stanford_dragon_res2.ply"}) {
    const std::string file = std::string(data ? data : "") + "/" + name;
    if (!std::filesystem::exists(file)) continue;
    ++found;
    const auto scene = loadScene(name, file, file);
    ASSERT_TRUE(scene) << scene.error().message;
    pcl_slim::CloudView view;
    view.xyz = scene->points->data();
    view.xyz_stride = sizeof(pcl::PointXYZ);
    view.size = scene->size();
    const auto store = pcl_slim::PointStore::build(view);
    ASSERT_TRUE(store) << store.error().message;
    const std::vector<double> spacing = localSpacings(*store);
    // Coordinates rounded to a coarse lattice: the spacing says little of the surface there.
    const bool lattice = 100 * store->statistics().duplicates > scene->size();
    const double most_far = (lattice ? 0.002 : 0.0005) * static_cast<double>(scene->size());
    for (const bool normals : {false, true}) {
      if (normals && scene->normals.empty()) continue;
      const Treated result = treated(*scene, slim(normals));
      double farthest = 0;
      std::size_t far = 0;
      for (std::size_t i = 0; i < scene->size(); ++i) {
        if (!(spacing[i] > 0)) continue;
        const auto& from = (*scene->points)[i];
        const double step = (result.points[i].getVector3fMap() - from.getVector3fMap()).norm();
        far += step > 3 * spacing[i];
        farthest = std::max(farthest, step / spacing[i]);
      }
      EXPECT_LE(static_cast<double>(far), most_far) << name;
      EXPECT_LE(farthest, 15) << name;
    }
  }
  if (found == 0) GTEST_SKIP() << "none of the scans is there";
}

}  // namespace
