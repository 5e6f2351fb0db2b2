// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/io.h>
#include <pcl/console/print.h>
#include <pcl/surface/processing.h>

#include <type_traits>
#include <utility>

#include "pcl_slim/filters/impl/cloud_description.hpp"
#include "pcl_slim/filters/slim_projection_smoother.h"

namespace pcl_slim {

template <typename PointInT, typename PointOutT>
void
SLIMProjectionSmoother<PointInT, PointOutT>::process(PointCloudOut& output)
{
  clearResults();
  PointCloudOut made;  // apart, because output may be the input
  performProcessing(made);
  if (error_) {
    made = PointCloudOut();
    if (error_.code != ErrorCode::kCancelled) {
      PCL_ERROR("[pcl_slim::SLIMProjectionSmoother::process] %s\n", error_.message.c_str());
    }
  }
  if (!getWarning().empty()) {
    PCL_WARN("[pcl_slim::SLIMProjectionSmoother::process] %s; the points stay as they are\n",
             getWarning().c_str());
  }
  output = std::move(made);
}

template <typename PointInT, typename PointOutT>
void
SLIMProjectionSmoother<PointInT, PointOutT>::performProcessing(PointCloudOut& output)
{
  CloudDescription<PointInT> description(input_, use_indices_ ? indices_ : nullptr, params_,
                                         sensors_, frames_);
  description.setInputNormals(normals_);
  description.setSearchMethod(search_);
  description.setNormalEstimationNeighbors(normal_neighbours_);
  bool dense = true;
  const bool own = run(source(description), target(output), dense);
  if (error_) return;
  if (own && !(use_indices_ && indices_) &&
      static_cast<std::size_t>(input_->width) * input_->height == output.size()) {
    output.width = input_->width;
    output.height = input_->height;
  }
  output.header = input_->header;
  output.sensor_origin_ = input_->sensor_origin_;
  output.sensor_orientation_ = input_->sensor_orientation_;
  output.is_dense = dense;
}

template <typename PointInT, typename PointOutT>
auto
SLIMProjectionSmoother<PointInT, PointOutT>::source(CloudDescription<PointInT>& description) const
    -> Source
{
  Source source;
  source.step = sizeof(PointInT);
  if (input_) source.points = reinterpret_cast<const unsigned char*>(input_->points.data());
  if (use_indices_ && indices_) source.indices = indices_.get();
  source.has_distinct = distinct_cloud_ != nullptr;
  if (distinct_cloud_ && !distinct_cloud_->empty()) {
    source.distinct.size = distinct_cloud_->size();
    source.distinct.xyz = reinterpret_cast<const unsigned char*>(distinct_cloud_->points.data()) +
                          pcl::traits::offset<PointInT, pcl::fields::x>::value;
    source.distinct.xyz_stride = sizeof(PointInT);
  }
  source.describe = [&description](CloudView& view) {
    if (!description.describe()) return description.getError();
    view = description.view();
    return Error();
  };
  return source;
}

template <typename PointInT, typename PointOutT>
auto
SLIMProjectionSmoother<PointInT, PointOutT>::target(PointCloudOut& output) -> Target
{
  namespace fields = pcl::fields;
  using pcl::traits::offset;
  static_assert(std::is_same<decltype(PointOutT::x), float>::value &&
                    offset<PointOutT, fields::z>::value - offset<PointOutT, fields::x>::value == 8,
                "x y z are written as three floats in a row");
  Target target;
  target.step = sizeof(PointOutT);
  target.position = offset<PointOutT, fields::x>::value;
  if constexpr (pcl::traits::has_normal<PointOutT>::value) {
    target.normal = offset<PointOutT, fields::normal_x>::value;
    static_assert(
        offset<PointOutT, fields::normal_z>::value - offset<PointOutT, fields::normal_x>::value ==
            8,
        "normals are written as three floats in a row");
  }
  if constexpr (pcl::traits::has_curvature<PointOutT>::value)
    target.curvature = offset<PointOutT, fields::curvature>::value;
  target.copy = [](const void* from, void* to) {
    pcl::copyPoint(*static_cast<const PointInT*>(from), *static_cast<PointOutT*>(to));
  };
  target.resize = [&output](std::size_t count) {
    output.resize(count);
    return reinterpret_cast<unsigned char*>(output.points.data());
  };
  return target;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother(In, Out) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMProjectionSmoother<In, Out>;
