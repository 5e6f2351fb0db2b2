// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include "pcl_slim/core/scalar_type.h"
#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/slim_deviation.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/cloud_description.hpp"
#endif

namespace pcl_slim {

template <typename PointT>
void SLIMDeviation<PointT>::setReference(const typename PointCloud::ConstPtr& cloud) {
  reference_cloud_ = cloud;
  given_reference_ = {};
}

template <typename PointT>
void SLIMDeviation<PointT>::setReference(const SurfaceConstPtr& surface) {
  reference_cloud_.reset();
  given_reference_ = {surface, nullptr};
}

template <typename PointT>
void SLIMDeviation<PointT>::setReference(const pcl::PolygonMesh::ConstPtr& mesh) {
  reference_cloud_.reset();
  given_reference_ = {nullptr, mesh};
}

template <typename PointT>
bool SLIMDeviation<PointT>::compute(pcl::PointCloud<PointDeviation>& output) {
  output = pcl::PointCloud<PointDeviation>();
  clearResults();
  const auto input = input_;  // a callback may set another
  const pcl::IndicesConstPtr indices = use_indices_ ? indices_ : nullptr;
  const Result<DescribedCloud> points =
      describeCloud<PointT>({input, indices, normals_, {}, 0, sensors_, frames_}, params_);
  if (!points) return fail(points.error().code, points.error().message);
  Result<DescribedCloud> reference = DescribedCloud();
  const auto other = reference_cloud_;
  if (other) {
    reference = describeCloud<PointT>({other, {}, {}, {}, 0, {}, {}}, params_);
    if (!reference)
      return fail(reference.error().code, "the reference: " + reference.error().message);
  }
  PlaceColumns places;
  Deviations deviations;
  if (!compare(points->view, other ? &reference->view : nullptr, places, deviations)) return false;
  output.header = input->header;
  write(places, deviations, output);
  if (!indices) {
    output.width = input->width;
    output.height = input->height;
  }
  return true;
}

template <typename PointT>
void SLIMDeviation<PointT>::write(const PlaceColumns& places, const Deviations& deviations,
                                  pcl::PointCloud<PointDeviation>& output) const {
  output.resize(deviations.size());
  output.is_dense = true;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    PointDeviation& to = output[i];
    to.x = finiteFloat(places.positions[i][0]);
    to.y = finiteFloat(places.positions[i][1]);
    to.z = finiteFloat(places.positions[i][2]);
    to.sigma_position = places.sigma.empty() ? 0.0f : places.sigma[i];
    to.deviation = deviations.distance[i];
    to.level_of_detection = deviations.detection[i];
    const DeviationClass found = deviations.classOf(i);
    to.significant = found == DeviationClass::kSignificant ? 1
                     : found == DeviationClass::kSame      ? 0
                                                           : -1;
    if (std::isnan(to.deviation)) output.is_dense = false;
  }
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMDeviation(In) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMDeviation<In>;
