// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <random>

#include "measure/line_truth.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::measure {

namespace {

constexpr double kTau = 2 * M_PI;
constexpr double kMajor = 1.0, kMinor = 0.4, kWaves = 0.04;
constexpr std::size_t kAreaCells = 1000;

/** A unit direction; the poles and the seam are on no plane of symmetry. */
Vector3
direction(double u, double v)
{
  const double z = 1 - 2 * v, r = std::sqrt(std::max(0.0, 1 - z * z));
  const Vector3 d = {r * std::cos(kTau * u), r * std::sin(kTau * u), z};
  static const Vector3 a = normalized({0.61, 0.53, 0.59});
  static const Vector3 b = normalized(cross(a, {0.2, -0.9, 0.31}));
  static const Vector3 c = cross(a, b);
  return {dot(d, a), dot(d, b), dot(d, c)};
}

LineSurface
starShaped(std::function<double(const Vector3&)> radius,
           std::function<Jet(const Jet&, const Jet&, const Jet&)> implicit)
{
  return {[radius = std::move(radius)](double u, double v) {
            const Vector3 d = direction(u, v);
            return scaled(d, radius(d));
          },
          std::move(implicit)};
}

LineSurface
torusWithWaves(double waves)
{
  const auto map = [waves](double u, double v) {
    const double a = kTau * (u + 0.0137), b = kTau * (v + 0.0219);
    const double r = kMinor * (1 + waves * std::cos(6 * a) * std::cos(3 * b));
    const double rho = kMajor + r * std::cos(b);
    return Vector3{rho * std::cos(a), rho * std::sin(a), r * std::sin(b)};
  };
  const auto implicit = [waves](const Jet& x, const Jet& y, const Jet& z) {
    const Jet rho = sqrt(x * x + y * y) - kMajor;
    const Jet wave = cos(6.0 * atan2(y, x)) * cos(3.0 * atan2(z, rho));
    return sqrt(rho * rho + z * z) - kMinor * (1.0 + waves * wave);
  };
  return {map, implicit};
}

/** Bumps of a sphere: a height and a frequency each. */
struct Bumps {
  double height, frequency;
};

LineSurface
bumpySphere(const std::vector<Bumps>& all)
{
  return starShaped(
      [all](const Vector3& d) {
        double r = 1;
        for (const auto& [h, f] : all)
          r += h * std::sin(f * d[0]) * std::sin(f * d[1]) * std::cos(f * d[2]);
        return r;
      },
      [all](const Jet& x, const Jet& y, const Jet& z) {
        const Jet r = sqrt(x * x + y * y + z * z), inverse = pow(r, -1);
        Jet value = r - 1.0;
        for (const auto& [h, f] : all) {
          const Jet a = x * inverse * f, b = y * inverse * f, c = z * inverse * f;
          value = value - h * sin(a) * sin(b) * cos(c);
        }
        return value;
      });
}

Vector3
derivative(const LineSurface& s, double u, double v, bool by_u)
{
  constexpr double kStep = 1e-5;
  const double a = by_u ? kStep : 0, b = by_u ? 0 : kStep;
  return scaled(subtract(s.map(u + a, v + b), s.map(u - a, v - b)), 0.5 / kStep);
}

double
areaElement(const LineSurface& s, double u, double v)
{
  v = std::clamp(v, 1e-4, 1 - 1e-4);
  return length(cross(derivative(s, u, v, true), derivative(s, u, v, false)));
}

}  // namespace

bool
parseLineSurface(const std::string& name, LineSurface& surface)
{
  if (name == "sphere") {
    surface = starShaped(
        [](const Vector3&) { return 1.0; },
        [](const Jet& x, const Jet& y, const Jet& z) { return sqrt(x * x + y * y + z * z) - 1.0; });
  } else if (name == "ellipsoid") {
    surface = starShaped(
        [](const Vector3& d) {
          return 1 / std::sqrt(d[0] * d[0] + d[1] * d[1] / 0.64 + d[2] * d[2] / 0.25);
        },
        [](const Jet& x, const Jet& y, const Jet& z) {
          return x * x + y * y * (1 / 0.64) + z * z * 4.0 - 1.0;
        });
  } else if (name == "box") {
    surface = starShaped(
        [](const Vector3& d) {
          return std::pow(std::pow(d[0], 10) + std::pow(d[1], 10) + std::pow(d[2], 10), -0.1);
        },
        [](const Jet& x, const Jet& y, const Jet& z) {
          return pow(x * x, 5) + pow(y * y, 5) + pow(z * z, 5) - 1.0;
        });
  } else if (name == "bumpy") {
    surface = bumpySphere({{0.1, 5}});
  } else if (name == "mix") {
    surface = bumpySphere({{0.1, 2.5}, {0.004, 20}});
  } else if (name == "torus" || name == "wtorus") {
    surface = torusWithWaves(name == "torus" ? 0.0 : kWaves);
  } else {
    return false;
  }
  return true;
}

double
areaOf(const LineSurface& surface)
{
  double sum = 0;
  for (std::size_t i = 0; i < kAreaCells; ++i) {
    for (std::size_t j = 0; j < kAreaCells; ++j) {
      sum += areaElement(surface, (static_cast<double>(i) + 0.5) / kAreaCells,
                         (static_cast<double>(j) + 0.5) / kAreaCells);
    }
  }
  return sum / (kAreaCells * kAreaCells);
}

Scene
sampleSurface(const LineSurface& surface, std::size_t count, double noise, double normal_noise,
              std::uint64_t seed)
{
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  double most = 0;
  for (int i = 0; i < 20000; ++i) most = std::max(most, areaElement(surface, unit(rng), unit(rng)));
  most *= 1.05;
  Scene scene;
  Bounds box;
  while (scene.points.size() < 3 * count) {
    const double u = unit(rng), v = unit(rng);
    if (unit(rng) * most > areaElement(surface, u, v)) continue;
    const ExactCrest at = exactCrest(surface, u, v, false);
    Vector3 n = at.normal;
    box.add(at.position);
    for (std::size_t a = 0; a < 3; ++a) {
      scene.points.push_back(at.position[a]);
      n[a] += normal_noise * gauss(rng);
    }
    n = normalized(n);
    for (const double value : n) scene.normals.push_back(static_cast<float>(value));
  }
  scene.diagonal = box.diagonal();
  for (double& value : scene.points) value += noise * scene.diagonal * gauss(rng);
  return scene;
}

}  // namespace pcl_slim::measure
