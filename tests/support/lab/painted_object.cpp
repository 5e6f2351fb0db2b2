// SPDX-License-Identifier: BSD-3-Clause
#include "support/lab/painted_object.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_slim::measure {
namespace {

using Eigen::Vector3d;

constexpr double kEye = 0.095, kIris = 0.062, kPupil = 0.036, kHighlight = 0.013;

/** A rise of the surface around a direction. */
struct Bump {
  Vector3d direction;
  double height, width;

  double at(const Vector3d& d) const {
    return height * std::exp((d.dot(direction) - 1.0) / (width * width));
  }
};

const Bump kHead{Vector3d(0.62, 0.0, 0.78).normalized(), 0.62, 0.36};
const Bump kBill{Vector3d(0.83, 0.0, 0.56).normalized(), 0.30, 0.12};
const Bump kTail{Vector3d(-0.93, 0.0, 0.37).normalized(), 0.30, 0.20};
const Bump kFeathers{Vector3d(-0.78, 0.0, 0.62).normalized(), 0.013, 0.45};

/** Distance from the origin to the surface along a unit direction. */
double reach(const Vector3d& d) {
  const Vector3d body = d.cwiseQuotient(Vector3d(0.95, 0.72, 0.55));
  const double ripples = std::sin(46.0 * (d.z() - 0.3 * d.x()) + 3.0 * std::cos(12.0 * d.y()));
  return 1.0 / body.norm() + kHead.at(d) + kBill.at(d) + kTail.at(d) + kFeathers.at(d) * ripples;
}

/** Unit outward normal of |p| = reach(p / |p|), by differences: exact to 1e-9. */
Vector3d normalAt(const Vector3d& p) {
  const double step = 1e-5;
  Vector3d gradient;
  for (int a = 0; a < 3; ++a) {
    Vector3d low = p, high = p;
    low[a] -= step;
    high[a] += step;
    gradient[a] = (high.norm() - reach(high.normalized())) - (low.norm() - reach(low.normalized()));
  }
  return gradient.normalized();
}

Vector3d eyeMiddle(double side) {
  const Vector3d d = Vector3d(0.60, 0.30 * side, 0.70).normalized();
  return reach(d) * d;
}

/** Colour of the nearer eye, or -1 beside it. */
std::int64_t eyeColor(const Vector3d& p) {
  const Vector3d middle = eyeMiddle(p.y() < 0.0 ? -1.0 : 1.0);
  const double distance = (p - middle).norm();
  if (distance >= kEye) return -1;
  if ((p - middle - Vector3d(0.012, 0.0, 0.022)).norm() < kHighlight + 0.004) return 0xffffff;
  return distance < kPupil ? 0x101014 : distance < kIris ? 0x2f7fd0 : 0xf8f8f4;
}

std::uint32_t mixed(std::uint32_t a, std::uint32_t b, double share) {
  std::uint32_t color = 0;
  for (int shift = 0; shift <= 16; shift += 8) {
    const double x = a >> shift & 255u, y = b >> shift & 255u;
    color |= static_cast<std::uint32_t>(std::lround(x + share * (y - x))) << shift;
  }
  return color;
}

std::uint32_t paintAt(const Vector3d& p) {
  const Vector3d d = p.normalized();
  const std::int64_t eye = eyeColor(p);
  if (eye >= 0) return static_cast<std::uint32_t>(eye);
  if (d.dot(kBill.direction) > std::cos(0.17)) return 0xe8641c;
  // Aslant and wavy, as stripes along an axis would coincide with the faces of the octree's cells.
  const bool on_back = d.dot(kHead.direction) < std::cos(0.75) && d.z() > -0.25;
  const double across = 0.78 * p.x() + 0.31 * p.y() - 0.54 * p.z() + 0.03 * std::sin(9.0 * p.y());
  if (on_back && std::fmod(across + 4.0, 0.22) < 0.08) return 0x8a3b1e;
  const double belly = std::clamp((-d.z() - 0.15) / 0.6, 0.0, 1.0);
  return mixed(0xf0c03c, 0xfff3d8, belly);
}

}  // namespace

PaintedObject paintDuck(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  // Area per solid angle is reach^2 over the cosine between ray and normal; 6 bounds it.
  constexpr double kMostArea = 6.0;
  PaintedObject object;
  while (object.rgb.size() < count) {
    const Vector3d d = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const double r = reach(d);
    const Vector3d p = r * d, n = normalAt(p);
    if (uniform(random) * kMostArea > r * r / std::max(0.05, n.dot(d))) continue;
    for (int a = 0; a < 3; ++a) {
      object.xyz.push_back(static_cast<float>(p[a]));
      object.normals.push_back(static_cast<float>(n[a]));
    }
    object.rgb.push_back(paintAt(p));
  }
  return object;
}

std::array<double, 3> duckEye() {
  const Vector3d p = eyeMiddle(-1.0);
  return {p.x(), p.y(), p.z()};
}

}  // namespace pcl_slim::measure
