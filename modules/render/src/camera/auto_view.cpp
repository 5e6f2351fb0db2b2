// SPDX-License-Identifier: BSD-3-Clause
// The view of an object that a picture shows if none is given.
#include "pcl_slim/render/auto_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "camera/sphere_cloud.h"
#include "camera/up_axis.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim {

using namespace detail;
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kQuarterView = 30.0;  ///< azimuth of an object that looks alike from everywhere
constexpr double kStandingFov = 60.0;  ///< of a viewer amid a scene, as wide as people look

SignedAxis signedAxis(UpAxis axis) {
  switch (axis) {
    case UpAxis::kX: return {0, 1.0};
    case UpAxis::kY: return {1, 1.0};
    case UpAxis::kMinusX: return {0, -1.0};
    case UpAxis::kMinusY: return {1, -1.0};
    case UpAxis::kMinusZ: return {2, -1.0};
    default: return {2, 1.0};
  }
}

UpAxis upAxis(const SignedAxis& axis) {
  constexpr UpAxis kAxes[2][3] = {{UpAxis::kX, UpAxis::kY, UpAxis::kZ},
                                  {UpAxis::kMinusX, UpAxis::kMinusY, UpAxis::kMinusZ}};
  return kAxes[axis.sign > 0 ? 0 : 1][axis.axis];
}

/** \brief The directions about an upright object; front is right x up. */
struct Frame {
  Vector3 up, front, right;

  explicit Frame(const SignedAxis& axis) : up(axis.direction()) {
    front = axis.axis == 1 ? Vector3{0.0, 0.0, axis.sign} : Vector3{0.0, -1.0, 0.0};
    right = cross(up, front);
  }

  Vector3 level(double azimuth) const {
    const double a = azimuth * kDegree;
    return along(scaled(front, std::cos(a)), std::sin(a), right);
  }
  ViewDirection view(double azimuth, double elevation) const {
    const double e = elevation * kDegree;
    const Vector3 out = level(azimuth);
    // The picture's upward direction is the derivative by elevation, which is never degenerate.
    return {along(scaled(out, std::cos(e)), std::sin(e), up),
            along(scaled(out, -std::sin(e)), std::cos(e), up)};
  }
};

/** \brief A symmetric tensor over the directions to the front and to the right. */
struct LevelTensor {
  double ff = 0.0, rr = 0.0, rf = 0.0;

  void add(double front, double right) {
    ff += front * front;
    rr += right * right;
    rf += right * front;
  }
  /** \brief Azimuth of the longer axis in (-90, 90] degrees. */
  double longAxis() const { return 0.5 * std::atan2(2.0 * rf, ff - rr) / kDegree; }
  /** \brief Ratio of the axes. */
  double elongation() const {
    const double middle = 0.5 * (rr + ff), spread = std::hypot(0.5 * (ff - rr), rf);
    return std::sqrt((middle + spread) / std::max(middle - spread, 1e-30));
  }
};

/** \brief The azimuth of a viewer who looks across an axis: in (-60, 120], so that both of a map's
 * own axes are far from the ends. */
double across(double axis) {
  const double azimuth = axis + 90.0;
  return azimuth > 120.0 ? azimuth - 180.0 : azimuth;
}

/** \brief Azimuth from which a map looks widest; the nearer to 0, the more alike its extents are: a
 * map about as long as wide is seen from the front. */
double widestAzimuth(const SphereCloud& cloud, const Frame& frame) {
  constexpr double kElongated = 1.3, kSquare = 1.1;  // turned in full, not
  const Vector3 middle = middleOf(cloud);
  LevelTensor spread;
  for (std::size_t i = 0; i < cloud.centers.size(); ++i) {
    const Vector3 off = subtract(cloud.centers[i], middle);
    spread.add(dot(off, frame.front), dot(off, frame.right));
  }
  const double turned = (spread.elongation() - kSquare) / (kElongated - kSquare);
  return across(spread.longAxis()) * std::clamp(turned, 0.0, 1.0);
}

/** \brief Azimuth of a viewer amid a scene, who looks along its walls. */
double alongWalls(const SphereCloud& cloud, const Frame& frame) {
  constexpr double kUpright = 0.5;  // most that a wall's normal points up or down
  LevelTensor walls;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    const Vector3& n = cloud.normals[i];
    if (std::abs(dot(n, frame.up)) < kUpright) walls.add(dot(n, frame.front), dot(n, frame.right));
  }
  return across(walls.longAxis());
}

/** \brief A viewer's position; angles in degrees. */
struct Stand {
  double azimuth = kQuarterView, elevation = 18.0;
};

/** \brief Before the side that was scanned, the higher, the more of it faces upwards. */
Stand beforeSide(const SphereCloud& cloud, const Frame& frame) {
  constexpr double kBeside = 15.0;  // azimuth off the front, which shows depth
  constexpr double kLowest = 12.0, kHighest = 42.0, kSlant = 0.6;
  const double front = dot(cloud.mean_normal, frame.front);
  const double right = dot(cloud.mean_normal, frame.right);
  const double up = dot(cloud.mean_normal, frame.up), level = std::hypot(front, right);
  const double slant = std::atan2(up, level) / kDegree;
  const double azimuth = level > 0.1 * length(cloud.mean_normal)
                             ? std::atan2(right, front) / kDegree + kBeside
                             : widestAzimuth(cloud, frame);
  return {azimuth, std::clamp(kSlant * slant, kLowest, kHighest)};
}

/** \brief From the front and the right unless much more is seen from another quarter. */
Stand aboutObject(const SphereCloud& cloud, const Frame& frame) {
  constexpr double kMuchMore = 1.3;
  const auto seen = [&](double azimuth) {
    const Vector3 towards = frame.view(azimuth, 18.0).towards_viewer;
    double area = 0.0;
    for (const Vector3& normal : cloud.normals) area += std::abs(dot(normal, towards));
    return area;
  };
  Stand stand;
  double most = kMuchMore * seen(stand.azimuth);
  for (const double azimuth : {-30.0, 60.0, -60.0}) {
    const double area = seen(azimuth);
    if (area <= most) continue;
    most = area;
    stand.azimuth = azimuth;
  }
  return stand;
}

/** \brief "from the front-right", "from above, from the left" ... */
std::string wordsOf(const Stand& stand) {
  static const std::array<const char*, 8> kSides{"front", "front-right", "right", "back-right",
                                                 "back",  "back-left",   "left",  "front-left"};
  constexpr double kAbove = 30.0;
  const auto eighth = static_cast<long>(std::lround(stand.azimuth / 45.0)) % 8;
  const std::string side = kSides[static_cast<std::size_t>((eighth + 8) % 8)];
  return (stand.elevation > kAbove ? "from above, the " : "from the ") + side;
}

/** \brief How far a viewer at a vantage can step back, by what is met behind him. */
double roomBehind(const Vantage& vantage, const Vector3& behind) {
  constexpr double kNear = 0.9;  // cosine of the directions that count as behind
  double room = HUGE_VAL;
  for (std::size_t k = 0; k < vantage.directions.size(); ++k) {
    if (dot(vantage.directions[k], behind) > kNear) room = std::min(room, vantage.depths[k]);
  }
  return room;
}

/** \brief A viewer near the vantage of a station, a step back: nothing was seen below it. */
Standpoint standAmid(const SphereCloud& cloud, const Vantage& vantage, const Frame& frame,
                     const BoundingSpheres& object) {
  constexpr double kDown = 4.0;   // [degrees] the ground is part of the picture
  constexpr double kStep = 0.5;   // share of the room behind ...
  constexpr double kMost = 0.05;  // ... of this share of the extent at most
  const double azimuth = alongWalls(cloud, frame);
  const double most = kMost * length(subtract(cloud.high, cloud.low));
  const Vector3 behind = frame.level(azimuth);
  const double step = std::min(most, kStep * roomBehind(vantage, behind));
  return {along(object.origin, object.scale, along(vantage.place, step, behind)),
          frame.view(azimuth, kDown)};
}

}  // namespace

ViewDirection viewFromAngles(UpAxis up, double azimuth, double elevation) {
  return Frame(signedAxis(up)).view(azimuth, elevation);
}

SceneView chooseView(const BoundingSpheres& object, UpAxis up) {
  const SphereCloud cloud(object);
  SceneView view;
  const SignedAxis given = signedAxis(up);
  Upright found;
  found.up = given;
  if (!cloud.empty()) found = findUpright(cloud, object, up == UpAxis::kAuto ? nullptr : &given);
  const Frame frame(found.up);
  view.axis = upAxis(found.up);
  view.up = frame.up;
  Stand stand;
  if (!cloud.empty() && found.kind == SceneKind::kObject) stand = aboutObject(cloud, frame);
  if (found.kind == SceneKind::kOneSide) stand = beforeSide(cloud, frame);
  if (found.kind == SceneKind::kGround || found.kind == SceneKind::kStation)
    stand = {widestAzimuth(cloud, frame), 42.0};
  if (found.kind == SceneKind::kCamera) stand = {0.0, 7.0};
  if (found.kind == SceneKind::kInside) stand.elevation = 35.0;
  view.direction = frame.view(stand.azimuth, stand.elevation);
  view.opens = found.kind == SceneKind::kInside;
  view.from = found.kind == SceneKind::kCamera ? "from the camera's place" : wordsOf(stand);
  if (found.kind != SceneKind::kStation) return view;
  view.amid = standAmid(cloud, found.vantage, frame, object);
  view.from = "from amid the scene";
  return view;
}

UpAxis guessUpAxis(const BoundingSpheres& object) {
  return chooseView(object).axis;
}

Camera cameraFor(const SceneView& view, const BoundingSpheres& object, const ImageSize& size,
                 double fov, double margin, double right_margin) {
  if (!view.amid)
    return fitCamera(object, view.direction, size, fov > 0.0 ? fov : Camera().fov, margin,
                     right_margin);
  Camera camera;
  camera.size = size;
  camera.fov = fov > 0.0 ? fov : kStandingFov;
  camera.position = view.amid->place;
  camera.look_at = along(camera.position, -0.25 * object.scale * object.diagonal,
                         view.amid->direction.towards_viewer);
  camera.up = view.amid->direction.up;
  return camera;
}

std::string nameOf(UpAxis axis) {
  static const std::array<const char*, 7> kNames{"auto", "x", "y", "z", "-x", "-y", "-z"};
  return kNames[static_cast<std::size_t>(axis)];
}

}  // namespace pcl_slim
