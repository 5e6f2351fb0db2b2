// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include <array>

#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

class vtkPolyData;

namespace pcl_slim::detail {

/** \brief Centres of a surface's leaves as points without cells, double, world coordinates: what
 * VTK's point pickers look at. \param[out] bounds of the balls as far as the surface reaches;
 * VTK's empty ones for no leaf or a null surface. O(surfels). */
vtkSmartPointer<vtkPolyData>
leafPoints(const SLIMSurface* surface, std::array<double, 6>& bounds);

/** \brief The same of splats. O(splats). */
vtkSmartPointer<vtkPolyData>
splatPoints(const SplatSet* splats, std::array<double, 6>& bounds);

}  // namespace pcl_slim::detail
