// SPDX-License-Identifier: BSD-3-Clause
#include "thin/thin_scenes.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

namespace pcl_slim::thin {

namespace {

constexpr double kSphere = 20;  ///< radius of the outer sphere
constexpr double kEdge = 60;    ///< length of a wedge's sides and edge
constexpr double kGolden = 0.6180339887498949;

std::string named(const std::string& name, double size) {
  char text[64];
  std::snprintf(text, sizeof(text), "%s %g", name.c_str(), size);
  return text;
}

/** Adds an evenly filled rectangle: a rank-1 lattice of density 1. */
void addRectangle(Scene& scene, const Vector3& corner, const Vector3& a, const Vector3& b,
                  const Vector3& normal, double shift) {
  const auto count = static_cast<std::size_t>(length(a) * length(b));
  for (std::size_t i = 0; i < count; ++i) {
    const double s = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double t = std::fmod(static_cast<double>(i) * kGolden + shift, 1.0);
    scene.points.push_back(along(along(corner, s, a), t, b));
    scene.normals.push_back(normal);
  }
}

/** Adds a sphere of density 1 (a Fibonacci lattice), facing out or in. */
void addSphere(Scene& scene, const Vector3& middle, double radius, double facing) {
  const auto count = static_cast<std::size_t>(4 * M_PI * radius * radius);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double turn = 2 * M_PI * kGolden * static_cast<double>(i), r = std::sqrt(1 - z * z);
    const Vector3 n = {r * std::cos(turn), r * std::sin(turn), z};
    scene.points.push_back(along(middle, radius, n));
    scene.normals.push_back(scaled(n, facing));
  }
}

/** Adds the wall of a cylinder about the z axis. */
void addWall(Scene& scene, double radius, double height) {
  const auto count = static_cast<std::size_t>(2 * M_PI * radius * height);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = height * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double turn = 2 * M_PI * kGolden * static_cast<double>(i);
    const Vector3 n = {std::cos(turn), std::sin(turn), 0};
    scene.points.push_back({radius * n[0], radius * n[1], z});
    scene.normals.push_back(n);
  }
}

double toSphere(const Vector3& p, const Vector3& middle, double radius) {
  return std::abs(length(subtract(p, middle)) - radius);
}

}  // namespace

Scene plates(double gap, double edge) {
  Scene scene{named("plates", gap), {}, {}, {}, {}};
  addRectangle(scene, {0, 0, gap / 2}, {edge, 0, 0}, {0, edge, 0}, {0, 0, 1}, 0.1);
  addRectangle(scene, {0, 0, -gap / 2}, {0, edge, 0}, {edge, 0, 0}, {0, 0, -1}, 0.35);
  scene.distance = [gap](const Vector3& p) { return std::abs(std::abs(p[2]) - gap / 2); };
  scene.thickness = [gap](const Vector3&) { return gap; };
  return scene;
}

Scene tube(double radius, double height) {
  Scene scene{named("tube", radius), {}, {}, {}, {}};
  addWall(scene, radius, height);
  scene.distance = [radius](const Vector3& p) { return std::abs(std::hypot(p[0], p[1]) - radius); };
  scene.thickness = [radius](const Vector3&) { return 2 * radius; };
  return scene;
}

Scene nestedSpheres(double gap) {
  Scene scene{named("nested", gap), {}, {}, {}, {}};
  addSphere(scene, {}, kSphere, 1);
  addSphere(scene, {}, kSphere - gap, -1);
  scene.distance = [gap](const Vector3& p) {
    return std::min(toSphere(p, {}, kSphere), toSphere(p, {}, kSphere - gap));
  };
  scene.thickness = [gap](const Vector3&) { return gap; };
  return scene;
}

Scene touchingSpheres() {
  const Vector3 left = {-kSphere, 0, 0}, right = {kSphere, 0, 0};
  Scene scene{"touching", {}, {}, {}, {}};
  addSphere(scene, left, kSphere, 1);
  addSphere(scene, right, kSphere, 1);
  scene.distance = [left, right](const Vector3& p) {
    return std::min(toSphere(p, left, kSphere), toSphere(p, right, kSphere));
  };
  scene.thickness = [left, right](const Vector3& p) {
    return std::max(toSphere(p, left, kSphere), toSphere(p, right, kSphere));
  };
  return scene;
}

Scene wedge(double degrees) {
  const double half = degrees * M_PI / 360;
  Scene scene{named("wedge", degrees), {}, {}, {}, {}};
  for (const double side : {1.0, -1.0}) {
    const Vector3 up = {kEdge * std::cos(half), 0, side * kEdge * std::sin(half)};
    const Vector3 normal = {-std::sin(half), 0, side * std::cos(half)};
    addRectangle(scene, {}, up, {0, kEdge, 0}, normal, 0.2 + 0.3 * side);
  }
  scene.distance = [half](const Vector3& p) {
    const double along = p[0] * std::cos(half) + std::abs(p[2]) * std::sin(half);
    if (along < 0) return std::hypot(p[0], p[2]);
    return std::abs(std::abs(p[2]) * std::cos(half) - p[0] * std::sin(half));
  };
  scene.thickness = [half](const Vector3& p) {
    return std::hypot(p[0], p[2]) * std::sin(2 * half);
  };
  return scene;
}

Scene pole(double radius) {
  constexpr double kHeight = 80;
  Scene scene{named("pole", radius), {}, {}, {}, {}};
  addRectangle(scene, {-kEdge / 2, -kEdge / 2, 0}, {kEdge, 0, 0}, {0, kEdge, 0}, {0, 0, 1}, 0.3);
  addWall(scene, radius, kHeight);
  scene.distance = [radius](const Vector3& p) {
    const double wall = std::hypot(std::hypot(p[0], p[1]) - radius, std::min(0.0, p[2]));
    return std::min(wall, std::abs(p[2]));
  };
  scene.thickness = [radius](const Vector3& p) {
    const double out =
        std::hypot(p[0], p[1]) - radius;  // 0 on the wall, whose foot meets the plane
    return out > 1e-6 ? out : std::min(2 * radius, p[2]);
  };
  return scene;
}

Scene turned(Scene scene) {
  const Vector3 u = normalized({2, -1, 3}), v = normalized(cross(u, {1, 5, -2})), w = cross(u, v);
  for (auto* vectors : {&scene.points, &scene.normals}) {
    for (Vector3& p : *vectors) p = along(along(scaled(u, p[0]), p[1], v), p[2], w);
  }
  for (auto* measure : {&scene.distance, &scene.thickness}) {
    *measure = [u, v, w, straight = *measure](const Vector3& p) {
      return straight({dot(p, u), dot(p, v), dot(p, w)});
    };
  }
  return scene;
}

std::vector<Scene> allScenes() {
  std::vector<Scene> scenes;
  for (const double gap : {0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 35.0})
    scenes.push_back(plates(gap));
  for (const double radius : {1.0, 2.0, 4.0, 8.0}) scenes.push_back(tube(radius));
  for (const double gap : {1.0, 2.0, 3.0}) scenes.push_back(nestedSpheres(gap));
  scenes.push_back(touchingSpheres());
  for (const double degrees : {10.0, 30.0, 60.0}) scenes.push_back(wedge(degrees));
  for (const double radius : {1.0, 2.0}) scenes.push_back(pole(radius));
  for (Scene& scene : scenes) scene = turned(std::move(scene));
  return scenes;
}

std::vector<Vector3> noisyPoints(const Scene& scene, double sigma, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> gauss(0, sigma > 0 ? sigma : 1);
  std::vector<Vector3> points = scene.points;
  if (!(sigma > 0)) return points;
  for (Vector3& p : points) {
    for (double& x : p) x += gauss(rng);
  }
  return points;
}

}  // namespace pcl_slim::thin
