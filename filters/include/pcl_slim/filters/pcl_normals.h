// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>

#include <vector>
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/fit/fit.h"

namespace pcl_slim {

/** \brief A search object that suits a cloud and contains it: OrganizedNeighbor for an organized
 * cloud seen by one camera, otherwise KdTree. is_dense must be honest. */
PCL_SLIM_EXPORT pcl::search::Search<pcl::PointXYZ>::Ptr makeSearch(
    const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud);

/** \brief Normals of the selected, finite points, as pcl::NormalEstimation computes them.
 *
 * Every point of the cloud may be a neighbour. Normals face the viewpoint of params, or the
 * cloud's sensor where none is set; those that cannot be computed are NaN. \param[in] search
 * contains the cloud. \param[out] normals one for each selected point.
 * \return an error for more neighbours than there are finite points, or fewer than 3; for a bad
 * number of threads; and for coordinates whose squares a float cannot represent, which PCL's
 * searches use. May throw what PCL throws.
 */
PCL_SLIM_EXPORT Error pclNormals(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud,
                                 const pcl::IndicesConstPtr& selected,
                                 const pcl::search::Search<pcl::PointXYZ>::Ptr& search,
                                 int neighbours, const FitParams& params,
                                 pcl::PointCloud<pcl::Normal>& normals);

/** \brief Turns normals to the sensors of their points. \param[in] view a view with sensors
 * \param[in,out] normals three floats for each point of view; zero or NaN ones stay as they are */
PCL_SLIM_EXPORT void faceSensors(const CloudView& view, std::vector<float>& normals);

}  // namespace pcl_slim
