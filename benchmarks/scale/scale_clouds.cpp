// SPDX-License-Identifier: BSD-3-Clause
#include "scale/scale_clouds.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim {

namespace {

constexpr double kElongation = 2.2;  ///< of the body, along z
constexpr std::uint64_t kViews = 64;

std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

/** Radius of the body in a direction, over that of its ellipsoid. */
double bumps(const std::array<double, 3>& u) {
  const double coarse = 0.10 * std::sin(4 * u[0] + 1) * std::sin(5 * u[1] + 2) +
                        0.08 * std::cos(7 * u[2]) * std::sin(3 * u[0] - u[1]);
  const double side = 1 / (1 + std::exp(-12 * u[0]));
  const double fine = 0.0025 * std::sin(45 * u[1] + 9 * u[2]) * std::sin(60 * u[2] + 7 * u[0]);
  return 1 + coarse + side * fine;
}

/** A place outside [0, 1] mirrored into it. */
double reflected(double x) {
  const double turned = x - 2 * std::floor(x / 2);
  return turned > 1 ? 2 - turned : turned;
}

double terrain(double x, double y) {
  return 0.06 * std::sin(5 * x + 1) * std::cos(4 * y) + 0.02 * std::sin(17 * x - 11 * y) +
         0.003 * std::sin(61 * x) * std::sin(57 * y + x);
}

}  // namespace

double uniformAt(std::uint64_t i, std::uint64_t k) {
  return static_cast<double>(mix(mix(i) + k) >> 11) * 0x1p-53;
}

double gaussianAt(std::uint64_t i, std::uint64_t k) {
  const double u = std::max(uniformAt(i, 2 * k + 100), 1e-300), v = uniformAt(i, 2 * k + 101);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
}

std::array<double, 3> ScaleSurface::point(std::uint64_t i, std::uint64_t count) const {
  const std::uint64_t view = i * kViews / count;
  if (kind_ == Kind::kSheet) {
    // Each view looks at a patch about a place of its own, denser in its middle.
    const double x0 = uniformAt(view, 7), y0 = uniformAt(view, 8);
    double x = uniformAt(i, 0), y = uniformAt(i, 1);
    if (uniformAt(i, 2) < 0.6) {
      x = x0 + 0.35 * (uniformAt(i, 3) + x - 1);
      y = y0 + 0.35 * (uniformAt(i, 4) + y - 1);
    }
    x = reflected(x);
    y = reflected(y);
    return {x, y, terrain(x, y)};
  }
  double z = 2 * uniformAt(i, 0) - 1, turn = 2 * M_PI * uniformAt(i, 1);
  if (kind_ == Kind::kSkew && uniformAt(i, 5) < 0.6) {
    z = 1 - 0.2 * uniformAt(i, 0);
  } else if (uniformAt(i, 2) < 0.6) {  // towards this view
    z = std::clamp(2 * uniformAt(view, 7) - 1 + 0.5 * (uniformAt(i, 3) + uniformAt(i, 0) - 1), -1.0,
                   1.0);
    turn = 2 * M_PI * uniformAt(view, 8) + 1.2 * (uniformAt(i, 4) + uniformAt(i, 1) - 1);
  }
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  const std::array<double, 3> u{r * std::cos(turn), r * std::sin(turn), z};
  const double radius = bumps(u);
  return {radius * u[0], radius * u[1], kElongation * radius * u[2]};
}

/** 0 on the surface, positive outside. */
double ScaleSurface::height(const std::array<double, 3>& p) const {
  if (kind_ == Kind::kSheet) return p[2] - terrain(p[0], p[1]);
  const std::array<double, 3> q{p[0], p[1], p[2] / kElongation};
  const double length = std::hypot(q[0], q[1], q[2]);
  return length - bumps({q[0] / length, q[1] / length, q[2] / length});
}

std::array<double, 3> ScaleSurface::gradient(const std::array<double, 3>& p) const {
  constexpr double kStep = 1e-6;
  std::array<double, 3> g;
  for (std::size_t a = 0; a < 3; ++a) {
    auto low = p, high = p;
    low[a] -= kStep;
    high[a] += kStep;
    g[a] = (height(high) - height(low)) / (2 * kStep);
  }
  return g;
}

std::array<double, 3> ScaleSurface::normal(const std::array<double, 3>& p) const {
  auto n = gradient(p);
  const double length = std::hypot(n[0], n[1], n[2]);
  for (double& value : n) value /= length;
  return n;
}

double ScaleSurface::distance(const std::array<double, 3>& p) const {
  const auto g = gradient(p);
  return height(p) / std::hypot(g[0], g[1], g[2]);
}

bool ScaleSurface::isClump(const std::array<double, 3>& p) const {
  constexpr double kReach = 0.1;
  return kind_ != Kind::kSheet && std::hypot(p[0], p[1]) < kReach;
}

double ScaleSurface::diagonal() const {
  return kind_ == Kind::kSheet ? std::sqrt(2.03) : std::hypot(2.0, 2.0, 2 * kElongation);
}

}  // namespace pcl_slim
