// SPDX-License-Identifier: BSD-3-Clause
#include "support/lab/scenes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "pcl_slim/core/symmetric.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::measure {

namespace {

using Point = std::array<double, 3>;
constexpr double kTorusMajor = 1.0, kTorusMinor = 0.4;

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point normalized(const Point& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

/** Value, gradient and Hessian of an implicit function F, F > 0 outside. */
struct Implicit {
  double f;
  Point g;
  Symmetric3<double> h;
};

Implicit sphere(const Point& p) {
  const double r = std::sqrt(dot(p, p));
  const Point d = {p[0] / r, p[1] / r, p[2] / r};
  const double k = 1.0 / r;
  return {r - 1.0,
          d,
          {k * (1 - d[0] * d[0]), -k * d[0] * d[1], -k * d[0] * d[2], k * (1 - d[1] * d[1]),
           -k * d[1] * d[2], k * (1 - d[2] * d[2])}};
}

/** F = (sqrt(x^2 + y^2) - R)^2 + z^2 - r^2. */
Implicit torus(const Point& p) {
  const double rho = std::hypot(p[0], p[1]), a = rho - kTorusMajor;
  const double c = p[0] / rho, s = p[1] / rho;
  const double tangent = 2 * a / rho;
  return {
      a * a + p[2] * p[2] - kTorusMinor * kTorusMinor,
      {2 * a * c, 2 * a * s, 2 * p[2]},
      {2 * c * c + tangent * s * s, (2 - tangent) * c * s, 0, 2 * s * s + tangent * c * c, 0, 2}};
}

/** F = |p| - 1 - 0.1 B(p / |p|), B = sin 5x sin 5y cos 5z on the unit direction. */
Implicit bumpy(const Point& p) {
  const double r = std::sqrt(dot(p, p));
  const Point d = {p[0] / r, p[1] / r, p[2] / r};
  const double sx = std::sin(5 * d[0]), cx = std::cos(5 * d[0]);
  const double sy = std::sin(5 * d[1]), cy = std::cos(5 * d[1]);
  const double sz = std::sin(5 * d[2]), cz = std::cos(5 * d[2]);
  const double b = sx * sy * cz;
  const Point e = {5 * cx * sy * cz, 5 * sx * cy * cz, -5 * sx * sy * sz};
  const double m[3][3] = {{-25 * b, 25 * cx * cy * cz, -25 * cx * sy * sz},
                          {25 * cx * cy * cz, -25 * b, -25 * sx * cy * sz},
                          {-25 * cx * sy * sz, -25 * sx * cy * sz, -25 * b}};
  // Chain rule through the direction: J = (I - d d^T) / r.
  const double de = dot(d, e);
  Point me{}, g;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) me[i] += m[i][j] * d[j];
    g[i] = d[i] - 0.1 * (e[i] - de * d[i]) / r;
  }
  const double dmd = dot(d, me);
  Symmetric3<double> h{};
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const double delta = i == j ? 1.0 : 0.0;
      const double projected = m[i][j] - me[i] * d[j] - d[i] * me[j] + dmd * d[i] * d[j];
      const double bent = e[i] * d[j] + d[i] * e[j] - 3 * de * d[i] * d[j] + de * delta;
      h[kSymmetricEntry[i][j]] = (delta - d[i] * d[j]) / r - 0.1 * (projected - bent) / (r * r);
    }
  }
  return {r - 1.0 - 0.1 * b, g, h};
}

/** A C4 step from 0 at a to 1 at b, with its first two derivatives. */
std::array<double, 3> smoothStep(double x, double a, double b) {
  const double t = (x - a) / (b - a), w = b - a, r = 1 - t;
  if (t <= 0) return {0, 0, 0};
  if (t >= 1) return {1, 0, 0};
  const double t4 = t * t * t * t;
  return {t4 * t * (126 - 420 * t + 540 * t * t - 315 * t * t * t + 70 * t4),
          630 * t4 * r * r * r * r / w, 2520 * t * t * t * r * r * r * (1 - 2 * t) / (w * w)};
}

/** F = z - h(x, y): flat left, waves in the middle, fine waves on the right. The zones meet in
 * C4 steps, smooth enough for quartic fits to show their order. */
Implicit relief(const Point& p) {
  const double x = p[0], y = p[1];
  const auto coarse = smoothStep(x, -0.5, 0.1), fine = smoothStep(x, 0.3, 0.7);
  double h = 0, hx = 0, hy = 0, hxx = 0, hxy = 0, hyy = 0;
  const auto addWave = [&](const std::array<double, 3>& s, double amplitude, double k) {
    const double sx = std::sin(k * x), cx = std::cos(k * x), sy = std::sin(k * y),
                 cy = std::cos(k * y);
    h += amplitude * s[0] * sx * sy;
    hx += amplitude * (s[1] * sx + s[0] * k * cx) * sy;
    hy += amplitude * s[0] * sx * k * cy;
    hxx += amplitude * (s[2] * sx + 2 * s[1] * k * cx - s[0] * k * k * sx) * sy;
    hxy += amplitude * (s[1] * sx + s[0] * k * cx) * k * cy;
    hyy -= amplitude * s[0] * sx * k * k * sy;
  };
  addWave(coarse, 0.1, 4);
  addWave(fine, 0.015, 30);
  return {p[2] - h, {-hx, -hy, 1}, {-hxx, -hxy, 0, -hyy, 0, 0}};
}

Implicit evaluate(Shape shape, const Point& p) {
  switch (shape) {
    case Shape::kSphere: return sphere(p);
    case Shape::kTorus: return torus(p);
    case Shape::kBumpy: return bumpy(p);
    default: return relief(p);
  }
}

double meanCurvature(const Implicit& i) {
  const double g_sq = dot(i.g, i.g), g = std::sqrt(g_sq);
  const double trace = i.h[kXX] + i.h[kYY] + i.h[kZZ];
  const double ghg = i.g[0] * (i.h[kXX] * i.g[0] + 2 * i.h[kXY] * i.g[1] + 2 * i.h[kXZ] * i.g[2]) +
                     i.g[1] * (i.h[kYY] * i.g[1] + 2 * i.h[kYZ] * i.g[2]) +
                     i.h[kZZ] * i.g[2] * i.g[2];
  return (trace - ghg / g_sq) / (2 * g);
}

/** A point of the surface by rejection, so that density is even over the area. */
Point samplePoint(Shape shape, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  for (;;) {
    if (shape == Shape::kRelief) {
      Point p = {2 * unit(rng) - 1, 2 * unit(rng) - 1, 0};
      p[2] = -relief(p).f;
      const Implicit i = relief(p);
      if (unit(rng) * 1.5 < std::sqrt(dot(i.g, i.g))) return p;
    } else if (shape == Shape::kTorus) {
      const double a = 2 * M_PI * unit(rng), b = 2 * M_PI * unit(rng);
      const double rho = kTorusMajor + kTorusMinor * std::cos(b);
      if (unit(rng) * (kTorusMajor + kTorusMinor) > rho) continue;
      return {rho * std::cos(a), rho * std::sin(a), kTorusMinor * std::sin(b)};
    } else {
      Point d = normalized({gauss(rng), gauss(rng), gauss(rng)});
      if (shape == Shape::kSphere) return d;
      const double r = 1 - bumpy(d).f;
      const Point p = {r * d[0], r * d[1], r * d[2]};
      const Implicit i = bumpy(p);
      // Area per direction: r^2 / (n . d).
      const double area = r * r * std::sqrt(dot(i.g, i.g)) / dot(i.g, d);
      if (unit(rng) * 1.6 < area) return p;
    }
  }
}

}  // namespace

bool parseShape(const std::string& name, Shape& shape) {
  static const std::pair<const char*, Shape> kNames[] = {{"sphere", Shape::kSphere},
                                                         {"torus", Shape::kTorus},
                                                         {"bumpy", Shape::kBumpy},
                                                         {"relief", Shape::kRelief}};
  for (const auto& [known, value] : kNames) {
    if (name == known) {
      shape = value;
      return true;
    }
  }
  return false;
}

Scene makeScene(Shape shape, std::size_t count, double noise, double normal_noise,
                std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss;
  Scene scene;
  scene.points.resize(3 * count);
  scene.normals.resize(3 * count);
  Bounds box;
  for (std::size_t i = 0; i < count; ++i) {
    const Point p = samplePoint(shape, rng);
    Point n = normalized(evaluate(shape, p).g);
    box.add(p);
    for (int a = 0; a < 3; ++a) scene.points[3 * i + a] = p[a];
    n = normalized({n[0] + normal_noise * gauss(rng), n[1] + normal_noise * gauss(rng),
                    n[2] + normal_noise * gauss(rng)});
    for (int a = 0; a < 3; ++a) scene.normals[3 * i + a] = static_cast<float>(n[a]);
  }
  scene.diagonal = box.diagonal();
  for (double& value : scene.points) value += noise * scene.diagonal * gauss(rng);
  return scene;
}

Truth truthAt(Shape shape, const Point& point) {
  Point p = point;
  Implicit i = evaluate(shape, p);
  // Orthogonal foot: Newton steps along the gradient, corrected to stay below the point.
  for (int step = 0; step < 20; ++step) {
    const double g_sq = dot(i.g, i.g);
    const Point offset = {point[0] - p[0], point[1] - p[1], point[2] - p[2]};
    const double along = dot(offset, i.g) / g_sq;
    Point next;
    for (int a = 0; a < 3; ++a) {
      const double tangential = offset[a] - along * i.g[a];
      next[a] = p[a] - i.f / g_sq * i.g[a] + tangential;
    }
    p = next;
    i = evaluate(shape, p);
  }
  Truth truth;
  truth.normal = normalized(i.g);
  const Point offset = {point[0] - p[0], point[1] - p[1], point[2] - p[2]};
  truth.distance = dot(offset, truth.normal);
  truth.mean_curvature = meanCurvature(i);
  truth.rim = shape == Shape::kRelief && std::max(std::abs(p[0]), std::abs(p[1])) > 0.98;
  return truth;
}

CloudView viewOf(const Scene& scene, const std::vector<float>* floats, bool normals) {
  CloudView view;
  view.xyz = floats ? static_cast<const void*>(floats->data()) : scene.points.data();
  view.scalar = floats ? CloudView::Scalar::kFloat : CloudView::Scalar::kDouble;
  view.xyz_stride = 3 * (floats ? sizeof(float) : sizeof(double));
  view.size = scene.points.size() / 3;
  if (normals) {
    view.normal = scene.normals.data();
    view.normal_stride = 3 * sizeof(float);
  }
  return view;
}

}  // namespace pcl_slim::measure
