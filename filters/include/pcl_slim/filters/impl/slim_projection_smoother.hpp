// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/io.h>
#include <pcl/console/print.h>
#include <pcl/surface/processing.h>

#include <exception>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include "pcl_slim/core/parallel.h"
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
  corresponding_.reset();
  CloudDescription<PointInT> description(input_, use_indices_ ? indices_ : nullptr, params_,
                                         sensors_);
  description.setInputNormals(normals_);
  description.setSearchMethod(search_);
  description.setNormalEstimationNeighbors(normal_neighbours_);
  try {
    corresponding_ = std::make_shared<pcl::PointIndices>();
    error_ = checkSmoother(distinct_cloud_ != nullptr);
    if (error_) return;
    if (!description.describe()) {
      error_ = description.getError();
      return;
    }
    CloudProjection projection;
    if (!smooth(description.view(), writesCurvature(), projection)) return;
    if (upsampling_ == NONE || !getWarning().empty())
      write(projection, output);
    else
      writeUpsampled(description.view(), projection, output);
  } catch (const std::exception& failure) {
    fail(ErrorCode::kBadInput, std::string("smoothing stopped: ") + failure.what());
  }
}

template <typename PointInT, typename PointOutT>
std::size_t
SLIMProjectionSmoother<PointInT, PointOutT>::inputOf(std::size_t i) const
{
  return use_indices_ && indices_ ? static_cast<std::size_t>((*indices_)[i]) : i;
}

template <typename PointInT, typename PointOutT>
void
SLIMProjectionSmoother<PointInT, PointOutT>::write(const CloudProjection& projection,
                                                   PointCloudOut& output)
{
  const bool some = use_indices_ && indices_;
  output.resize(projection.size());
  if (!some && static_cast<std::size_t>(input_->width) * input_->height == output.size()) {
    output.width = input_->width;
    output.height = input_->height;
  }
  output.header = input_->header;
  output.sensor_origin_ = input_->sensor_origin_;
  output.sensor_orientation_ = input_->sensor_orientation_;
  output.is_dense = projection.statistics().non_finite == 0;
  corresponding_->indices.resize(projection.size());
  parallelFor(projection.size(), resolveThreads(params_.threads), 4096, [&](std::size_t i, int) {
    corresponding_->indices[i] = static_cast<pcl::index_t>(inputOf(i));
    output[i] = smoothed(projection, i, (*input_)[inputOf(i)]);
  });
}

template <typename PointInT, typename PointOutT>
void
SLIMProjectionSmoother<PointInT, PointOutT>::writeUpsampled(const CloudView& view,
                                                            const CloudProjection& own,
                                                            PointCloudOut& output)
{
  CloudView distinct;
  if (distinct_cloud_ && !distinct_cloud_->empty()) {
    distinct.size = distinct_cloud_->size();
    distinct.xyz = reinterpret_cast<const unsigned char*>(distinct_cloud_->points.data()) +
                   pcl::traits::offset<PointInT, pcl::fields::x>::value;
    distinct.xyz_stride = sizeof(PointInT);
  }
  Candidates candidates;
  CloudProjection projection;
  if (!upsample(view, writesCurvature(), own, distinct, candidates, projection)) return;
  for (std::size_t i = 0; i < projection.size(); ++i) {
    if (!projection.isSupported(i)) continue;
    const std::size_t from = inputOf(candidates.source[i]);
    PointOutT out;
    pcl::copyPoint((*input_)[from], out);
    put(upsampled(candidates, projection, i), out);
    output.push_back(out);
    corresponding_->indices.push_back(static_cast<pcl::index_t>(from));
  }
  output.header = input_->header;
  output.sensor_origin_ = input_->sensor_origin_;
  output.sensor_orientation_ = input_->sensor_orientation_;
  output.is_dense = true;
}

template <typename PointInT, typename PointOutT>
void
SLIMProjectionSmoother<PointInT, PointOutT>::put(const ProjectedPoint& point, PointOutT& out) const
{
  out.x = static_cast<float>(point.position[0]);
  out.y = static_cast<float>(point.position[1]);
  out.z = static_cast<float>(point.position[2]);
  if (!compute_normals_) return;
  if constexpr (pcl::traits::has_normal<PointOutT>::value) {
    out.normal_x = point.normal[0];
    out.normal_y = point.normal[1];
    out.normal_z = point.normal[2];
  }
  if constexpr (pcl::traits::has_curvature<PointOutT>::value) out.curvature = curvatureOf(point);
}

template <typename PointInT, typename PointOutT>
PointOutT
SLIMProjectionSmoother<PointInT, PointOutT>::smoothed(const CloudProjection& projection,
                                                      std::size_t i, const PointInT& in) const
{
  static_assert(std::is_same<decltype(PointOutT::x), float>::value, "x y z are written as float");
  PointOutT out;
  pcl::copyPoint(in, out);
  if (projection.isSupported(i)) {
    put(projection.point(i), out);
  } else if (!projection.isFinite(i) && compute_normals_) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    if constexpr (pcl::traits::has_normal<PointOutT>::value)
      out.normal_x = out.normal_y = out.normal_z = kNan;
    if constexpr (pcl::traits::has_curvature<PointOutT>::value) out.curvature = kNan;
  }
  return out;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother(In, Out) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMProjectionSmoother<In, Out>;
