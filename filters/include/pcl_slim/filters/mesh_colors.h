// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/mesh/triangle_mesh.h"

namespace pcl_slim {

/** \brief Colours a mesh's vertices: each gets the mean of the four points nearest to it, weighed
 * by the inverse of their squared distance.
 *
 * \param[in] cloud points in the mesh's coordinates; those that are not finite do not count.
 * \param[in] colors one for each of its points. \return an error for a cloud without finite points
 * or without colours. O((V + N) log N); the same for any number of threads.
 */
PCL_SLIM_EXPORT Error colorFromPoints(const CloudView& cloud, const ColorView& colors, int threads,
                                      TriangleMesh& mesh);

}  // namespace pcl_slim
