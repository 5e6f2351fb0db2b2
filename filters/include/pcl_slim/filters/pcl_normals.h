// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>

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
 * cloud's sensor where none is set, at 0 if it is not known: faceNormals() turns them as all others.
 * Those that cannot be computed are NaN. \param[in] search
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

}  // namespace pcl_slim
