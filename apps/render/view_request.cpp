// SPDX-License-Identifier: BSD-3-Clause
#include "render/view_request.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/turning.h"
#include "render/camera_file.h"

namespace pcl_slim {
namespace {

constexpr double kMargin = 0.04;  ///< share of the picture, on each side

Error badOption(const std::string& message) {
  return {ErrorCode::kBadArgument, message};
}

Error parseSize(const std::string& text, ImageSize& size) {
  int used = 0;
  const bool read = std::sscanf(text.c_str(), "%5dx%5d%n", &size.width, &size.height, &used) == 2;
  if (!read || used != static_cast<int>(text.size()) || size.width < 1 || size.height < 1) {
    return badOption("-size takes width x height in pixels, as in 800x600, not '" + text + "'");
  }
  return {};
}

constexpr UpAxis kUpAxes[] = {UpAxis::kAuto,   UpAxis::kX,      UpAxis::kY,     UpAxis::kZ,
                              UpAxis::kMinusX, UpAxis::kMinusY, UpAxis::kMinusZ};

UpAxis upAxis(const std::string& name) {
  return *std::find_if(std::begin(kUpAxes), std::end(kUpAxes),
                       [&name](UpAxis axis) { return nameOf(axis) == name; });
}

std::vector<std::string> upNames() {
  std::vector<std::string> names;
  for (const UpAxis axis : kUpAxes) names.push_back(nameOf(axis));
  return names;
}

/** \brief Azimuth and elevation of -view; none for auto. */
Error parseView(const std::string& text, std::vector<double>& angles) {
  static const std::map<std::string, std::vector<double>> kNamed{
      {"auto", {}},
      {"front", {0.0, 0.0}},
      {"back", {180.0, 0.0}},
      {"left", {-90.0, 0.0}},
      {"right", {90.0, 0.0}},
      {"top", {0.0, 90.0}},
      {"bottom", {0.0, -90.0}},
      {"iso", {45.0, 35.264389682754654}}};
  const auto named = kNamed.find(text);
  if (named != kNamed.end()) {
    angles = named->second;
    return {};
  }
  if (parseNumberList(text, angles) && angles.size() == 2) return {};
  return badOption(
      "-view takes auto, front, back, left, right, top, bottom, iso or two angles in "
      "degrees such as 30,20, not '" +
      text + "'");
}

}  // namespace

Turntable::Turntable(const ViewRequest& request, const BoundingSpheres& object, int count)
    : count_(count) {
  if (count == 1) {
    first_ = request.viewOf(object);
    return;
  }
  const BoundingSpheres swept = sweptAbout(object, request.viewOf(object).up);
  pivot_ = swept.origin;
  first_ = request.viewOf(object, swept);
}

Camera Turntable::camera(int turn) const {
  return turnedCamera(first_.camera, pivot_, first_.up, turn, count_);
}

std::string Turntable::path(const std::string& path, int turn, int count) {
  if (count == 1) return path;
  char number[16];
  std::snprintf(number, sizeof number, "_%03d", turn);
  const std::size_t dot = path.rfind('.');
  return path.substr(0, dot) + number + path.substr(dot);
}

void ViewRequest::declareSize(OptionTable& table) {
  table.text("size", &size_text, "WxH", "width and height in pixels");
}

void ViewRequest::declareCamera(OptionTable& table) {
  table.text(
      "view", &view, "NAME|AZ,EL",
      "auto, front, back, left, right, top, bottom, iso, or azimuth and elevation in degrees");
  table.choice("up", &up, upNames(), "axis that points upwards");
  table.text(
      "camera", &camera, "auto|FILE|PX,PY,PZ,LX,LY,LZ,UX,UY,UZ[,FOV]",
      "a file of -save_camera, or position, target and upward direction in world coordinates",
      FileUse::kRead);
  table.number("fov", &fov, 1.0, 150.0, "vertical field of view in degrees", "30, amid a scene 60");
  table.toggle("ortho", &orthographic, "parallel projection");
  table.exclusive({"camera", "view"});
  table.exclusive({"camera", "fov"});
}

Error ViewRequest::parse() {
  if (Error error = parseSize(size_text, size)) return error;
  if (Error error = parseView(view, angles)) return error;
  if (camera == "auto") return {};
  const Result<Camera> read = looksLikeCamera(camera)
                                  ? cameraFromText(camera, fov > 0.0 ? fov : Camera().fov)
                                  : loadCamera(camera);
  if (!read) return read.error();
  if (orthographic) {
    return badOption("-ortho frames the object itself: give -view instead of -camera");
  }
  given = *read;
  given->size = size;
  return {};
}

Camera ViewRequest::framing(const BoundingSpheres& framed, const ViewDirection& direction) const {
  return orthographic ? fitOrthographicCamera(framed, direction, size, kMargin, right_margin)
                      : fitCamera(framed, direction, size, fov > 0.0 ? fov : Camera().fov, kMargin,
                                  right_margin);
}

ChosenView ViewRequest::viewOf(const BoundingSpheres& object) const {
  ChosenView chosen = viewOf(object, object);
  if (given || orthographic || !angles.empty()) return chosen;
  const SceneView scene = chooseView(object, upAxis(up));
  if (!scene.amid) return chosen;
  chosen.camera = pcl_slim::cameraFor(scene, object, size, fov);
  chosen.words = "view: up " + nameOf(scene.axis) + ", " + scene.from + "; -view iso for the whole";
  return chosen;
}

ChosenView ViewRequest::viewOf(const BoundingSpheres& object, const BoundingSpheres& framed) const {
  const SceneView scene = chooseView(object, upAxis(up));
  ChosenView chosen;
  chosen.up = scene.up;
  if (given) {
    chosen.camera = *given;
    return chosen;
  }
  chosen.opens = scene.opens;
  if (!angles.empty()) {
    chosen.camera = framing(framed, viewFromAngles(scene.axis, angles[0], angles[1]));
    if (up == "auto") chosen.words = "view: up " + nameOf(scene.axis);
  } else {
    chosen.camera = framing(framed, scene.direction);
    chosen.words = "view: up " + nameOf(scene.axis) + ", " + scene.from;
  }
  const bool is_z = scene.axis == UpAxis::kZ || scene.axis == UpAxis::kMinusZ;
  if (up == "auto") chosen.words += std::string("; -up ") + (is_z ? "y" : "z") + " for the other";
  return chosen;
}

namespace {

using Corner = std::array<double, 3>;

Corner placeOf(const BoundingSpheres& object, const BoundingSphere& sphere) {
  Corner place;
  for (std::size_t a = 0; a < 3; ++a) {
    place[a] = object.origin[a] + object.scale * double{sphere.center[a]};
  }
  return place;
}

bool holds(const std::vector<HalfSpace>& sides, const Corner& place) {
  return std::all_of(sides.begin(), sides.end(), [&](const HalfSpace& side) {
    return side.normal[0] * place[0] + side.normal[1] * place[1] + side.normal[2] * place[2] >=
           side.offset;
  });
}

/** \brief x0, x1, y0, y1, z0, z1 of an object's centres. */
std::array<double, 6> boundsOf(const BoundingSpheres& object) {
  std::array<double, 6> bounds;
  for (std::size_t a = 0; a < 3; ++a) {
    bounds[2 * a] = HUGE_VAL;
    bounds[2 * a + 1] = -HUGE_VAL;
  }
  for (const BoundingSphere& sphere : object.spheres) {
    const Corner place = placeOf(object, sphere);
    for (std::size_t a = 0; a < 3; ++a) {
      bounds[2 * a] = std::min(bounds[2 * a], place[a]);
      bounds[2 * a + 1] = std::max(bounds[2 * a + 1], place[a]);
    }
  }
  return bounds;
}

}  // namespace

void RegionRequest::declare(OptionTable& table) {
  table.text("region", &text, "all|X0,Y0,Z0,X1,Y1,Z1",
             "draw only what lies between two corners, world coordinates");
}

Error RegionRequest::parse() {
  if (text == "all") return {};
  std::vector<double> values;
  const bool read = parseNumberList(text, values) && values.size() == 6;
  for (std::size_t a = 0; read && a < 3; ++a) {
    Corner axis{};
    axis[a] = 1.0;
    sides.push_back({axis, values[a]});
    axis[a] = -1.0;
    sides.push_back({axis, -values[a + 3]});
  }
  const auto below = [&](std::size_t a) { return values[a] < values[a + 3]; };
  if (read && below(0) && below(1) && below(2)) return {};
  return {ErrorCode::kBadArgument,
          "-region takes the lowest and the highest corner of a box, X0,Y0,Z0,X1,Y1,Z1 with X0 < "
          "X1, Y0 < Y1 and Z0 < Z1, not '" +
              text + "'"};
}

std::array<double, 6> RegionRequest::bounds(const BoundingSpheres& object) const {
  if (sides.empty()) return boundsOf(object);
  std::array<double, 6> bounds;
  for (std::size_t k = 0; k < 6; ++k) bounds[k] = k % 2 == 0 ? sides[k].offset : -sides[k].offset;
  return bounds;
}

WorldBox RegionRequest::box() const {
  WorldBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box[0][a] = sides[2 * a].offset;
    box[1][a] = -sides[2 * a + 1].offset;
  }
  return box;
}

Result<BoundingSpheres> RegionRequest::within(const BoundingSpheres& object,
                                              const WorldBox* whole) const {
  if (sides.empty()) return object;
  BoundingSpheres part = object;
  part.spheres.clear();
  for (const BoundingSphere& sphere : object.spheres) {
    if (holds(sides, placeOf(object, sphere))) part.spheres.push_back(sphere);
  }
  if (!part.spheres.empty()) return part;
  std::array<double, 6> b = boundsOf(object);
  for (std::size_t a = 0; a < 3 && whole != nullptr; ++a) {
    b[2 * a] = (*whole)[0][a];
    b[2 * a + 1] = (*whole)[1][a];
  }
  std::string corners;
  for (const std::size_t k : {0u, 2u, 4u, 1u, 3u, 5u}) {
    corners += (corners.empty() ? "" : ",") + numberText(b[k], 9);
  }
  return Error{ErrorCode::kBadArgument,
               "nothing lies in -region " + text + "; give a part of " + corners};
}

}  // namespace pcl_slim
