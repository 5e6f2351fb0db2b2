// SPDX-License-Identifier: BSD-3-Clause
// What a picture or a page shows and from where: keywords that all of them take.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "options.h"
#include "pcl_slim/render/auto_view.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/image.h"
#include "pcl_slim/render/shading.h"

namespace pcl_slim::python {

/** \brief The view of an object. */
struct ChosenView {
  Camera camera;
  std::array<double, 3> up{};  ///< of the object
  bool opens = false;  ///< drawn without its near side, which hides the inside that was scanned
};

/** \brief A camera as keywords give it: camera, size, up, fov and ortho. */
struct ViewRequest {
  std::optional<Camera> given;
  std::vector<double> angles;  ///< azimuth and elevation [degrees]; empty: chosen by the object
  UpAxis up = UpAxis::kAuto;
  double fov = 0;
  bool orthographic = false;
  ImageSize size;

  void take(Keywords& keywords);
  ChosenView viewOf(const BoundingSpheres& object, double right_margin) const;
};

/** \brief What colours show, and how: mode, range, map, bar, unit, lighting, ao, white, aa, sides,
 * near and threads. */
struct PictureRequest {
  std::string mode = "auto";
  ShadingParams shading;
  VisibleSides sides = VisibleSides::kAuto;
  double near_plane = 0;

  void take(Keywords& keywords);
  bool isTraced() const { return mode == "raytraced"; }
  /** \brief With the mode that suits a model. */
  ShadingParams shadingFor(bool has_colors) const;
  /** \brief Share of the width that the bar of colours takes. */
  double barShare(const ShadingParams& chosen, const ImageSize& size) const;
};

/** \brief A picture as an array (height, width, 4) of red, green, blue and 255. */
py::array_t<std::uint8_t> toArray(const Image& image);

void bindCamera(py::module_& m);

}  // namespace pcl_slim::python
