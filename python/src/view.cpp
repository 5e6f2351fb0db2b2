// SPDX-License-Identifier: BSD-3-Clause
#include "view.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "work.h"

namespace pcl_slim::python {

namespace {

constexpr double kMargin = 0.04;  ///< share of the picture, on each side
constexpr int kMostSide = 32768;  ///< pixels

struct NamedView {
  const char* name;
  std::array<double, 2> angles;
};
constexpr NamedView kNamed[] = {{"front", {0, 0}},
                                {"back", {180, 0}},
                                {"left", {-90, 0}},
                                {"right", {90, 0}},
                                {"top", {0, 90}},
                                {"bottom", {0, -90}},
                                {"iso", {45, 35.264389682754654}}};

constexpr const char* kViews =
    "camera takes None, front, back, left, right, top, bottom, iso, two angles in degrees such as "
    "(30, 20), or a Camera";

std::vector<double> anglesOf(const py::object& given) {
  if (given.is_none()) return {};
  if (py::isinstance<py::str>(given)) {
    const auto name = given.cast<std::string>();
    if (name == "auto") return {};
    for (const NamedView& view : kNamed) {
      if (name == view.name) return {view.angles.begin(), view.angles.end()};
    }
    raiseValue(kViews);
  }
  try {
    const auto angles = given.cast<std::array<double, 2>>();
    if (std::isfinite(angles[0]) && std::isfinite(angles[1])) return {angles[0], angles[1]};
  } catch (const py::cast_error&) {
  }
  raiseValue(kViews);
}

ImageSize sizeOf(const py::object& given) {
  ImageSize size;
  if (given.is_none()) return size;
  try {
    const auto pixels = given.cast<std::array<int, 2>>();
    size = {pixels[0], pixels[1]};
    if (std::min(size.width, size.height) > 0 && std::max(size.width, size.height) <= kMostSide)
      return size;
  } catch (const py::cast_error&) {
  }
  raiseValue("size takes width and height in pixels, 1 to 32768, as (800, 600)");
}

UpAxis axisOf(const std::string& name) {
  for (const UpAxis axis :
       {UpAxis::kX, UpAxis::kY, UpAxis::kZ, UpAxis::kMinusX, UpAxis::kMinusY, UpAxis::kMinusZ}) {
    if (nameOf(axis) == name) return axis;
  }
  return UpAxis::kAuto;
}

/** None, X or (LO, HI). */
std::array<double, 2> rangeOf(const py::object& given, const std::string& mode) {
  if (given.is_none()) return {};
  const bool from_zero = mode == "error" || mode == "uncertainty";
  try {
    const auto ends =
        py::isinstance<py::sequence>(given)
            ? given.cast<std::array<double, 2>>()
            : std::array<double, 2>{from_zero ? 0 : -given.cast<double>(), given.cast<double>()};
    if (std::isfinite(ends[0]) && std::isfinite(ends[1]) && ends[0] < ends[1]) return ends;
  } catch (const py::cast_error&) {
  }
  raiseValue("range takes None, a number above 0, or two numbers, the lower one first");
}

Camera makeCamera(const py::object& position, const py::object& look_at, const py::object& up,
                  double fov, const py::object& view_height) {
  Camera camera;
  camera.position = readPlace(position, "position").value_or(camera.position);
  camera.look_at = readPlace(look_at, "look_at").value_or(camera.look_at);
  camera.up = readPlace(up, "up").value_or(camera.up);
  camera.fov = fov;
  if (!view_height.is_none()) {
    camera.projection = Camera::Projection::kOrthographic;
    camera.view_height = view_height.cast<double>();
  }
  if (Error error = camera.validate()) raise(error);
  return camera;
}

std::string textOf(const std::array<double, 3>& place) {
  char text[96];
  std::snprintf(text, sizeof(text), "(%.10g, %.10g, %.10g)", place[0], place[1], place[2]);
  return text;
}

std::string describe(const Camera& camera) {
  const bool parallel = camera.projection == Camera::Projection::kOrthographic;
  char last[64];
  std::snprintf(last, sizeof(last), parallel ? "view_height=%.10g" : "fov=%.10g",
                parallel ? camera.view_height : camera.fov);
  return "pcl_slim.Camera(position=" + textOf(camera.position) +
         ", look_at=" + textOf(camera.look_at) + ", up=" + textOf(camera.up) + ", " + last + ")";
}

}  // namespace

void ViewRequest::take(Keywords& keywords) {
  const py::object camera = keywords.take("camera");
  size = sizeOf(keywords.take("size"));
  up = axisOf(keywords.takeWord("up", {"auto", "x", "y", "z", "-x", "-y", "-z"}, "auto"));
  fov = keywords.takeNumber("fov", 1, 150, 0);
  orthographic = keywords.takeSwitch("ortho", false);
  if (!py::isinstance<Camera>(camera)) {
    angles = anglesOf(camera);
    return;
  }
  if (orthographic || fov > 0)
    raiseValue("ortho and fov are of a camera that is chosen: give them to Camera()");
  given = camera.cast<Camera>();
  given->size = size;
}

ChosenView ViewRequest::viewOf(const BoundingSpheres& object, double right_margin) const {
  const SceneView scene = chooseView(object, up);
  ChosenView chosen;
  chosen.up = scene.up;
  if (given) {
    chosen.camera = *given;
    return chosen;
  }
  chosen.opens = scene.opens;
  if (angles.empty() && !orthographic && scene.amid) {
    chosen.camera = cameraFor(scene, object, size, fov);
    return chosen;
  }
  const ViewDirection direction =
      angles.empty() ? scene.direction : viewFromAngles(scene.axis, angles[0], angles[1]);
  chosen.camera =
      orthographic
          ? fitOrthographicCamera(object, direction, size, kMargin, right_margin)
          : fitCamera(object, direction, size, fov > 0 ? fov : Camera().fov, kMargin, right_margin);
  return chosen;
}

void PictureRequest::take(Keywords& keywords) {
  mode = keywords.takeWord("mode",
                           {"auto", "shaded", "normal", "mean", "gauss", "kmax", "kmin", "level",
                            "size", "error", "reflection", "color", "uncertainty", "raytraced"},
                           "auto");
  shading.range = rangeOf(keywords.take("range"), mode);
  const std::string map = keywords.takeWord("map", {"auto", "diverging", "perceptual"}, "auto");
  shading.map = map == "diverging"    ? ColorMap::kDiverging
                : map == "perceptual" ? ColorMap::kPerceptual
                                      : ColorMap::kAuto;
  shading.color_bar = keywords.takeSwitch("bar", false);
  if (const py::object unit = keywords.take("unit"); !unit.is_none())
    shading.unit = py::str(unit).cast<std::string>();
  shading.lighting = keywords.takeSwitch("lighting", true);
  shading.ambient_occlusion = keywords.takeNumber("ao", 0, 1, shading.ambient_occlusion);
  shading.gradient_background = !keywords.takeSwitch("white", false);
  shading.supersampling = static_cast<int>(keywords.takeInteger("aa", 1, 8, shading.supersampling));
  const std::string side = keywords.takeWord("sides", {"auto", "front", "both"}, "auto");
  sides = side == "front"  ? VisibleSides::kFront
          : side == "both" ? VisibleSides::kBoth
                           : VisibleSides::kAuto;
  near_plane = keywords.takeNumber("near", 0, 1e300, 0);
  shading.threads = keywords.takeThreads();
}

ShadingParams PictureRequest::shadingFor(bool has_colors) const {
  ShadingParams chosen = shading;
  const std::string automatic = has_colors ? "color" : "shaded";
  chosen.mode = *shadingModeOf(mode == "auto" || isTraced() ? automatic : mode);
  if (Error error = chosen.validate()) raise(error);
  return chosen;
}

double PictureRequest::barShare(const ShadingParams& chosen, const ImageSize& size) const {
  return chosen.color_bar && hasColorBar(chosen.mode) ? colorBarShare(size) : 0;
}

py::array_t<std::uint8_t> toArray(const Image& image) {
  auto array = newArray<std::uint8_t>({image.height, image.width, 4});
  std::uint8_t* pixel = array.mutable_data();
  for (std::size_t i = 0; i < image.rgb.size(); i += 3, pixel += 4) {
    std::copy_n(image.rgb.data() + i, 3, pixel);
    pixel[3] = 255;
  }
  return array;
}

void bindCamera(py::module_& m) {
  py::class_<Camera>(
      m, "Camera",
      "Camera(position, look_at, up=(0, 0, 1), *, fov=30.0, view_height=None)\n\n"
      "A camera in the coordinates of the points. fov: vertical opening [degrees]; "
      "view_height: height of the picture [unit of the points], for parallel projection.")
      .def(py::init(&makeCamera), py::arg("position"), py::arg("look_at"),
           py::arg("up") = py::make_tuple(0, 0, 1), py::kw_only(), py::arg("fov") = 30.0,
           py::arg("view_height") = py::none())
      .def_readonly("position", &Camera::position, "Place of the camera.")
      .def_readonly("look_at", &Camera::look_at, "The place in the middle of the picture.")
      .def_readonly("up", &Camera::up, "The direction that points upwards in the picture.")
      .def_readonly("fov", &Camera::fov, "Vertical opening [degrees].")
      .def("__repr__", &describe);
}

}  // namespace pcl_slim::python
