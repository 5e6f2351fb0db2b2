// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "color/color_rows.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/core/cielab.h"
#include "pcl_slim/query/surface_probe.h"
#include "pcl_slim/scan/scan.h"
#include "pcl_slim/splat/splat_sampling.h"

namespace pcl_slim::measure {
namespace {

constexpr std::size_t kPoints = 40000, kPlaces = 4000;
constexpr double kHeightNoise = 0.2;  ///< [spacing]
const double kSpacing = 2.0 / std::sqrt(static_cast<double>(kPoints));

using Rgb = std::array<double, 3>;
using Paint = std::function<Rgb(double, double)>;

double heightAt(double x, double y) {
  return 0.1 * x * x - 0.05 * y * y;
}

/** Coloured points in space. */
struct Painted {
  std::vector<Vector3> points;
  std::vector<std::uint8_t> bgr;

  void add(const Vector3& place, const Rgb& rgb) {
    points.push_back(place);
    for (std::size_t c = 3; c-- > 0;)
      bgr.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(rgb[c], 0.0, 255.0))));
  }
  CloudView view() const {
    CloudView cloud;
    cloud.xyz = points.data();
    cloud.xyz_stride = sizeof(Vector3);
    cloud.scalar = CloudView::Scalar::kDouble;
    cloud.size = points.size();
    return cloud;
  }
};

Painted plate(const Paint& paint, double color_noise) {
  Painted cloud;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double x = uniform(random), y = uniform(random);
    Rgb rgb = paint(x, y);
    for (double& channel : rgb) channel += color_noise * normal(random);
    cloud.add({x, y, heightAt(x, y) + kHeightNoise * kSpacing * normal(random)}, rgb);
  }
  return cloud;
}

double deltaE(const Rgb& a, const Rgb& b) {
  const auto first = labFromRgb({a[0] / 255, a[1] / 255, a[2] / 255}),
             second = labFromRgb({b[0] / 255, b[1] / 255, b[2] / 255});
  return std::hypot(first[0] - second[0], first[1] - second[1], first[2] - second[2]);
}

/** Mean distance from the truth of the colours of the nearest of some points. */
double ofNearest(const Painted& cloud, const std::vector<Vector3>& places, const Paint& paint) {
  Painted all = cloud;
  for (const Vector3& place : places) all.add(place, {});
  const auto store = PointStore::build(all.view());
  NeighborSearch search(*store);
  std::vector<std::uint32_t> found;
  std::vector<float> squared;
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < store->size(); ++i) {
    const std::size_t own = store->orderOfStore()[i];
    if (own < cloud.points.size()) continue;
    for (std::size_t wanted = 8;; wanted *= 4) {
      search.nearest(i, wanted, found, squared);
      const auto near = std::find_if(found.begin(), found.end(), [&](std::uint32_t j) {
        return store->orderOfStore()[j] < cloud.points.size();
      });
      if (near == found.end() && wanted < store->size()) continue;
      const std::uint8_t* bgr = cloud.bgr.data() + 3 * store->orderOfStore()[*near];
      const Vector3& place = all.points[own];
      sum += deltaE(paint(place[0], place[1]), {double(bgr[2]), double(bgr[1]), double(bgr[0])});
      ++count;
      break;
    }
  }
  return sum / count;
}

/** The centroids and mean colours of a grid's cells, as pcl::VoxelGrid has them. */
Painted voxels(const Painted& cloud, double leaf) {
  struct Cell {
    Vector3 place{};
    Rgb rgb{};
    double count = 0;
  };
  std::vector<std::pair<std::array<long, 3>, Cell>> cells;
  std::vector<std::pair<std::array<long, 3>, std::size_t>> keys;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    std::array<long, 3> key;
    for (std::size_t a = 0; a < 3; ++a)
      key[a] = static_cast<long>(std::floor(cloud.points[i][a] / leaf));
    keys.push_back({key, i});
  }
  std::sort(keys.begin(), keys.end());
  for (const auto& [key, i] : keys) {
    if (cells.empty() || cells.back().first != key) cells.push_back({key, {}});
    Cell& cell = cells.back().second;
    for (std::size_t a = 0; a < 3; ++a) {
      cell.place[a] += cloud.points[i][a];
      cell.rgb[a] += cloud.bgr[3 * i + 2 - a];
    }
    ++cell.count;
  }
  Painted made;
  for (const auto& [key, cell] : cells)
    made.add(scaled(cell.place, 1 / cell.count), scaled(cell.rgb, 1 / cell.count));
  return made;
}

Painted splatsOf(const Painted& cloud) {
  SplatSet splats;
  Painted made;
  if (sampleSplats(cloud.view(), {cloud.bgr.data(), 3}, {}, splats)) return made;
  for (std::size_t i = 0; i < splats.size(); ++i) {
    const std::uint32_t rgb = splats.rgb[i];
    made.add({splats.origin[0] + splats.x[i], splats.origin[1] + splats.y[i],
              splats.origin[2] + splats.z[i]},
             {double(rgb >> 16 & 255), double(rgb >> 8 & 255), double(rgb & 255)});
  }
  return made;
}

double ofSurface(const SLIMSurface& surface, const std::vector<Vector3>& places,
                 const Paint& paint) {
  const std::vector<std::array<float, 3>> up(places.size(), {0, 0, 1});
  const auto colors = surfaceColors(surface, places, up, 0);
  double sum = 0;
  for (std::size_t i = 0; i < places.size(); ++i)
    sum += deltaE(paint(places[i][0], places[i][1]),
                  {double(colors[i][0]), double(colors[i][1]), double(colors[i][2])});
  return sum / static_cast<double>(places.size());
}

Error printRow(const char* name, double width, const Paint& paint, double noise) {
  const Painted cloud = plate(paint, noise);
  std::vector<Vector3> places;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.95, 0.95);
  while (places.size() < kPlaces) {
    const double x = uniform(random), y = uniform(random);
    places.push_back({x, y, heightAt(x, y)});
  }
  FittedScan fitted;
  if (Error error = fitScan({cloud.view(), {cloud.bgr.data(), 3}}, {}, fitted)) return error;
  SLIMSurface plain = fitted.surface;
  plain.dropTextures();
  std::printf("| %s, %g | %g | %.2f | %.2f | %.2f | %.2f | %.2f |\n", name, width, noise,
              ofNearest(cloud, places, paint),
              ofNearest(voxels(cloud, 2 * kSpacing), places, paint),
              ofNearest(splatsOf(cloud), places, paint), ofSurface(plain, places, paint),
              ofSurface(fitted.surface, places, paint));
  return {};
}

}  // namespace

Error printPainted() {
  std::printf(
      "| paint, width in spacings | noise | nearest point | voxels of 2 spacings | splats | "
      "polynomials | textures |\n|---|---|---|---|---|---|---|\n");
  const Rgb dark = {40, 60, 80}, light = {220, 200, 170};
  for (const double noise : {0.0, 3.0, 10.0}) {
    for (const double width : {1.0, 2.0, 4.0, 8.0}) {
      const double w = width * kSpacing;
      const auto isOdd = [w](double at) {
        return (static_cast<long>(std::floor(at / w)) & 1) != 0;
      };
      // Turned, so that no method's grid is along the lines.
      const auto along = [](double x, double y) { return 0.8 * x + 0.6 * y + 5; };
      const auto across = [](double x, double y) { return 0.8 * y - 0.6 * x + 5; };
      const Paint stripes = [&](double x, double y) { return isOdd(along(x, y)) ? dark : light; };
      const Paint checker = [&](double x, double y) {
        return isOdd(along(x, y)) != isOdd(across(x, y)) ? dark : light;
      };
      if (Error error = printRow("stripes", width, stripes, noise)) return error;
      if (Error error = printRow("checker", width, checker, noise)) return error;
    }
    const Paint waves = [](double x, double y) {
      return Rgb{128 + 60 * std::sin(3 * x), 128 + 60 * std::cos(2 * y), 110 + 40 * x * y};
    };
    if (Error error = printRow("smooth", 1 / kSpacing, waves, noise)) return error;
  }
  return {};
}

}  // namespace pcl_slim::measure
