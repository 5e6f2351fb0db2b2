// SPDX-License-Identifier: BSD-3-Clause
#include "views/view_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "sides/bodies.h"

namespace pcl_slim::views {

namespace {

using sides::SideScene;

/** Axes of the files of a scan. */
enum class Axes { kZUp, kYUp, kZDown, kYDown };

const char* nameOf(Axes axes) {
  switch (axes) {
    case Axes::kYUp: return ", y up";
    case Axes::kZDown: return ", z down";
    case Axes::kYDown: return ", y down";
    default: return "";
  }
}

/** A direction given with z up. */
Vector3 turned(const Vector3& v, Axes axes) {
  switch (axes) {
    case Axes::kYUp: return {v[0], v[2], -v[1]};
    case Axes::kZDown: return {v[0], -v[1], -v[2]};
    case Axes::kYDown: return {v[0], -v[2], v[1]};
    default: return v;
  }
}

ViewScene turned(ViewScene scene, Axes axes) {
  for (auto* all : {&scene.scan.points, &scene.scan.normals, &scene.scan.sensors}) {
    for (Vector3& v : *all) v = turned(v, axes);
  }
  scene.up = turned(scene.up, axes);
  scene.scan.name += nameOf(axes);
  return scene;
}

/** The first scene of the sides' benchmark of a name. */
SideScene sideScene(const std::string& name, std::uint64_t seed) {
  for (const sides::SceneMaker& maker : sides::sceneMakers(seed)) {
    if (maker.name == name) return maker.make();
  }
  return {};
}

struct Box {
  Vector3 low, high;
};

/** A depth of a ray at which it enters a box; infinite if it does not. */
double entered(const Box& box, const Vector3& from, const Vector3& ray) {
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (std::size_t a = 0; a < 3; ++a) {
    double t0 = (box.low[a] - from[a]) / ray[a], t1 = (box.high[a] - from[a]) / ray[a];
    if (t0 > t1) std::swap(t0, t1);
    near = std::max(near, t0);
    far = std::min(far, t1);
  }
  return near < far && near > 0 ? near : std::numeric_limits<double>::infinity();
}

/** Boxes as an object scanned from all sides: points that a ray from outside reaches. */
SideScene boxesScene(const std::string& name, const std::vector<Box>& boxes, std::size_t count,
                     double noise, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<sides::Face> faces;
  std::vector<double> areas;
  for (const Box& box : boxes) {
    for (const sides::Face& face : sides::boxFaces(box.low, box.high)) {
      faces.push_back(face);
      areas.push_back(length(cross(face.a, face.b)));
    }
  }
  std::discrete_distribution<std::size_t> pick(areas.begin(), areas.end());
  SideScene scene;
  scene.name = name;
  scene.closed = true;
  while (scene.points.size() < count) {
    const sides::Face& face = faces[pick(random)];
    const Vector3 p = along(along(face.corner, unit(random), face.a), unit(random), face.b);
    const Vector3 n = normalized(cross(face.a, face.b));
    const Vector3 out = along(p, 1e-6, n);
    const bool hidden = std::any_of(boxes.begin(), boxes.end(), [&](const Box& box) {
      bool inside = true;
      for (std::size_t a = 0; a < 3; ++a)
        inside = inside && out[a] > box.low[a] && out[a] < box.high[a];
      return inside;
    });
    if (hidden) continue;
    scene.points.push_back(
        {p[0] + noise * gauss(random), p[1] + noise * gauss(random), p[2] + noise * gauss(random)});
    scene.normals.push_back(n);
  }
  return scene;
}

SideScene chair(std::uint64_t seed) {
  std::vector<Box> boxes = {{{-.22, -.22, .43}, {.22, .22, .47}},
                            {{-.22, .18, .47}, {.22, .22, .9}}};
  for (const double x : {-.22, .18}) {
    for (const double y : {-.22, .18}) boxes.push_back({{x, y, 0}, {x + .04, y + .04, .43}});
  }
  return boxesScene("chair", boxes, 60000, 0.001, seed);
}

SideScene desk(std::uint64_t seed) {
  std::vector<Box> boxes = {{{-.7, -.4, .7}, {.7, .4, .73}}};
  for (const double x : {-.68, .62}) {
    for (const double y : {-.38, .32}) boxes.push_back({{x, y, 0}, {x + .06, y + .06, .7}});
  }
  return boxesScene("desk", boxes, 60000, 0.001, seed);
}

SideScene car(std::uint64_t seed) {
  std::vector<Box> boxes = {{{-.9, -2.1, .3}, {.9, 2.1, .85}}, {{-.8, -1.0, .85}, {.8, 1.2, 1.4}}};
  for (const double x : {-.92, .72}) {
    for (const double y : {-1.6, 1.0}) boxes.push_back({{x, y, 0}, {x + .2, y + .6, .6}});
  }
  return boxesScene("car", boxes, 60000, 0.004, seed);
}

SideScene animal(std::uint64_t seed) {
  std::vector<Box> boxes = {{{-.1, -.3, .2}, {.1, .3, .4}},
                            {{-.06, .3, .35}, {.06, .45, .5}},
                            {{-.02, -.38, .3}, {.02, -.3, .34}}};
  for (const double x : {-.1, .06}) {
    for (const double y : {-.28, .24}) boxes.push_back({{x, y, 0}, {x + .04, y + .04, .2}});
  }
  return boxesScene("animal", boxes, 60000, 0.0005, seed);
}

/** A bracket as CAD exports have it, drilled plates left out. */
SideScene bracket(std::uint64_t seed) {
  return boxesScene(
      "bracket",
      {{{-50, -40, 0}, {50, 40, 8}}, {{-50, 32, 8}, {50, 40, 70}}, {{-4, -20, 8}, {4, 32, 40}}},
      60000, 0.02, seed);
}

/** What a pinhole camera sees of boxes, with an error along its rays. */
void addFrame(const std::vector<Box>& boxes, const Vector3& eye, const Vector3& target,
              double half_width, double sigma, std::mt19937_64& random, SideScene& scene) {
  constexpr int kPixels = 160;
  std::normal_distribution<double> gauss;
  const Vector3 forward = normalized(subtract(target, eye));
  const Vector3 right = normalized(cross(forward, {0, 0, 1})), down = cross(forward, right);
  const auto at = [&](int pixel) { return half_width * (2.0 * (pixel + 0.5) / kPixels - 1); };
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const Vector3 ray = normalized(along(along(forward, at(x), right), at(y), down));
      double t = std::numeric_limits<double>::infinity();
      for (const Box& box : boxes) t = std::min(t, entered(box, eye, ray));
      if (!std::isfinite(t)) continue;
      scene.points.push_back(along(eye, t + sigma * gauss(random), ray));
      scene.sensors.push_back(eye);
    }
  }
}

/** The corner of a room with a sofa and a table, as a phone sees it that is carried round. */
SideScene phone(std::uint64_t seed) {
  const std::vector<Box> boxes = {
      {{-2, -2, -1.5}, {2, 2, -1.4}},          {{-2, 2, -1.4}, {2, 2.1, 1.1}},
      {{-2.1, -2, -1.4}, {-2, 2, 1.1}},        {{-1.9, -1.0, -1.4}, {-1.1, 1.0, -.95}},
      {{-1.9, -1.0, -.95}, {-1.7, 1.0, -.55}}, {{-.5, 0.2, -1.0}, {.5, .9, -.95}},
      {{-.05, 0.5, -1.4}, {.05, .6, -1.0}}};
  std::mt19937_64 random(seed);
  SideScene scene;
  scene.name = "phone";
  for (int i = 0; i < 8; ++i) {
    const double s = i / 7.0;
    addFrame(boxes, {1.6 - 1.4 * s, -1.7 + .6 * s, 0}, {-1.2 + 1.2 * s, 1.2 - .8 * s, -.9}, .7,
             .004, random, scene);
  }
  return scene;
}

/** A body as one camera far away along -y sees it, noise left out: a range map. */
SideScene rangeMap(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const sides::Sample sample = sides::sampleBody(sides::head(), 90000, 0.0003, random);
  SideScene scene;
  scene.name = "range map";
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    if (sample.normals[i][2] < 0.25) continue;
    const Vector3 &p = sample.points[i], &n = sample.normals[i];
    scene.points.push_back({p[0], -p[2], p[1]});  // the head's own axes have y up, z in front
    scene.normals.push_back({n[0], -n[2], n[1]});
  }
  scene.sensors = {{0, -2, 0}};
  return scene;
}

/** The head with z up. */
SideScene head(std::uint64_t seed) {
  SideScene scene = sideScene("head", seed);
  for (auto* all : {&scene.points, &scene.normals}) {
    for (Vector3& v : *all) v = {v[0], -v[2], v[1]};
  }
  return scene;
}

/** A head that stands on nothing: its underside was not seen. */
SideScene bust(std::uint64_t seed) {
  SideScene scene = head(seed), seen;
  seen.name = "bust";
  double low = HUGE_VAL;
  for (const Vector3& p : scene.points) low = std::min(low, p[2]);
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    if (scene.points[i][2] < low + .03) continue;
    seen.points.push_back(scene.points[i]);
    seen.normals.push_back(scene.normals[i]);
  }
  return seen;
}

/** A depth camera's table, whose own axes have y down and z forward, with z up. */
SideScene cameraTable(std::uint64_t seed, const Vector3& moved) {
  SideScene scene = sideScene("table", seed);
  scene.name = "camera";
  for (auto* all : {&scene.points, &scene.normals}) {
    for (Vector3& v : *all) v = {v[0], v[2], -v[1]};
  }
  if (length(moved) > 0) scene.name = "camera, moved";
  for (Vector3& p : scene.points) p = along(p, 1, moved);
  for (Vector3& p : scene.sensors) p = along(p, 1, moved);
  scene.scanned_from_origin = length(moved) == 0;
  return scene;
}

/** Frames in the axes of the camera that saw the first of them: x right, y down, z forward. It looked
 * down at the origin. */
ViewScene inCameraAxes(SideScene scan) {
  const Vector3 eye = scan.sensors[0], forward = normalized(scaled(eye, -1));
  const Vector3 right = normalized(cross(forward, {0, 0, 1})), down = cross(forward, right);
  const auto turn = [&](const Vector3& v) {
    return Vector3{dot(v, right), dot(v, down), dot(v, forward)};
  };
  for (auto* all : {&scan.points, &scan.sensors}) {
    for (Vector3& p : *all) p = turn(subtract(p, eye));
  }
  for (Vector3& n : scan.normals) n = turn(n);
  scan.name += ", first camera's axes";
  ViewScene scene;
  scene.scan = std::move(scan);
  scene.kind = Kind::kOneSide;
  scene.up = {0, -1, 0};
  return scene;
}

using ScanMaker = std::function<SideScene()>;

}  // namespace

std::vector<SceneMaker> sceneMakers(std::uint64_t seed) {
  std::vector<SceneMaker> makers;
  const auto add = [&makers](const std::string& name, Kind kind, const std::vector<Axes>& all,
                             const ScanMaker& make) {
    for (const Axes axes : all) {
      makers.push_back({name + nameOf(axes), [=] {
                          ViewScene scene;
                          scene.scan = make();
                          scene.kind = kind;
                          return turned(std::move(scene), axes);
                        }});
    }
  };
  const auto side = [seed](const char* name) { return [=] { return sideScene(name, seed); }; };
  const std::vector<Axes> both = {Axes::kZUp, Axes::kYUp},
                          most = {Axes::kZUp, Axes::kYUp, Axes::kYDown};
  add("head", Kind::kObject, both, [=] { return head(seed); });
  add("bust", Kind::kObject, both, [=] { return bust(seed); });
  add("jar", Kind::kObject, both, side("jar"));
  add("chair", Kind::kObject, both, [=] { return chair(seed); });
  add("desk", Kind::kObject, both, [=] { return desk(seed); });
  add("car", Kind::kObject, both, [=] { return car(seed); });
  add("animal", Kind::kObject, both, [=] { return animal(seed); });
  add("bracket", Kind::kObject, {Axes::kZUp}, [=] { return bracket(seed); });
  add("box", Kind::kObject, both, side("box"));
  add("tree", Kind::kObject, both, side("tree"));
  add("camera", Kind::kOneSide, most, [=] { return cameraTable(seed, {}); });
  add("camera, moved", Kind::kOneSide, both, [=] { return cameraTable(seed, {.4, 2, .3}); });
  add("range map", Kind::kOneSide, most, [=] { return rangeMap(seed); });
  add("wall", Kind::kOneSide, both, side("wall"));
  add("phone", Kind::kOneSide, {Axes::kZUp, Axes::kYUp, Axes::kYDown, Axes::kZDown},
      [=] { return phone(seed); });
  add("frames", Kind::kOneSide, both, side("frames"));
  makers.push_back(
      {"frames, first camera's axes", [=] { return inCameraAxes(sideScene("frames", seed)); }});
  add("aerial", Kind::kGround, {Axes::kZUp}, side("aerial"));
  add("room", Kind::kInside, both, side("room"));
  add("hall", Kind::kInside, both, side("hall"));
  add("street", Kind::kStation, {Axes::kZUp, Axes::kYUp, Axes::kZDown}, side("street"));
  return makers;
}

}  // namespace pcl_slim::views
