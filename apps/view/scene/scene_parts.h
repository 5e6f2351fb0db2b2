// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

class vtkActor;

namespace pcl_slim {

/** \brief A scan's finite points, two pixels wide, in their colours if they have any. O(points). */
vtkSmartPointer<vtkActor>
makePoints(const CloudView& points, const ColorView& colors);

/** \brief The balls of a surface's leaves as far as they cover, small red to large blue (Fig. 1 of
 * Ohtake, Belyaev, Alexa 2005). O(leaves). */
vtkSmartPointer<vtkActor>
makeBalls(const SLIMSurface& surface);

/** \brief Normals of leaves or splats as lines of half a radius. O(leaves or splats). */
vtkSmartPointer<vtkActor>
makeNormals(const SLIMSurface& surface);
vtkSmartPointer<vtkActor>
makeNormals(const SplatSet& splats);

}  // namespace pcl_slim
