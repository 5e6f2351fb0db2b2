// SPDX-License-Identifier: BSD-3-Clause
#include "sides/bodies.h"

#include <algorithm>
#include <cmath>

namespace pcl_slim::sides {

namespace {

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vector3 withNoise(Vector3 p, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  for (double& x : p) x += noise * gauss(random);
  return p;
}

/** The lesser of two values, rounded where they differ by less than the width. */
double smoothLeast(double a, double b, double width) {
  const double h = std::max(0.0, width - std::abs(a - b)) / width;
  return std::min(a, b) - 0.25 * h * h * width;
}

double smoothMost(double a, double b, double width) {
  return -smoothLeast(-a, -b, width);
}

constexpr double kJarHalf = 0.2, kJarWall = 0.012, kJarRounding = 0.006, kJarSeen = 0.06;

/** About the distance from a jar's side. */
double jarSide(const Vector3& p) {
  const double belly = (p[2] + 0.03) / 0.11, lip = (p[2] - 0.2) / 0.04;
  const double radius = 0.05 + 0.09 * std::exp(-belly * belly) + 0.02 * std::exp(-lip * lip);
  return 0.75 * (std::hypot(p[0], p[1]) - radius);
}

double filledJar(const Vector3& p) {
  return smoothMost(jarSide(p), std::abs(p[2]) - kJarHalf, kJarRounding);
}

double hollowJar(const Vector3& p) {
  const double cavity = std::max(jarSide(p) + kJarWall, 0.015 - kJarHalf - p[2]);
  return smoothMost(filledJar(p), -cavity, kJarRounding);
}

/** About the distance from an ellipsoid. */
double ellipsoid(const Vector3& p, const Vector3& axes) {
  const Vector3 q = {p[0] / axes[0], p[1] / axes[1], p[2] / axes[2]};
  const double k = length(q);
  const double slope = length({q[0] / axes[0], q[1] / axes[1], q[2] / axes[2]});
  return slope > 0 ? k * (k - 1) / slope : -axes[0];
}

double headAt(const Vector3& p) {
  const double skull = ellipsoid(p, {0.075, 0.11, 0.095});
  const double nose = ellipsoid(subtract(p, {0, -0.015, 0.1}), {0.014, 0.03, 0.025});
  const double ears = ellipsoid({std::abs(p[0]) - 0.077, p[1] + 0.005, p[2]}, {0.012, 0.03, 0.018});
  const double neck =
      smoothMost(0.9 * (std::hypot(p[0], p[2] + 0.02) - 0.05), std::abs(p[1] + 0.12) - 0.07, 0.02);
  const double face = smoothLeast(smoothLeast(skull, nose, 0.015), ears, 0.012);
  return smoothLeast(face, neck, 0.03);
}

Vector3 gradient(const Body& body, const Vector3& p, double step) {
  Vector3 g;
  for (std::size_t a = 0; a < 3; ++a) {
    Vector3 low = p, high = p;
    low[a] -= step;
    high[a] += step;
    g[a] = (body.distance(high) - body.distance(low)) / (2 * step);
  }
  return g;
}

}  // namespace

Body openJar() {
  const auto seen = [](const Vector3& p, const Vector3& n) {
    const bool inner = p[0] * n[0] + p[1] * n[1] < 0 && jarSide(p) < -0.3 * kJarWall;
    return !inner || p[2] > kJarHalf - kJarSeen;
  };
  const auto above_floor = [seen](const Vector3& p, const Vector3& n) {
    const bool inner_floor = n[2] > 0.5 && jarSide(p) < -0.9 * kJarWall && p[2] < 0;
    return !inner_floor && seen(p, n);
  };
  return {hollowJar, {{-0.2, -0.2, -0.22}, {0.2, 0.2, 0.22}}, above_floor};
}

Body closedJar() {
  return {filledJar, {{-0.2, -0.2, -0.22}, {0.2, 0.2, 0.22}}, {}};
}

Body head() {
  return {headAt, {{-0.1, -0.2, -0.11}, {0.1, 0.12, 0.14}}, {}};
}

Sample sampleBody(const Body& body, std::size_t count, double noise, std::mt19937_64& random) {
  const double shell = 0.006 * body.box.diagonal(), step = 1e-4 * body.box.diagonal();
  Sample sample;
  while (sample.points.size() < count) {
    Vector3 p;
    for (std::size_t a = 0; a < 3; ++a) p[a] = uniform(random, body.box.low[a], body.box.high[a]);
    const double value = body.distance(p);
    if (std::abs(value) > 1.5 * shell) continue;
    Vector3 g = gradient(body, p, step);
    if (value * value > shell * shell * dot(g, g)) continue;
    for (int round = 0; round < 4; ++round) {
      p = along(p, -body.distance(p) / std::max(0.01, dot(g, g)), g);
      g = gradient(body, p, step);
    }
    const Vector3 n = normalized(g);
    if (body.is_seen && !body.is_seen(p, n)) continue;
    sample.points.push_back(withNoise(p, noise, random));
    sample.normals.push_back(n);
  }
  return sample;
}

std::vector<Face> boxFaces(const Vector3& low, const Vector3& high) {
  const Vector3 d = subtract(high, low), x = {d[0], 0, 0}, y = {0, d[1], 0}, z = {0, 0, d[2]};
  return {{low, z, y},
          {low, x, z},
          {low, y, x},
          {high, scaled(y, -1), scaled(z, -1)},
          {high, scaled(z, -1), scaled(x, -1)},
          {high, scaled(x, -1), scaled(y, -1)}};
}

namespace {

/** One of some faces, as often as its area is large. */
std::size_t pick(const std::vector<double>& areas, std::mt19937_64& random) {
  return std::discrete_distribution<std::size_t>(areas.begin(), areas.end())(random);
}

std::vector<double> areasOf(const std::vector<Face>& faces) {
  std::vector<double> areas;
  for (const Face& face : faces) areas.push_back(length(cross(face.a, face.b)));
  return areas;
}

Vector3 pointOf(const Face& face, std::mt19937_64& random) {
  const double s = uniform(random, 0, 1), t = uniform(random, 0, 1);
  return along(along(face.corner, s, face.a), t, face.b);
}

}  // namespace

Sample sampleBoxWithBoss(std::size_t count, std::mt19937_64& random, std::vector<int>& face) {
  constexpr double kRadius = 0.35, kHeight = 0.5, kTop = 0.4;
  const std::vector<Face> faces = boxFaces({-1, -0.7, -kTop}, {1, 0.7, kTop});
  std::vector<double> areas = areasOf(faces);
  areas.push_back(2 * M_PI * kRadius * kHeight);
  areas.push_back(M_PI * kRadius * kRadius);
  Sample sample;
  face.clear();
  while (sample.points.size() < count) {
    const std::size_t at = pick(areas, random);
    const double turn = uniform(random, 0, 2 * M_PI);
    const Vector3 out = {std::cos(turn), std::sin(turn), 0};
    Vector3 p, n;
    if (at < 6) {
      p = pointOf(faces[at], random);
      n = normalized(cross(faces[at].a, faces[at].b));
      if (n[2] > 0.5 && std::hypot(p[0], p[1]) < kRadius) continue;
    } else if (at == 6) {
      p = along({0, 0, kTop + uniform(random, 0, kHeight)}, kRadius, out);
      n = out;
    } else {
      p = along({0, 0, kTop + kHeight}, kRadius * std::sqrt(uniform(random, 0, 1)), out);
      n = {0, 0, 1};
    }
    sample.points.push_back(p);
    sample.normals.push_back(n);
    face.push_back(static_cast<int>(at));
  }
  return sample;
}

Sample sampleWall(std::size_t count, double noise, const Vector3& viewpoint,
                  std::mt19937_64& random) {
  constexpr double kDepth = 0.2;
  struct Opening {
    double left, right, low, high;
  };
  constexpr Opening kDoor{-1.4, -0.5, 0, 2.1}, kWindow{0.4, 1.5, 1, 2.1};
  std::vector<Face> faces = {{{-2, 0, 0}, {4, 0, 0}, {0, 0, 3}}};
  for (const Opening& o : {kDoor, kWindow}) {
    const Vector3 depth = {0, kDepth, 0}, wide = {o.right - o.left, 0, 0};
    const Vector3 high = {0, 0, o.high - o.low};
    faces.push_back({{o.left, 0, o.low}, depth, high});
    faces.push_back({{o.right, 0, o.low}, high, depth});
    faces.push_back({{o.left, 0, o.high}, depth, wide});
    if (o.low > 0) faces.push_back({{o.left, 0, o.low}, wide, depth});
  }
  const std::vector<double> areas = areasOf(faces);
  Sample sample;
  while (sample.points.size() < count) {
    const std::size_t at = pick(areas, random);
    const Vector3 p = pointOf(faces[at], random), n = normalized(cross(faces[at].a, faces[at].b));
    const auto inside = [&p](const Opening& o) {
      return p[0] > o.left && p[0] < o.right && p[2] > o.low && p[2] < o.high;
    };
    if (at == 0 && (inside(kDoor) || inside(kWindow))) continue;
    if (dot(n, subtract(viewpoint, p)) <= 0) continue;
    sample.points.push_back(withNoise(p, noise, random));
    sample.normals.push_back(n);
  }
  return sample;
}

namespace {

constexpr double kTerrain = 120;  ///< half the edge of the terrain

double groundAt(double x, double y) {
  return 8 * std::sin(x / 60) * std::cos(y / 45) + 1.5 * std::sin(x / 17 + y / 23);
}

/** A house with a gable along y. */
struct House {
  double x, y, wide, deep, eaves, rise;

  bool contains(double px, double py) const {
    return std::abs(px - x) < 0.5 * wide && std::abs(py - y) < 0.5 * deep;
  }
  double roofAt(double px) const { return eaves + rise * (1 - 2 * std::abs(px - x) / wide); }
};

std::vector<House> makeHouses(std::mt19937_64& random) {
  std::vector<House> houses;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double x = -90 + 60 * column + uniform(random, -8, 8);
      const double y = -90 + 60 * row + uniform(random, -8, 8);
      const double rise = column % 2 == 0 ? 3.0 : 0.0;
      houses.push_back({x, y, uniform(random, 10, 16), uniform(random, 12, 24),
                        groundAt(x, y) + uniform(random, 5, 9), rise});
    }
  }
  return houses;
}

/** Unit normal, facing up, of a surface of these slopes. */
Vector3 upOf(double dx, double dy) {
  return normalized({-dx, -dy, 1});
}

}  // namespace

Sample sampleTerrain(std::size_t count, double noise, const Vector3& origin,
                     std::mt19937_64& random) {
  constexpr double kStep = 0.01, kFacade = 0.02;
  const std::vector<House> houses = makeHouses(random);
  Sample sample;
  while (sample.points.size() < count) {
    Vector3 p = {uniform(random, -kTerrain, kTerrain), uniform(random, -kTerrain, kTerrain), 0};
    Vector3 n = upOf((groundAt(p[0] + kStep, p[1]) - groundAt(p[0], p[1])) / kStep,
                     (groundAt(p[0], p[1] + kStep) - groundAt(p[0], p[1])) / kStep);
    p[2] = groundAt(p[0], p[1]);
    for (const House& house : houses) {
      if (!house.contains(p[0], p[1])) continue;
      p[2] = house.roofAt(p[0]);
      n = upOf(house.rise * (p[0] > house.x ? -2 : 2) / house.wide, 0);
    }
    if (uniform(random, 0, 1) < kFacade) {  // the two facades along y of a house
      const House& house = houses[random() % houses.size()];
      p[0] = house.x + (random() % 2 == 0 ? 0.5 : -0.5) * house.wide;
      p[1] = house.y + uniform(random, -0.5, 0.5) * house.deep;
      p[2] = uniform(random, groundAt(p[0], p[1]), house.eaves);
      n = {};
    }
    sample.points.push_back(along(withNoise(p, noise, random), 1, origin));
    sample.normals.push_back(n);
  }
  return sample;
}

namespace {

/** Adds the side of a cylinder from one end to another. */
void addRod(const Vector3& from, const Vector3& to, double radius, std::size_t count,
            std::mt19937_64& random, Sample& sample) {
  const Vector3 axis = normalized(subtract(to, from));
  const Vector3 u = normalized(cross(axis, {0.3, 0.5, 0.8})), v = cross(axis, u);
  for (std::size_t i = 0; i < count; ++i) {
    const double turn = uniform(random, 0, 2 * M_PI);
    const Vector3 p = along(from, uniform(random, 0, 1), subtract(to, from));
    sample.points.push_back(
        along(along(p, radius * std::cos(turn), u), radius * std::sin(turn), v));
  }
}

Vector3 randomDirection(std::mt19937_64& random) {
  std::normal_distribution<double> gauss;
  return normalized({gauss(random), gauss(random), gauss(random)});
}

}  // namespace

Sample sampleTree(std::mt19937_64& random) {
  constexpr int kBranches = 200, kClusters = 400;
  Sample sample;
  addRod({0, 0, 0}, {0, 0, 3}, 0.15, 8000, random, sample);
  std::vector<Vector3> ends;
  for (int i = 0; i < kBranches; ++i) {
    const Vector3 from = {0, 0, uniform(random, 1.2, 3)};
    const Vector3 way = randomDirection(random);
    const Vector3 to =
        along(from, uniform(random, 0.4, 1.6), normalized({way[0], way[1], std::abs(way[2])}));
    addRod(from, to, uniform(random, 0.006, 0.025), 120, random, sample);
    ends.push_back(to);
  }
  for (int i = 0; i < kClusters; ++i) {
    const Vector3 middle =
        along(ends[random() % ends.size()], uniform(random, 0, 0.25), randomDirection(random));
    for (int leaf = 0; leaf < 4; ++leaf) {
      const Vector3 at = along(middle, 0.08, randomDirection(random)), n = randomDirection(random);
      const Vector3 u = normalized(cross(n, {0.3, 0.5, 0.8})), v = cross(n, u);
      for (int k = 0; k < 15; ++k) {
        const double r = 0.03 * std::sqrt(uniform(random, 0, 1)), t = uniform(random, 0, 2 * M_PI);
        sample.points.push_back(along(along(at, r * std::cos(t), u), r * std::sin(t), v));
      }
    }
  }
  return sample;
}

}  // namespace pcl_slim::sides
