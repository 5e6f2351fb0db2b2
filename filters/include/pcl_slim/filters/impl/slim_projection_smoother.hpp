// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/io.h>
#include <pcl/surface/processing.h>

#include <exception>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/point_curvature.h"
#include "pcl_slim/filters/slim_projection_smoother.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/cloud_description.hpp"
#endif

namespace pcl_slim {

/** \brief Offset of a field of type float, or kNoField where a point type has none. */
template <typename PointT, typename Field>
std::size_t SLIMSmootherBase::floatField() {
  if constexpr (pcl::traits::has_field<PointT, Field>::value) {
    static_assert(std::is_same<typename pcl::traits::datatype<PointT, Field>::type, float>::value,
                  "curvatures are written as float");
    return pcl::traits::offset<PointT, Field>::value;
  } else {
    return kNoField;
  }
}

template <typename PointT>
SLIMSmootherBase::Target SLIMSmootherBase::targetOf(void* cloud) {
  auto& output = *static_cast<pcl::PointCloud<PointT>*>(cloud);
  namespace fields = pcl::fields;
  using pcl::traits::offset;
  static_assert(std::is_same<decltype(PointT::x), float>::value &&
                    offset<PointT, fields::z>::value - offset<PointT, fields::x>::value == 8,
                "x y z are written as three floats in a row");
  Target target;
  target.step = sizeof(PointT);
  target.position = offset<PointT, fields::x>::value;
  if constexpr (pcl::traits::has_normal<PointT>::value) {
    target.normal = offset<PointT, fields::normal_x>::value;
    static_assert(
        offset<PointT, fields::normal_z>::value - offset<PointT, fields::normal_x>::value == 8,
        "normals are written as three floats in a row");
  }
  target.curvature = floatField<PointT, fields::curvature>();
  target.mean = floatField<PointT, fields::mean_curvature>();
  target.gaussian = floatField<PointT, fields::gaussian_curvature>();
  target.k1 = floatField<PointT, fields::k1>();
  target.k2 = floatField<PointT, fields::k2>();
  target.resize = [&output](std::size_t count) {
    output.resize(count);
    return reinterpret_cast<unsigned char*>(output.points.data());
  };
  target.header = &output.header;
  target.sensor_origin = &output.sensor_origin_;
  target.sensor_orientation = &output.sensor_orientation_;
  target.width = &output.width;
  target.height = &output.height;
  target.is_dense = &output.is_dense;
  target.fields = pcl::getFields<PointT>();
  return target;
}

template <typename PointT>
void SLIMSmootherBase::smoothInput(const CloudInput<PointT>& input,
                                   typename pcl::PointCloud<PointT>::ConstPtr distinct,
                                   void* output, Target (*target_of)(void*), bool same) {
  corresponding_ = std::make_shared<pcl::PointIndices>();
  error_ = checkSmoother(distinct != nullptr);
  if (error_) return;
  const Result<DescribedCloud> described = describeCloud(input, params_);
  error_ = described.error();
  if (error_) return;
  const pcl::PointCloud<PointT>& cloud = *input.cloud;
  Source source;
  source.points = reinterpret_cast<const unsigned char*>(cloud.points.data());
  source.step = sizeof(PointT);
  source.indices = input.indices.get();
  source.view = described->view;
  if (distinct && !distinct->empty()) {
    source.distinct.size = distinct->size();
    source.distinct.xyz = reinterpret_cast<const unsigned char*>(distinct->points.data()) +
                          pcl::traits::offset<PointT, pcl::fields::x>::value;
    source.distinct.xyz_stride = sizeof(PointT);
  }
  Target target = target_of(output);
  target.copies = same ? std::vector<CommonBytes>{{0, 0, sizeof(PointT)}}
                       : commonFields(pcl::getFields<PointT>(), target.fields);
  bool dense = true;
  const bool own = run(source, target, dense);
  if (error_) return;
  const std::size_t size = static_cast<std::size_t>(*target.width) * *target.height;
  if (own && !input.indices && static_cast<std::size_t>(cloud.width) * cloud.height == size) {
    *target.width = cloud.width;
    *target.height = cloud.height;
  }
  *target.header = cloud.header;
  *target.sensor_origin = cloud.sensor_origin_;
  *target.sensor_orientation = cloud.sensor_orientation_;
  *target.is_dense = dense;
}

template <typename PointT>
void SLIMSmootherBase::processApart(void (*perform)(SLIMSmootherBase&, pcl::PointCloud<PointT>&),
                                    pcl::PointCloud<PointT>& output) {
  clearResults();
  pcl::PointCloud<PointT> made;
  try {
    perform(*this, made);
  } catch (const std::exception& failure) {
    fail(ErrorCode::kBadInput, std::string("smoothing stopped: ") + failure.what());
  }
  if (error_) made = pcl::PointCloud<PointT>();
  complain();
  output = std::move(made);
}

template <typename PointInT, typename PointOutT>
void SLIMProjectionSmoother<PointInT, PointOutT>::process(PointCloudOut& output) {
  processApart<PointOutT>(
      [](SLIMSmootherBase& smoother, PointCloudOut& made) {
        static_cast<SLIMProjectionSmoother&>(smoother).performProcessing(made);
      },
      output);
}

template <typename PointInT, typename PointOutT>
void SLIMProjectionSmoother<PointInT, PointOutT>::performProcessing(PointCloudOut& output) {
  smoothInput<PointInT>({input_, use_indices_ ? indices_ : nullptr, normals_, search_,
                         normal_neighbours_, sensors_, frames_},
                        distinct_cloud_, &output, &targetOf<PointOutT>,
                        std::is_same<PointInT, PointOutT>::value);
}

}  // namespace pcl_slim

// What the class only declares: whoever uses it compiles the rest with its definition.
#define PCL_SLIM_INSTANTIATE_SLIMProjectionSmoother(In, Out)                                  \
  template PCL_SLIM_EXPORT void pcl_slim::SLIMProjectionSmoother<In, Out>::process(           \
      pcl::PointCloud<Out>&);                                                                 \
  template PCL_SLIM_EXPORT void pcl_slim::SLIMProjectionSmoother<In, Out>::performProcessing( \
      pcl::PointCloud<Out>&);
