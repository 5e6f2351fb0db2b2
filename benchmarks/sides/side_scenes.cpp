// SPDX-License-Identifier: BSD-3-Clause
#include "sides/side_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "sides/bodies.h"
#include "support/lab/sensor.h"

namespace pcl_slim::sides {

namespace {

using measure::Solid;
using Solids = std::vector<Solid>;
using Color = std::array<std::uint8_t, 3>;  ///< blue green red

constexpr Color kClay{70, 120, 210}, kGlaze{30, 30, 34}, kBlue{190, 110, 40}, kGrey{150, 150, 150};

/** An axis-parallel rectangle; it is flat along one axis, where low and high are equal. */
Solid rectangle(const Vector3& low, const Vector3& high) {
  constexpr double kRounding = 1e-6;  // of the places where rays meet it
  Solid solid;
  solid.center = scaled(along(low, 1, high), 0.5);
  for (std::size_t a = 0; a < 3; ++a) {
    solid.axis[a] = low[a] == high[a] ? 1 : 0;
    solid.low[a] = low[a] - kRounding;
    solid.high[a] = high[a] + kRounding;
  }
  return solid;
}

void addBox(const Vector3& low, const Vector3& high, Solids& solids) {
  for (std::size_t a = 0; a < 3; ++a) {
    Vector3 near = high, far = low;
    near[a] = low[a];
    far[a] = high[a];
    solids.push_back(rectangle(low, near));
    solids.push_back(rectangle(far, high));
  }
}

Solid sphere(const Vector3& center, double radius) {
  Solid solid;
  solid.kind = Solid::Kind::kSphere;
  solid.center = center;
  solid.radius = radius;
  return solid;
}

Solid pole(double x, double y, double radius, double low, double high) {
  Solid solid;
  solid.kind = Solid::Kind::kPole;
  solid.center = {x, y, 0};
  solid.radius = radius;
  solid.low[2] = low;
  solid.high[2] = high;
  return solid;
}

/** A room of 6 x 5 x 2.8 about the origin with a table, two spheres and a pole. */
Solids furnishedRoom() {
  Solids solids;
  addBox({-2.7, -2.2, -1.4}, {3.3, 2.8, 1.4}, solids);
  addBox({0.9, -0.4, -0.69}, {2.3, 0.5, -0.65}, solids);
  for (const double x : {0.95, 2.25}) {
    for (const double y : {-0.35, 0.45}) solids.push_back(pole(x, y, 0.03, -1.4, -0.69));
  }
  solids.push_back(sphere({1.6, 0.05, -0.5}, 0.15));
  solids.push_back(sphere({-1.2, 1.4, -1.1}, 0.3));
  solids.push_back(pole(-1.5, -1.0, 0.06, -1.4, 1.4));
  return solids;
}

/** A room about the origin, a door in a wall .2 thick, and what is seen of a room behind it. */
Solids twoRooms() {
  constexpr double kFloor = -1.4, kTop = 1.4, kLintel = 0.7, kLeft = -0.3, kRight = 0.7;
  Solids solids = {
      rectangle({-3, -2.5, kFloor}, {3, 2.5, kFloor}),
      rectangle({-3, -2.5, kTop}, {3, 2.5, kTop}),
      rectangle({-3, -2.5, kFloor}, {-3, 2.5, kTop}),
      rectangle({-3, -2.5, kFloor}, {3, -2.5, kTop}),
      rectangle({-3, 2.5, kFloor}, {3, 2.5, kTop}),
      rectangle({3, -2.5, kFloor}, {3, kLeft, kTop}),
      rectangle({3, kRight, kFloor}, {3, 2.5, kTop}),
      rectangle({3, kLeft, kLintel}, {3, kRight, kTop}),
      rectangle({3, kLeft, kFloor}, {3.2, kLeft, kLintel}),
      rectangle({3, kRight, kFloor}, {3.2, kRight, kLintel}),
      rectangle({3, kLeft, kLintel}, {3.2, kRight, kLintel}),
      rectangle({3, kLeft, kFloor}, {3.2, kRight, kFloor}),
  };
  addBox({3.2, -2.5, kFloor}, {8, 2.5, kTop}, solids);
  solids.erase(solids.begin() + 12);  // the wall with the door, as no ray meets it from behind
  addBox({5, -0.2, kFloor}, {5.6, 0.3, -0.6}, solids);
  addBox({-1.5, 1.0, kFloor}, {-0.9, 1.8, -0.5}, solids);
  return solids;
}

/** A table below a camera that looks along z, y down, with a box and two spheres. */
Solids cameraTable() {
  Solids solids = {rectangle({-0.6, 0.35, 0.9}, {0.6, 0.35, 1.9})};
  addBox({-0.4, 0.1, 1.15}, {-0.1, 0.35, 1.4}, solids);
  solids.push_back(sphere({0.2, 0.2, 1.15}, 0.15));
  solids.push_back(sphere({0.1, 0.25, 1.6}, 0.1));
  return solids;
}

/** A normal or its opposite, on the side of a direction. */
Vector3 facing(const Vector3& normal, const Vector3& direction) {
  return scaled(normal, dot(normal, direction) < 0 ? -1 : 1);
}

/** Points about the sensor, with the true normals that face it. */
SideScene sceneOf(const std::string& name, const measure::SensorScan& scan) {
  SideScene scene;
  scene.name = name;
  scene.sensors = {{0, 0, 0}};
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const float* at = &scan.points[3 * i];
    const Vector3 p = {at[0], at[1], at[2]};
    const Solid& solid = scan.solids[static_cast<std::size_t>(scan.solid[i])];
    scene.points.push_back(subtract(p, scan.sensor));
    scene.normals.push_back(facing(measure::footOn(solid, p).normal, subtract(scan.sensor, p)));
  }
  return scene;
}

SideScene sceneOf(const std::string& name, const Sample& sample) {
  SideScene scene;
  scene.name = name;
  scene.points = sample.points;
  scene.normals = sample.normals;
  return scene;
}

/** Marks how a scan from the origin is given. */
SideScene fromOrigin(SideScene scene, bool known) {
  scene.sensor_known = known;
  scene.scanned_from_origin = !known;
  if (known) scene.name += ", sensor";
  return scene;
}

SideScene room(std::uint64_t seed, bool known) {
  measure::TurningLidar lidar;
  lidar.origin = {0, 0, 0};
  lidar.rings = 151;
  lidar.steps = 720;
  lidar.lowest = -90;
  lidar.highest = 90;
  lidar.sigma = 0.004;
  return fromOrigin(sceneOf("room", measure::scanByLidar(furnishedRoom(), lidar, seed)), known);
}

/** Puts the means of the points in cells of a grid in place of the points. */
void thin(double cell, SideScene& scene) {
  struct Sums {
    Vector3 points{}, normals{};
    double count = 0;
  };
  std::map<std::array<long, 3>, Sums> cells;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    std::array<long, 3> key;
    for (std::size_t a = 0; a < 3; ++a) key[a] = std::lround(std::floor(scene.points[i][a] / cell));
    Sums& sums = cells[key];
    sums.points = along(sums.points, 1, scene.points[i]);
    sums.normals = along(sums.normals, 1, scene.normals[i]);
    ++sums.count;
  }
  scene.points.clear();
  scene.normals.clear();
  for (const auto& [key, sums] : cells) {
    scene.points.push_back(scaled(sums.points, 1 / sums.count));
    scene.normals.push_back(normalized(sums.normals));
  }
}

SideScene hall(std::uint64_t seed, double cell) {
  measure::TurningLidar lidar;
  lidar.origin = {0, 0, 0};
  lidar.rings = 140;
  lidar.steps = 1000;
  lidar.lowest = -60;
  lidar.highest = 85;
  lidar.sigma = 0.004;
  SideScene scene =
      fromOrigin(sceneOf("hall", measure::scanByLidar(twoRooms(), lidar, seed)), false);
  if (cell > 0) {
    scene.name += ", thinned";
    thin(cell, scene);
  }
  return scene;
}

SideScene street(std::uint64_t seed, bool known) {
  const Solids solids = measure::namedSolids("street");
  return fromOrigin(sceneOf("street", measure::scanByLidar(solids, {}, seed)), known);
}

SideScene jar(std::uint64_t seed, bool open) {
  std::mt19937_64 random(seed);
  const Body body = open ? openJar() : closedJar();
  SideScene scene = sceneOf(open ? "jar" : "jar, closed", sampleBody(body, 60000, 0.0003, random));
  scene.closed = true;
  for (const Vector3& p : scene.points)
    scene.colors.push_back(std::sin(60 * p[2]) > 0.5 ? kGlaze : kClay);
  return scene;
}

SideScene table(std::uint64_t seed, bool known) {
  measure::DepthCamera camera;
  camera.correlated_x = camera.correlated_y = 3;
  SideScene scene = sceneOf("table", measure::scanByCamera(cameraTable(), camera, seed));
  scene.colors.assign(scene.points.size(), kGrey);
  return fromOrigin(std::move(scene), known);
}

SideScene headScene(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  SideScene scene = sceneOf("head", sampleBody(head(), 50000, 0.0003, random));
  scene.closed = true;
  return scene;
}

SideScene wall(std::uint64_t seed, std::size_t count) {
  const Vector3 viewpoint = {0.6, -4, 1.5};
  std::mt19937_64 random(seed);
  const std::string name =
      "wall, " + std::to_string(count / 1000) + "k, seed " + std::to_string(seed);
  SideScene scene = sceneOf(name, sampleWall(count, 0.002, viewpoint, random));
  scene.sensors = {viewpoint};
  scene.viewpoint_known = true;
  return scene;
}

SideScene aerial(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  return sceneOf("aerial", sampleTerrain(60000, 0.05, {500000, 5000000, 300}, random));
}

SideScene tree(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  return sceneOf("tree", sampleTree(random));
}

/** A pinhole camera of 160 x 160 pixels that looks at the origin and errs along its rays. */
void addFrame(const Solids& solids, const Vector3& eye, double sigma, std::mt19937_64& random,
              SideScene& scene) {
  constexpr int kPixels = 160;
  constexpr double kHalfWidth = 0.62;  // of the picture, at a distance of 1
  std::normal_distribution<double> gauss;
  const Vector3 forward = normalized(scaled(eye, -1));
  const Vector3 right = normalized(cross(forward, {0, 0, 1})), down = cross(forward, right);
  const auto at = [](int pixel) { return kHalfWidth * (2.0 * (pixel + 0.5) / kPixels - 1); };
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const Vector3 ray = normalized(along(along(forward, at(x), right), at(y), down));
      double t = std::numeric_limits<double>::infinity();
      std::size_t hit = 0;
      for (std::size_t i = 0; i < solids.size(); ++i) {
        const double met = measure::meet(solids[i], eye, ray);
        if (met < t) hit = i;
        t = std::min(t, met);
      }
      if (!std::isfinite(t)) continue;
      const Vector3 p = along(eye, t + sigma * gauss(random), ray);
      scene.points.push_back(p);
      scene.normals.push_back(facing(measure::footOn(solids[hit], p).normal, subtract(eye, p)));
      scene.sensors.push_back(eye);
      scene.colors.push_back(hit == 0 ? kGrey : hit == 1 ? kClay : kBlue);
    }
  }
}

SideScene frames(std::uint64_t seed) {
  constexpr int kFrames = 6;
  const Solids solids = {rectangle({-0.45, -0.35, -0.12}, {0.45, 0.35, -0.12}),
                         sphere({-0.16, 0, 0}, 0.12), pole(0.17, 0.04, 0.08, -0.12, 0.08),
                         sphere({0.17, 0.04, 0.08}, 0.08)};
  std::mt19937_64 random(seed);
  SideScene scene;
  scene.name = "frames";
  for (int i = 0; i < kFrames; ++i) {
    const double turn = 2 * M_PI * i / kFrames;
    addFrame(solids, {0.9 * std::cos(turn), 0.9 * std::sin(turn), 0.4}, 0.001, random, scene);
  }
  return scene;
}

SideScene cad(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<int> face;
  SideScene scene = sceneOf("box", sampleBoxWithBoss(40000, random, face));
  scene.closed = true;
  return scene;
}

void giveNormals(const std::function<bool(std::size_t)>& is_turned, SideScene& scene) {
  for (std::size_t i = 0; i < scene.normals.size(); ++i) {
    const Vector3 n = scaled(scene.normals[i], is_turned(i) ? -1 : 1);
    scene.given_normals.push_back(
        {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
  }
}

/** With given normals, those of some faces turned inwards. */
SideScene cadWithFaces(std::uint64_t seed, const std::string& name,
                       const std::vector<int>& turned) {
  std::mt19937_64 random(seed);
  std::vector<int> face;
  SideScene scene = sceneOf(name, sampleBoxWithBoss(40000, random, face));
  scene.closed = true;
  giveNormals([&](std::size_t i) { return std::count(turned.begin(), turned.end(), face[i]) > 0; },
              scene);
  return scene;
}

/** With given normals, a share of them turned inwards at random. */
SideScene cadWithSigns(std::uint64_t seed, double share) {
  SideScene scene = cad(seed);
  scene.name = "box, " + std::to_string(std::lround(100 * share)) + " % turned";
  std::mt19937_64 random(seed + 1);
  std::uniform_real_distribution<double> unit(0, 1);
  giveNormals([&](std::size_t) { return unit(random) < share; }, scene);
  return scene;
}

}  // namespace

CloudView SideScene::view() const {
  CloudView view;
  view.xyz = points.data();
  view.scalar = CloudView::Scalar::kDouble;
  view.xyz_stride = sizeof(Vector3);
  view.size = points.size();
  if (!given_normals.empty()) {
    view.normal = given_normals.data();
    view.normal_stride = sizeof(given_normals[0]);
  }
  if (sensor_known) view.sensor = sensors[0];
  return view;
}

ColorView SideScene::colorView() const {
  if (colors.empty()) return {};
  return {colors.data(), sizeof(colors[0])};
}

std::vector<SceneMaker> sceneMakers(std::uint64_t seed) {
  std::vector<SceneMaker> makers = {
      {"room", [=] { return room(seed, false); }},
      {"room, sensor", [=] { return room(seed, true); }},
      {"hall", [=] { return hall(seed, 0); }},
      {"hall, thinned", [=] { return hall(seed, 0.05); }},
      {"street", [=] { return street(seed, false); }},
      {"street, sensor", [=] { return street(seed, true); }},
      {"jar", [=] { return jar(seed, true); }},
      {"jar, closed", [=] { return jar(seed, false); }},
      {"table", [=] { return table(seed, false); }},
      {"table, sensor", [=] { return table(seed, true); }},
      {"head", [=] { return headScene(seed); }},
  };
  for (const std::size_t count : {20000, 100000}) {
    for (std::uint64_t k = 0; k < 3; ++k)
      makers.push_back({"wall", [=] { return wall(seed + k, count); }});
  }
  makers.push_back({"aerial", [=] { return aerial(seed); }});
  makers.push_back({"tree", [=] { return tree(seed); }});
  makers.push_back({"frames", [=] { return frames(seed); }});
  makers.push_back({"box", [=] { return cad(seed); }});
  makers.push_back({"box", [=] { return cadWithFaces(seed, "box, normals", {}); }});
  makers.push_back({"box", [=] { return cadWithFaces(seed, "box, a side turned", {0}); }});
  makers.push_back({"box", [=] { return cadWithFaces(seed, "box, boss turned", {6, 7}); }});
  makers.push_back({"box", [=] { return cadWithFaces(seed, "box, three turned", {0, 4, 6}); }});
  for (const double share : {0.01, 0.05, 0.2, 0.5})
    makers.push_back({"box", [=] { return cadWithSigns(seed, share); }});
  return makers;
}

}  // namespace pcl_slim::sides
