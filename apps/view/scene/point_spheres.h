// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/render/bounding_spheres.h"

namespace pcl_slim {

/** \brief A sample of a scan's points, with their normals where it has any, for a camera to look at: it then
 * stands where it will for the fitted surface, or nearly so. Finite points alone. O(sample). */
BoundingSpheres
spheresOfPoints(const CloudView& points);

}  // namespace pcl_slim
