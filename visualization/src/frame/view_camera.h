// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/core/error.h"
#include "pcl_slim/render/camera.h"

namespace pcl_slim::detail {

/** \brief A 4 x 4 matrix, rows first, that acts on columns. */
using Matrix4 = std::array<double, 16>;

/** \brief A view as OpenGL has it. */
struct GLView {
  Matrix4 model_to_view;      ///< a rotation, a scale alike in all directions and a shift
  Matrix4 projection;         ///< a pinhole or a parallel one; off the axis and of any aspect
  int width = 0, height = 0;  ///< of the viewport, pixels
};

/** \brief The same view as a rasteriser's camera, and the way back for a shader.
 *
 * A ray at normalised device coordinates (x, y) meets the plane at unit depth (a pinhole), or any
 * plane (parallel), at view coordinates (x_scale x + x_shift, y_scale y + y_shift). A point at
 * depth t of its ray is at view-space distance view_scale t + start.
 */
struct ViewCamera {
  Camera camera;  ///< in the model's coordinates
  bool parallel = false;
  double x_scale = 1.0, x_shift = 0.0, y_scale = 1.0, y_shift = 0.0;
  double view_scale = 1.0;                ///< view-space length of a unit of the model
  double start = 0.0;                     ///< parallel: where rays begin
  std::array<double, 9> rotation{};       ///< model to view, rows first
  double near_plane = 0.0;                ///< model units along the ray
  double texels_x = 1.0, texels_y = 1.0;  ///< of the camera's picture, per viewport pixel
};

/** \brief Translates a view. \param[in] near_distance view-space distance of the near plane, of a
 * parallel view also below 0; \param[in] coarseness viewport pixels from one ray to the next, a
 * whole number >= 1.
 * \return an error for a matrix with shear, mirror or unequal scales, which no camera has. */
Error
translateView(const GLView& view, double near_distance, int coarseness, ViewCamera& result);

/** \brief The camera of the one ray through pixel (column, row) of another, rows from the top. */
Camera
cameraOfPixel(const Camera& camera, double column, double row);

}  // namespace pcl_slim::detail
