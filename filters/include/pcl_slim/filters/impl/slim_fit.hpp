// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/filters/impl/cloud_description.hpp"
#include "pcl_slim/filters/impl/color_view.hpp"
#include "pcl_slim/filters/slim_fit.h"

namespace pcl_slim {

template <typename PointT>
CloudInput<PointT> SLIMFit<PointT>::cloudInput() const {
  return {
      input_, use_indices_ ? indices_ : nullptr, normals_, search_, normal_neighbours_, sensors_,
      frames_};
}

template <typename PointT>
bool SLIMFit<PointT>::fit(SLIMSurface& surface) {
  surface = SLIMSurface();
  clearResults();
  const Result<DescribedCloud> cloud = describeCloud(cloudInput(), params_);
  if (!cloud) return fail(cloud.error().code, cloud.error().message);
  return run({cloud->view, colors_ ? colorsOfPoints(*input_) : ColorView()}, params_, surface);
}

template <typename PointT>
bool SLIMFit<PointT>::fit(pcl::PointCloud<PointSLIM>& surfels, SurfaceMetadata* metadata) {
  surfels = pcl::PointCloud<PointSLIM>();
  if (metadata) *metadata = SurfaceMetadata();
  SLIMSurface surface;
  const auto input = input_;
  if (!fit(surface)) return false;
  const SurfaceMetadata made = toPCL(surface, surfels);
  surfels.header = input->header;
  if (metadata) *metadata = made;
  return true;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMFit(PointT)                                                   \
  template PCL_SLIM_EXPORT pcl_slim::Result<pcl_slim::DescribedCloud> pcl_slim::describeCloud( \
      const pcl_slim::CloudInput<PointT>&, const pcl_slim::FitParams&);                        \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMFit<PointT>;
