// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/console/print.h>
#include <pcl/features/feature.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <type_traits>

#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/scalar_type.h"
#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/slim_curvature_estimation.h"

#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include "pcl_slim/filters/impl/cloud_description.hpp"
#endif

namespace pcl_slim {

/** Writes a field where a point type has it. */
template <typename Field, typename PointT>
void setField(PointT& point, float value) {
  if constexpr (pcl::traits::has_field<PointT, Field>::value) {
    static_assert(std::is_same<typename pcl::traits::datatype<PointT, Field>::type, float>::value,
                  "curvatures are written as float");
    std::memcpy(
        reinterpret_cast<unsigned char*>(&point) + pcl::traits::offset<PointT, Field>::value,
        &value, sizeof(value));
  }
}

/** Writes the fields of a curvature that a point type has. */
template <typename PointT>
void setCurvature(const ProjectedPoint& from, PointT& to) {
  namespace fields = pcl::fields;
  const PrincipalFrame& principal = from.principal;
  setField<fields::x>(to, finiteFloat(from.position[0]));
  setField<fields::y>(to, finiteFloat(from.position[1]));
  setField<fields::z>(to, finiteFloat(from.position[2]));
  setField<fields::normal_x>(to, from.normal[0]);
  setField<fields::normal_y>(to, from.normal[1]);
  setField<fields::normal_z>(to, from.normal[2]);
  setField<fields::k1>(to, principal.k1);
  setField<fields::k2>(to, principal.k2);
  setField<fields::pc1>(to, principal.k1);
  setField<fields::pc2>(to, principal.k2);
  setField<fields::mean_curvature>(to, from.mean_curvature);
  setField<fields::curvature>(to, from.surface_variation);
  setField<fields::gaussian_curvature>(to, from.gaussian_curvature);
  setField<fields::direction1_x>(to, principal.direction1[0]);
  setField<fields::direction1_y>(to, principal.direction1[1]);
  setField<fields::direction1_z>(to, principal.direction1[2]);
  setField<fields::principal_curvature_x>(to, principal.direction1[0]);
  setField<fields::principal_curvature_y>(to, principal.direction1[1]);
  setField<fields::principal_curvature_z>(to, principal.direction1[2]);
  setField<fields::direction2_x>(to, principal.direction2[0]);
  setField<fields::direction2_y>(to, principal.direction2[1]);
  setField<fields::direction2_z>(to, principal.direction2[2]);
}

template <typename PointT, typename... Fields>
constexpr bool hasAnyField() {
  return (pcl::traits::has_field<PointT, Fields>::value || ...);
}

/** Whether a point type has a field that is NaN where no surfel supports the point. */
template <typename PointT>
constexpr bool hasCurvatures() {
  namespace fields = pcl::fields;
  return hasAnyField<PointT, fields::k1, fields::k2, fields::pc1, fields::pc2,
                     fields::mean_curvature, fields::gaussian_curvature, fields::direction1_x,
                     fields::direction1_y, fields::direction1_z, fields::principal_curvature_x,
                     fields::principal_curvature_y, fields::principal_curvature_z,
                     fields::direction2_x, fields::direction2_y, fields::direction2_z>();
}

/** Whether a point type has a field of a normal or the surface variation. */
template <typename PointT>
constexpr bool hasPlanes() {
  namespace fields = pcl::fields;
  return hasAnyField<PointT, fields::normal_x, fields::normal_y, fields::normal_z,
                     fields::curvature>();
}

template <typename PointInT, typename PointOutT>
bool SLIMCurvatureEstimation<PointInT, PointOutT>::compute(PointCloudOut& output) {
  Base::compute(output);
  return !error_;
}

template <typename PointInT, typename PointOutT>
bool SLIMCurvatureEstimation<PointInT, PointOutT>::refuse(ErrorCode code,
                                                          const std::string& message) {
  fail(code, message);
  complain();
  return false;
}

template <typename PointInT, typename PointOutT>
void SLIMCurvatureEstimation<PointInT, PointOutT>::complain() const {
  if (error_.code == ErrorCode::kCancelled) return;
  PCL_ERROR("[pcl_slim::%s::compute] %s\n", this->getClassName().c_str(), error_.message.c_str());
}

template <typename PointInT, typename PointOutT>
bool SLIMCurvatureEstimation<PointInT, PointOutT>::initCompute() {
  clearResults();
  if (!input_) return refuse(ErrorCode::kBadInput, "no input cloud is set; call setInputCloud()");
  if (input_->empty())
    return refuse(ErrorCode::kBadInput, "the input cloud is empty; give it points");
  return pcl::PCLBase<PointInT>::initCompute();
}

template <typename PointInT, typename PointOutT>
void SLIMCurvatureEstimation<PointInT, PointOutT>::computeFeature(PointCloudOut& output) {
  CloudProjection projection;
  try {
    run(projection, output);
  } catch (const std::exception& failure) {
    fail(ErrorCode::kBadInput, std::string("the estimation stopped: ") + failure.what());
  }
  if (!error_) return printWarning("SLIMCurvatureEstimation::compute");
  output = PointCloudOut();
  complain();
}

template <typename PointInT, typename PointOutT>
bool SLIMCurvatureEstimation<PointInT, PointOutT>::run(CloudProjection& projection,
                                                       PointCloudOut& output) {
  const auto input = input_, searched = surface_;
  const pcl::IndicesConstPtr all = indices_, indices = use_indices_ ? all : nullptr;
  const bool apart = searched && searched != input;
  Result<DescribedCloud> points = DescribedCloud();
  if (apart) points = describeCloud<PointInT>({input, indices, {}, {}, 0, {}, {}}, params_);
  if (!points) return fail(points.error().code, points.error().message);
  const Result<DescribedCloud> fitted =
      describeCloud<PointInT>({apart ? searched : input, apart ? nullptr : indices, normals_,
                               this->tree_, normal_neighbours_, sensors_, frames_},
                              params_);
  if (!fitted) return fail(fitted.error().code, fitted.error().message);
  ProjectionParams params;
  params.directions = hasCurvatures<PointOutT>();
  params.planes = hasPlanes<PointOutT>();
  const CloudView& view = apart ? points->view : fitted->view;
  if (!project(view, fitted->view, params_, params, projection)) return false;
  write(*input, *all, projection, output);
  return true;
}

template <typename PointInT, typename PointOutT>
void SLIMCurvatureEstimation<PointInT, PointOutT>::write(const pcl::PointCloud<PointInT>& input,
                                                         const pcl::Indices& indices,
                                                         const CloudProjection& projection,
                                                         PointCloudOut& output) const {
  output.sensor_origin_ = input.sensor_origin_;
  output.sensor_orientation_ = input.sensor_orientation_;
  std::atomic<bool> dense{true};
  parallelFor(projection.size(), resolveThreads(params_.threads), 4096, [&](std::size_t i, int) {
    PointOutT out;
    ProjectedPoint point;
    if (projection.isFinite(i)) {
      point = projection.point(i);
    } else {
      const PointInT& in = input[static_cast<std::size_t>(indices[i])];
      point = CloudProjection::unknownPoint({in.x, in.y, in.z});
    }
    setCurvature(point, out);
    const bool whole =
        projection.isSupported(i) || (!hasCurvatures<PointOutT>() && !std::isnan(point.normal[0]));
    if (!whole) dense = false;
    output[i] = out;
  });
  output.is_dense = dense;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMCurvatureEstimation(In, Out) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMCurvatureEstimation<In, Out>;
