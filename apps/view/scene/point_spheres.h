// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim {

/** \brief A sample of a scan's points, with their normals where it has any, for the first camera: it then
 * is placed as for the fitted surface, or nearly so. Finite points only. O(sample). */
BoundingSpheres
spheresOfPoints(const CloudView& points);

}  // namespace pcl_slim
