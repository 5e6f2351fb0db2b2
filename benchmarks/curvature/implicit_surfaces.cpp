// SPDX-License-Identifier: BSD-3-Clause
#include "curvature/implicit_surfaces.h"

#include <algorithm>
#include <random>

namespace pcl_slim::curvature {

namespace {

using measure::Jet;

Jet square(const Jet& a) {
  return a * a;
}

Jet gaussian(const Jet& distance_sq, double width) {
  const double s = -1 / (width * width), e = std::exp(s * distance_sq.value);
  return measure::applied(distance_sq, e, s * e, s * s * e);
}

Jet sphere(const Jet& x, const Jet& y, const Jet& z) {
  return square(x) + square(y) + square(z) - 0.81;
}

Jet ellipsoid(const Jet& x, const Jet& y, const Jet& z) {
  return square(x * (1 / 0.95)) + square(y * (1 / 0.7)) + square(z * 2) - 1;
}

Jet torus(const Jet& x, const Jet& y, const Jet& z) {
  return square(sqrt(square(x) + square(y)) - 0.65) + square(z) - 0.09;
}

Jet cylinder(const Jet& x, const Jet& y, const Jet& z) {
  const Jet radial = (square(x) + square(y)) * (1 / 0.36);
  return square(square(radial)) + square(square(square(z * (1 / 0.9)))) - 1;
}

Jet goursat(const Jet& x, const Jet& y, const Jet& z) {
  return 3 * (square(square(x)) + square(square(y)) + square(square(z))) -
         2 * (square(x) + square(y) + square(z)) - 0.08;
}

Jet genus2(const Jet& x, const Jet& y, const Jet& z) {
  return square(square(square(x)) - square(x) + square(y)) + square(z) - 0.03;
}

Jet tangle(const Jet& x, const Jet& y, const Jet& z) {
  Jet sum(11.8);
  for (const Jet& a : {x, y, z}) {
    const Jet b = square(2.4 * a);
    sum = sum + square(b) - 5 * b;
  }
  return sum;
}

Jet blobs(const Jet& x, const Jet& y, const Jet& z) {
  constexpr double kCentres[][3] = {
      {0, 0, 0}, {0.5, 0.2, 0}, {-0.4, 0.3, 0.2}, {0, -0.5, -0.2}, {-0.1, 0.1, 0.6}};
  Jet sum(0.5);
  for (const auto& c : kCentres) {
    sum = sum - gaussian(square(x - c[0]) + square(y - c[1]) + square(z - c[2]), 0.32);
  }
  return sum;
}

Jet bumpy(const Jet& x, const Jet& y, const Jet& z) {
  return sqrt(square(x) + square(y) + square(z)) - 0.8 -
         0.06 * sin(7 * x) * sin(7 * y) * cos(7 * z);
}

Jet valueAt(const ImplicitSurface& surface, const Vector3& p) {
  return surface.value(Jet::variable(p[0], 0), Jet::variable(p[1], 1), Jet::variable(p[2], 2));
}

/** Of the level set through a point: from the Hessian's trace and the adjugate's form. */
Differential differentialOf(const Jet& f) {
  const Vector3& g = f.g;
  const auto& h = f.h;  // xx xy xz yy yz zz
  const double norm = length(g), norm_sq = norm * norm;
  const auto form = [&g](const std::array<double, 6>& m) {
    return m[0] * g[0] * g[0] + m[3] * g[1] * g[1] + m[5] * g[2] * g[2] +
           2 * (m[1] * g[0] * g[1] + m[2] * g[0] * g[2] + m[4] * g[1] * g[2]);
  };
  const std::array<double, 6> adjugate = {h[3] * h[5] - h[4] * h[4], h[2] * h[4] - h[1] * h[5],
                                          h[1] * h[4] - h[2] * h[3], h[0] * h[5] - h[2] * h[2],
                                          h[1] * h[2] - h[0] * h[4], h[0] * h[3] - h[1] * h[1]};
  return {scaled(g, 1 / norm), (h[0] + h[3] + h[5] - form(h) / norm_sq) / (2 * norm),
          form(adjugate) / (norm_sq * norm_sq)};
}

}  // namespace

const std::vector<ImplicitSurface>& implicitSurfaces() {
  static const std::vector<ImplicitSurface> kSurfaces = {
      {"sphere", sphere},     {"ellipsoid", ellipsoid}, {"torus", torus},
      {"cylinder", cylinder}, {"goursat", goursat},     {"genus2", genus2},
      {"tangle", tangle},     {"blobs", blobs},         {"bumpy", bumpy}};
  return kSurfaces;
}

double Differential::k1() const {
  return mean + std::sqrt(std::max(0.0, mean * mean - gaussian));
}

SurfaceSample sampleSurface(const ImplicitSurface& surface, std::size_t count, std::uint64_t seed) {
  // A shell of equal thickness on both sides has the same volume over equal areas.
  constexpr double kShell = 0.01, kReach = 1.2;
  constexpr int kSteps = 6;
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> along_axis(-kReach, kReach);
  SurfaceSample sample;
  while (sample.points.size() < count) {
    Vector3 p = {along_axis(rng), along_axis(rng), along_axis(rng)};
    Jet f = valueAt(surface, p);
    if (std::abs(f.value) > kShell * length(f.g)) continue;
    for (int step = 0; step < kSteps; ++step) {
      p = along(p, -f.value / dot(f.g, f.g), f.g);
      f = valueAt(surface, p);
    }
    sample.points.push_back(p);
    sample.truth.push_back(differentialOf(f));
  }
  return sample;
}

}  // namespace pcl_slim::curvature
