// SPDX-License-Identifier: BSD-3-Clause
#include "export/leaf_points.h"

#include <vtkPoints.h>
#include <vtkPolyData.h>

#include <algorithm>

namespace pcl_slim::detail {
namespace {

/** \brief Points with the bounds of balls around them, built one by one. */
class BallPoints {
 public:
  BallPoints() { points_->SetDataTypeToDouble(); }

  void add(const std::array<double, 3>& center, double radius)
  {
    points_->InsertNextPoint(center.data());
    for (std::size_t k = 0; k < 3; ++k) {
      const double low = center[k] - radius, high = center[k] + radius;
      bounds_[2 * k] = first_ ? low : std::min(bounds_[2 * k], low);
      bounds_[2 * k + 1] = first_ ? high : std::max(bounds_[2 * k + 1], high);
    }
    first_ = false;
  }

  vtkSmartPointer<vtkPolyData> finish(std::array<double, 6>& bounds) const
  {
    bounds = bounds_;
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_);
    return data;
  }

 private:
  vtkSmartPointer<vtkPoints> points_ = vtkSmartPointer<vtkPoints>::New();
  std::array<double, 6> bounds_{1.0, -1.0, 1.0, -1.0, 1.0, -1.0};
  bool first_ = true;
};

}  // namespace

vtkSmartPointer<vtkPolyData>
leafPoints(const SLIMSurface* surface, std::array<double, 6>& bounds)
{
  BallPoints points;
  for (std::size_t i = 0; surface && i < surface->size(); ++i) {
    if (!surface->isLeaf(i)) continue;
    const SurfaceInfo& info = surface->info;
    points.add({info.origin[0] + info.scale * double{surface->cx[i]},
                info.origin[1] + info.scale * double{surface->cy[i]},
                info.origin[2] + info.scale * double{surface->cz[i]}},
               info.scale * info.cover_radius * double{surface->radius[i]});
  }
  return points.finish(bounds);
}

vtkSmartPointer<vtkPolyData>
splatPoints(const SplatSet* splats, std::array<double, 6>& bounds)
{
  BallPoints points;
  for (std::size_t i = 0; splats && i < splats->size(); ++i) {
    points.add({splats->origin[0] + double{splats->x[i]}, splats->origin[1] + double{splats->y[i]},
                splats->origin[2] + double{splats->z[i]}},
               double{splats->radius[i]});
  }
  return points.finish(bounds);
}

}  // namespace pcl_slim::detail
