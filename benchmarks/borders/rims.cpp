// SPDX-License-Identifier: BSD-3-Clause
#include "borders/rims.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "pcl_slim/render/surface_renderer.h"
#include "support/lab/reference/reference_renderer.h"

namespace pcl_slim::borders {
namespace {

constexpr double kHalfExtent = 62.0;  ///< of the picture, spacings
constexpr int kPixels = 1984;         ///< 16 a spacing
constexpr double kStep = 0.25;        ///< between places of a rim
constexpr double kDiscRadius = 50.0, kHoleRadius = 6.0, kHalfStrip = 4.0;
constexpr double kInside = -3.0, kOutside = 11.0;  ///< where the drawn rim is looked for

double heightAt(double x, double y) {
  return 4.0 * std::sin(x / 30.0) + 3.0 * std::cos(y / 25.0);
}

/** \brief The strip's middle line at parameter t, and its unit normal. */
RimPlace stripAt(double t) {
  const double slope = std::cos(t / 15.0);  // of 15 sin(t / 15)
  const double length = std::hypot(1.0, slope);
  return {{t, 15.0 * std::sin(t / 15.0)}, {-slope / length, 1.0 / length}};
}

double distanceToStrip(double x, double y) {
  double best = 1e9;
  for (double t = x - 8.0; t <= x + 8.0; t += 0.05) {
    const RimPlace p = stripAt(t);
    best = std::min(best, std::hypot(x - p.at[0], y - p.at[1]));
  }
  return best;
}

std::vector<RimPlace> circle(double radius, double outward) {
  std::vector<RimPlace> rim;
  const int places = static_cast<int>(2.0 * M_PI * radius / kStep);
  for (int i = 0; i < places; ++i) {
    const double a = 2.0 * M_PI * i / places, c = std::cos(a), s = std::sin(a);
    rim.push_back({{radius * c, radius * s}, {outward * c, outward * s}});
  }
  return rim;
}

std::vector<RimPlace> line(const std::array<double, 2>& normal) {
  std::vector<RimPlace> rim;
  for (double t = -40.0; t <= 40.0; t += kStep) {
    rim.push_back({{-t * normal[1], t * normal[0]}, normal});
  }
  return rim;
}

std::vector<RimPlace> stripSide(double side) {
  std::vector<RimPlace> rim;
  for (double t = -45.0, step; t <= 45.0; t += step) {
    const RimPlace p = stripAt(t);
    const std::array<double, 2> out{side * p.outward[0], side * p.outward[1]};
    rim.push_back({{p.at[0] + kHalfStrip * out[0], p.at[1] + kHalfStrip * out[1]}, out});
    step = kStep * p.outward[1];
  }
  return rim;
}

/** \brief Random places of density 1, or a jittered grid, where a shape contains them. */
std::vector<double> samples(const std::function<bool(double, double)>& holds, bool grid,
                            double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-60.0, 60.0), jitter(-0.3, 0.3);
  std::normal_distribution<double> normal;
  std::vector<double> points;
  for (int i = 0; i < 120 * 120; ++i) {
    const double x = grid ? i % 120 - 59.5 + jitter(random) : uniform(random);
    const double y = grid ? i / 120 - 59.5 + jitter(random) : uniform(random);
    if (!holds(x, y)) continue;
    for (const double value : {x, y, heightAt(x, y)}) {
      points.push_back(value + noise * normal(random));
    }
  }
  return points;
}

/** \brief Places beside a rim, where the picture shows the surface or not. */
double drawnRim(const RimPlace& place, const GBuffer& picture) {
  constexpr double kPixel = 2.0 * kHalfExtent / kPixels;
  for (double d = kInside; d < kOutside; d += 0.5 * kPixel) {
    const double x = place.at[0] + d * place.outward[0], y = place.at[1] + d * place.outward[1];
    const int column = static_cast<int>((x + kHalfExtent) / kPixel);
    const int row = static_cast<int>((kHalfExtent - y) / kPixel);
    if (column < 0 || row < 0 || column >= kPixels || row >= kPixels) return d;
    if (!picture.covered(picture.index(column, row))) return d;
  }
  return kOutside;
}

Error drawFromAbove(const SLIMSurface& surface, const RenderParams& params, bool reference,
                    GBuffer& picture) {
  Camera camera;
  camera.projection = Camera::Projection::kOrthographic;
  camera.position = {0.0, 0.0, 100.0};
  camera.view_height = 2.0 * kHalfExtent;
  camera.size = {kPixels, kPixels};
  RenderParams own = params;
  own.sides = VisibleSides::kBoth;
  own.columns = 0;
  return reference ? lab::renderReference(surface, camera, own, picture)
                   : renderSurface(surface, camera, own, picture);
}

/** \brief Sums over places of rims. */
class RimSums {
 public:
  void add(const std::vector<double>& drawn) {
    constexpr std::size_t kOneSpacing = 4;  // places
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      sum_ += drawn[i];
      sum_sq_ += drawn[i] * drawn[i];
      farthest_ = std::max(farthest_, std::abs(drawn[i]));
      if (i < kOneSpacing) continue;
      const double change = drawn[i] - drawn[i - kOneSpacing];
      change_sq_ += change * change;
      ++changes_;
    }
    count_ += static_cast<double>(drawn.size());
  }

  RimFigures figures() const {
    const double mean = sum_ / count_;
    return {mean, std::sqrt(std::max(0.0, sum_sq_ / count_ - mean * mean)), farthest_,
            std::sqrt(change_sq_ / changes_)};
  }

 private:
  double sum_ = 0.0, sum_sq_ = 0.0, change_sq_ = 0.0, farthest_ = 0.0;
  double count_ = 0.0, changes_ = 0.0;
};

}  // namespace

RimScene makeRimScene(const std::string& name, double noise, std::uint64_t seed) {
  RimScene scene;
  const std::array<double, 2> normal{std::cos(0.35), std::sin(0.35)};
  const auto half = [&](double x, double y) { return x * normal[0] + y * normal[1] < 0.0; };
  const auto disc = [](double x, double y) {
    const double radius = std::hypot(x, y);
    return radius < kDiscRadius && radius > kHoleRadius;
  };
  const auto strip = [](double x, double y) { return distanceToStrip(x, y) < kHalfStrip; };
  if (name == "half") {
    scene.points = samples(half, false, noise, seed);
    scene.rims = {line(normal)};
  } else if (name == "strip") {
    scene.points = samples(strip, false, noise, seed);
    scene.rims = {stripSide(1.0), stripSide(-1.0)};
  } else {
    scene.points = samples(disc, name == "grid", noise, seed);
    scene.rims = {circle(kDiscRadius, 1.0), circle(kHoleRadius, -1.0)};
  }
  return scene;
}

RimFigures measureRims(const RimScene& scene, const SLIMSurface& surface,
                       const RenderParams& params, bool reference) {
  GBuffer picture;
  if (drawFromAbove(surface, params, reference, picture)) return {};
  RimSums sums;
  for (const auto& rim : scene.rims) {
    std::vector<double> drawn;
    for (const RimPlace& place : rim) drawn.push_back(drawnRim(place, picture));
    sums.add(drawn);
  }
  return sums.figures();
}

}  // namespace pcl_slim::borders
