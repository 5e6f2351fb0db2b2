// SPDX-License-Identifier: BSD-3-Clause
#include "frame/vtk_view.h"

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
#include <limits>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {
namespace {

/** \brief View-space distance of the nearest corner of a box. */
double
nearestCorner(const Matrix4& model_to_view, const std::array<double, 6>& bounds)
{
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

VtkView
viewOf(vtkRenderer* renderer, vtkActor* actor, const std::array<double, 6>& bounds, int width,
       int height)
{
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

std::vector<HalfSpace>
clipPlanesOf(vtkMapper* mapper, vtkActor* actor)
{
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

bool
isInteracting(vtkRenderer* renderer)
{
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
