// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>

#include <array>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/slim_fit_base.h"

namespace pcl_slim {

/** \brief A PCL cloud, and what the setters of a class say about it. */
template <typename PointT>
struct CloudInput {
  typename pcl::PointCloud<PointT>::ConstPtr cloud;
  pcl::IndicesConstPtr indices;                      ///< points to use; null: all
  pcl::PointCloud<pcl::Normal>::ConstPtr normals;    ///< null: estimated ones, or those of PointT
  typename pcl::search::Search<PointT>::Ptr search;  ///< for estimated normals; null: one of ours
  int normal_neighbours = 0;  ///< of estimated normals; 0: none are estimated
  SensorPositions sensors;    ///< null: the fields vp_x vp_y vp_z of PointT
  FrameNumbers frames;        ///< null: not known
};

/** \brief A view of a PCL cloud, valid while this object lives. */
struct DescribedCloud {
  CloudView view;
  std::vector<float> estimated;  ///< normals, three floats a point, which view refers to
  std::array<pcl::shared_ptr<const void>, 5> kept;  ///< what else view refers to

  DescribedCloud() = default;
  DescribedCloud(DescribedCloud&&) = default;
  DescribedCloud& operator=(DescribedCloud&&) = default;
};

/** \brief Describes a cloud's points to the modules; estimates normals if they are requested.
 * \param[in] params gives the viewpoint and threads. \return an error for a missing or empty cloud,
 * indices out of range, and normals, sensors or frames that do not fit the cloud. Compiled for all
 * of PCL_XYZ_POINT_TYPES; other types include impl/cloud_description.hpp. */
template <typename PointT>
PCL_SLIM_EXPORT Result<DescribedCloud> describeCloud(const CloudInput<PointT>& input,
                                                     const FitParams& params);

}  // namespace pcl_slim
