// SPDX-License-Identifier: BSD-3-Clause
#include <vtkActor.h>
#include <vtkInteractorStyleSwitch.h>
#include <vtkMapper.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkOpenGLCamera.h>
#include <vtkPlane.h>
#include <vtkPlaneCollection.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "frame/frame.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {
namespace {

/** \brief Rotation and scale of a matrix. \return false unless it is a similarity that keeps
 * right hands right. */
bool splitSimilarity(const Matrix4& m, std::array<double, 9>& rotation, double& scale) {
  constexpr double kTolerance = 1e-5;
  const Vector3 rows[3] = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}};
  const double determinant = dot(rows[0], cross(rows[1], rows[2]));
  if (!(determinant > 0.0) || !std::isfinite(determinant)) return false;
  scale = std::cbrt(determinant);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double expected = i == j ? 1.0 : 0.0;
      if (std::abs(dot(rows[i], rows[j]) / (scale * scale) - expected) > kTolerance) return false;
    }
    const Vector3 axis = normalized(rows[i]);
    std::copy(axis.begin(), axis.end(), rotation.begin() + 3 * i);
  }
  return true;
}

/** \brief The viewer's position in the model's coordinates: the origin of view space. */
Vector3 eyeOf(const Matrix4& m, const std::array<double, 9>& r, double scale) {
  Vector3 eye{};
  for (std::size_t k = 0; k < 3; ++k) {
    eye[k] = -(r[k] * m[3] + r[3 + k] * m[7] + r[6 + k] * m[11]) / scale;
  }
  return eye;
}

/** \brief Fills in size, opening and shift of the picture. \param[in] view_height of the whole
 * viewport on the image plane. */
void setPicture(const GLView& view, double view_height, double shift_x, double shift_y,
                double spacing, ViewCamera& result) {
  Camera& camera = result.camera;
  // Pixels of the camera are square: one whose pixels are not has another number of columns.
  const double columns = std::max(1.0, std::round(view.height * result.x_scale / result.y_scale));
  const double pixel = view_height / view.height;
  camera.size.width = static_cast<int>(std::ceil(columns / spacing));
  camera.size.height = static_cast<int>(std::ceil(view.height / spacing));
  // A coarse pixel's ray passes through the middle of the pixels it replaces, and those of a fine one
  // are spread evenly.
  const auto offset = [spacing](double fine_count, int coarse_count, double fine_shift) {
    const double center = 0.5 * (fine_count - 1.0) - fine_shift;
    return 0.5 * (coarse_count - 1.0) - (center - 0.5 * (spacing - 1.0)) / spacing;
  };
  camera.pixel_offset = {offset(columns, camera.size.width, shift_x / pixel),
                         offset(view.height, camera.size.height, -shift_y / pixel)};
  const double coarse_height = camera.size.height * spacing * pixel;
  if (result.parallel) {
    camera.view_height = coarse_height / result.view_scale;
  } else {
    camera.fov = 2.0 * std::atan(0.5 * coarse_height) * 180.0 / M_PI;
  }
  result.texels_x = columns / view.width / spacing;
  result.texels_y = 1.0 / spacing;
}

}  // namespace

Error translateView(const GLView& view, double near_distance, double spacing, ViewCamera& result) {
  const Matrix4& p = view.projection;
  result.parallel = p[15] != 0.0;
  if (!splitSimilarity(view.model_to_view, result.rotation, result.view_scale)) {
    return {ErrorCode::kBadArgument,
            "the actor's matrix shears, mirrors or scales unequally, and curved surfels cannot "
            "follow; give it rotation, position and one scale only"};
  }
  if (!(p[0] > 0.0 && p[5] > 0.0) || view.width < 1 || view.height < 1) {
    return {ErrorCode::kBadArgument,
            "the camera's projection or the viewport is empty; give the window a size"};
  }
  result.x_scale = 1.0 / p[0];
  result.y_scale = 1.0 / p[5];
  result.x_shift = result.parallel ? -p[3] / p[0] : p[2] / p[0];
  result.y_shift = result.parallel ? -p[7] / p[5] : p[6] / p[5];

  Camera& camera = result.camera;
  camera.projection =
      result.parallel ? Camera::Projection::kOrthographic : Camera::Projection::kPerspective;
  const auto& r = result.rotation;
  const Vector3 forward{-r[6], -r[7], -r[8]};
  result.start = result.parallel ? near_distance : 0.0;
  result.near_plane = result.parallel ? 0.0 : std::max(0.0, near_distance) / result.view_scale;
  const Vector3 eye = eyeOf(view.model_to_view, r, result.view_scale);
  camera.position = along(eye, result.start / result.view_scale, forward);
  // Far enough that the difference of two large coordinates still gives the direction.
  const double reach = std::max(length(camera.position), 1.0 / result.view_scale);
  camera.look_at = along(camera.position, reach, forward);
  camera.up = {r[3], r[4], r[5]};
  setPicture(view, 2.0 * result.y_scale, result.x_shift, result.y_shift, spacing, result);
  return camera.validate();
}

Camera cameraOfPixel(const Camera& camera, double column, double row) {
  Camera pixel = camera;
  pixel.size = {1, 1};
  pixel.pixel_offset = {column - 0.5 * (camera.size.width - 1) + camera.pixel_offset[0],
                        row - 0.5 * (camera.size.height - 1) + camera.pixel_offset[1]};
  const double height = camera.size.height;
  pixel.fov = 2.0 * std::atan(std::tan(camera.fov * M_PI / 360.0) / height) * 180.0 / M_PI;
  pixel.view_height = camera.view_height / height;
  return pixel;
}

namespace {

/** \brief View-space distance of the nearest corner of a box. */
double nearestCorner(const Matrix4& model_to_view, const std::array<double, 6>& bounds) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t corner = 0; corner < 8; ++corner) {
    double z = model_to_view[11];
    for (std::size_t k = 0; k < 3; ++k) {
      z += model_to_view[8 + k] * bounds[2 * k + ((corner >> k) & 1)];
    }
    nearest = std::min(nearest, -z);
  }
  return nearest;
}

}  // namespace

VtkView viewOf(vtkRenderer* renderer, vtkActor* actor, const std::array<double, 6>& bounds,
               int width, int height) {
  VtkView view;
  auto* camera = static_cast<vtkOpenGLCamera*>(renderer->GetActiveCamera());
  vtkMatrix4x4 *world_to_view = nullptr, *projection = nullptr, *both = nullptr;
  vtkMatrix3x3* normals = nullptr;
  camera->GetKeyMatrices(renderer, world_to_view, normals, projection, both);
  // These matrices come transposed, as OpenGL takes them.
  vtkNew<vtkMatrix4x4> view_matrix;
  vtkMatrix4x4::Transpose(world_to_view, view_matrix);
  vtkMatrix4x4::Multiply4x4(view_matrix, actor->GetMatrix(), view_matrix);
  std::copy_n(view_matrix->GetData(), 16, view.gl.model_to_view.begin());
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      view.gl.projection[static_cast<std::size_t>(4 * i + j)] = projection->GetElement(j, i);
    }
  }
  view.gl.width = width;
  view.gl.height = height;

  const double near_distance = camera->GetClippingRange()[0];
  const double nearest = nearestCorner(view.gl.model_to_view, bounds);
  view.near_distance = near_distance;
  if (nearest > near_distance) view.near_distance = camera->GetParallelProjection() ? nearest : 0.0;
  return view;
}

std::vector<HalfSpace> clipPlanesOf(vtkMapper* mapper, vtkActor* actor) {
  std::vector<HalfSpace> planes;
  vtkPlaneCollection* collection = mapper->GetClippingPlanes();
  if (!collection) return planes;
  for (int i = 0; i < collection->GetNumberOfItems(); ++i) {
    // A plane n.x + d = 0 of the scene is the plane (n, d) M of the actor's own coordinates.
    vtkPlane* plane = collection->GetItem(i);
    const double *n = plane->GetNormal(), *o = plane->GetOrigin();
    const double in[4] = {n[0], n[1], n[2], -(n[0] * o[0] + n[1] * o[1] + n[2] * o[2])};
    double out[4] = {0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < 4; ++k) {
      for (int j = 0; j < 4; ++j) out[k] += in[j] * actor->GetMatrix()->GetElement(j, k);
    }
    const double norm = length({out[0], out[1], out[2]});
    if (!(norm > 0.0)) continue;
    planes.push_back({{out[0] / norm, out[1] / norm, out[2] / norm}, -out[3] / norm});
  }
  return planes;
}

bool isInteracting(vtkRenderer* renderer) {
  vtkRenderWindowInteractor* interactor = renderer->GetRenderWindow()->GetInteractor();
  if (!interactor) return false;
  vtkInteractorObserver* observer = interactor->GetInteractorStyle();
  if (auto* chosen = vtkInteractorStyleSwitch::SafeDownCast(observer)) {
    observer = chosen->GetCurrentStyle();
  }
  auto* style = vtkInteractorStyle::SafeDownCast(observer);
  return style && style->GetState() != VTKIS_NONE;
}

}  // namespace pcl_slim::detail
