// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkSmartPointer.h>

#include "pcl_slim/core/export.h"
#include "pcl_slim/splat/splat_set.h"
#include "pcl_slim/surface/surface.h"

class vtkPolyData;

namespace pcl_slim {

/** \brief A surface's surfels as VTK points, for ParaView or a glyph filter; no window is needed.
 *
 * One point and one vertex cell a surfel, in their order: "Normals", and the arrays radius, c0 c1
 * ..., degree, level, leaf, error and confidence of PointSLIM, as saveSurface() writes them to a
 * .vtp file; lengths in world units. Coordinates are the world's, in double. O(surfels).
 * \param[in] leaves_only leaves out the internal surfels of the hierarchy.
 */
PCL_SLIM_EXPORT vtkSmartPointer<vtkPolyData> toPolyData(const SLIMSurface& surface,
                                                        bool leaves_only = false);

/** \brief Splats likewise: "Normals", "RGB" (the scalars), radius, confidence and curvature. */
PCL_SLIM_EXPORT vtkSmartPointer<vtkPolyData> toPolyData(const SplatSet& splats);

}  // namespace pcl_slim
