// SPDX-License-Identifier: BSD-3-Clause
#include "render/view_request.h"

#include <cstdio>
#include <cstdlib>
#include <map>

#include "pcl_slim/render/auto_view.h"

namespace pcl_slim {
namespace {

Error
badOption(const std::string& message)
{
  return {ErrorCode::kBadArgument, message};
}

/** \brief Numbers separated by single commas; nothing else may stand between. */
bool
parseNumberList(const std::string& text, std::vector<double>& values)
{
  const char* at = text.c_str();
  for (;;) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) return false;
    values.push_back(value);
    if (*end == '\0') return true;
    if (*end != ',') return false;
    at = end + 1;
  }
}

Error
parseSize(const std::string& text, ImageSize& size)
{
  int used = 0;
  const bool read = std::sscanf(text.c_str(), "%5dx%5d%n", &size.width, &size.height, &used) == 2;
  if (!read || used != static_cast<int>(text.size()) || size.width < 1 || size.height < 1) {
    return badOption("-size takes width x height in pixels, as in 800x600, not '" + text + "'");
  }
  return {};
}

UpAxis
upAxis(const std::string& name)
{
  return name == "x"   ? UpAxis::kX
         : name == "y" ? UpAxis::kY
         : name == "z" ? UpAxis::kZ
                       : UpAxis::kAuto;
}

/** \brief Azimuth and elevation of -view; none for auto. */
Error
parseView(const std::string& text, std::vector<double>& angles)
{
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

Camera
cameraOfPose(const ViewRequest& request)
{
  const std::vector<double>& p = request.pose;
  Camera camera;
  camera.size = request.size;
  camera.position = {p[0], p[1], p[2]};
  camera.look_at = {p[3], p[4], p[5]};
  camera.up = {p[6], p[7], p[8]};
  camera.fov = p.size() == 10 ? p[9] : request.fov;
  return camera;
}

}  // namespace

void
ViewRequest::declareSize(OptionTable& table)
{
  table.text("size", &size_text, "WxH", "width and height in pixels");
}

void
ViewRequest::declareCamera(OptionTable& table)
{
  table.text(
      "view", &view, "NAME|AZ,EL",
      "auto, front, back, left, right, top, bottom, iso, or azimuth and elevation in degrees");
  table.choice("up", &up, {"auto", "x", "y", "z"}, "axis that points upwards");
  table.text("camera", &camera, "auto|PX,PY,PZ,LX,LY,LZ,UX,UY,UZ[,FOV]",
             "position, target and upward direction in world coordinates");
  table.number("fov", &fov, 1.0, 150.0, "vertical field of view in degrees");
  table.toggle("ortho", &orthographic, "parallel projection");
  table.exclusive({"camera", "view"});
  table.exclusive({"camera", "fov"});
}

Error
ViewRequest::parse()
{
  if (Error error = parseSize(size_text, size)) return error;
  if (Error error = parseView(view, angles)) return error;
  if (camera == "auto") return {};
  if (!parseNumberList(camera, pose) || (pose.size() != 9 && pose.size() != 10)) {
    return badOption(
        "-camera takes auto or nine or ten numbers separated by commas: position, "
        "target, upward direction and, if wanted, the field of view");
  }
  if (orthographic) {
    return badOption("-ortho frames the object itself: give -view instead of -camera");
  }
  return cameraOfPose(*this).validate();
}

Camera
ViewRequest::cameraFor(const BoundingSpheres& object) const
{
  if (!pose.empty()) return cameraOfPose(*this);
  UpAxis axis = upAxis(up);
  ViewDirection direction;
  if (angles.empty()) {
    direction = chooseView(object, axis);
  } else {
    if (axis == UpAxis::kAuto) axis = guessUpAxis(object);
    direction = viewFromAngles(axis, angles[0], angles[1]);
  }
  return orthographic ? fitOrthographicCamera(object, direction, size)
                      : fitCamera(object, direction, size, fov);
}

}  // namespace pcl_slim
