// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/common/io.h>
#include <pcl/common/point_tests.h>
#include <pcl/search/organized.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <memory>
#include <optional>
#include <type_traits>

#include "pcl_slim/filters/impl/color_view.hpp"
#include "pcl_slim/filters/pcl_normals.h"
#include "pcl_slim/filters/slim_fit.h"

// PCL's sources instantiate its classes for its own point types only; ours are among those.
#ifndef PCL_SLIM_PCL_POINTS_ONLY
#include <pcl/impl/pcl_base.hpp>
#include <pcl/search/impl/organized.hpp>
#include <pcl/search/impl/search.hpp>
#endif

namespace pcl_slim {

/** Lets a search object for one point type answer for the same cloud as plain points, so that
 * PCL's normal estimation, which is compiled for those, is used for every point type. */
template <typename PointT>
class PlainPointSearch : public pcl::search::Search<pcl::PointXYZ> {
 public:
  explicit PlainPointSearch(const typename pcl::search::Search<PointT>::Ptr& search)
      : Search("PlainPointSearch"), search_(search) {}

  using Search::nearestKSearch;
  using Search::radiusSearch;

  int nearestKSearch(const pcl::PointXYZ& point, int k, pcl::Indices& indices,
                     std::vector<float>& distances_sq) const override {
    return search_->nearestKSearch(toPoint(point), k, indices, distances_sq);
  }

  int radiusSearch(const pcl::PointXYZ& point, double radius, pcl::Indices& indices,
                   std::vector<float>& distances_sq, unsigned int most = 0) const override {
    return search_->radiusSearch(toPoint(point), radius, indices, distances_sq, most);
  }

 private:
  static PointT toPoint(const pcl::PointXYZ& plain) {
    PointT point;
    point.x = plain.x;
    point.y = plain.y;
    point.z = plain.z;
    return point;
  }

  typename pcl::search::Search<PointT>::Ptr search_;
};

/** Where a cloud was seen from: the origin of its sensor, which an organized cloud has even at 0.
 */
template <typename PointT>
std::optional<std::array<double, 3>> sensorOf(const pcl::PointCloud<PointT>& cloud) {
  const Eigen::Vector4f& at = cloud.sensor_origin_;
  if (!at.head<3>().allFinite() || (!cloud.isOrganized() && at.head<3>().isZero())) return {};
  return std::array<double, 3>{at[0], at[1], at[2]};
}

template <typename PointT>
bool SLIMFit<PointT>::fit(SLIMSurface& surface) {
  surface = SLIMSurface();
  clearResults();
  CloudView view;
  std::vector<float> estimated;
  if (!describeInput(view) || !describeNormals(view, estimated)) return false;
  return run(view, surface, colors_ ? colorsOfPoints(*input_) : ColorView());
}

template <typename PointT>
bool SLIMFit<PointT>::fit(pcl::PointCloud<PointSLIM>& surfels, SurfaceMetadata* metadata) {
  surfels = pcl::PointCloud<PointSLIM>();
  if (metadata) *metadata = SurfaceMetadata();
  SLIMSurface surface;
  if (!fit(surface)) return false;
  const SurfaceMetadata made = toPCL(surface, surfels);
  surfels.header = input_->header;
  if (metadata) *metadata = made;
  return true;
}

template <typename PointT>
bool SLIMFit<PointT>::describeInput(CloudView& view) {
  namespace traits = pcl::traits;
  namespace fields = pcl::fields;
  static_assert(std::is_same<typename traits::datatype<PointT, fields::x>::type, float>::value,
                "SLIMFit reads x y z of type float");
  if (!input_) return fail(ErrorCode::kBadInput, "no input cloud is set; call setInputCloud()");
  if (input_->empty())
    return fail(ErrorCode::kBadInput, "the input cloud is empty; give it points");
  view.size = input_->size();
  view.xyz = reinterpret_cast<const unsigned char*>(input_->points.data()) +
             traits::offset<PointT, fields::x>::value;
  view.xyz_stride = sizeof(PointT);
  view.sensor = sensorOf(*input_);
  if (!describeSensors(view) || !describeFrames(view)) return false;
  if (!use_indices_ || !indices_) return true;

  static_assert(sizeof(pcl::index_t) == sizeof(std::int32_t), "PCL is built with 32-bit indices");
  for (const auto index : *indices_) {
    if (index < 0 || static_cast<std::size_t>(index) >= input_->size()) {
      return fail(ErrorCode::kBadInput, "index " + std::to_string(index) +
                                            " is outside the cloud of " +
                                            std::to_string(input_->size()) + " points");
    }
  }
  if (indices_->empty()) return fail(ErrorCode::kBadInput, "the indices are empty; select points");
  view.indices = reinterpret_cast<const std::int32_t*>(indices_->data());
  view.num_indices = indices_->size();
  return true;
}

template <typename PointT>
bool SLIMFit<PointT>::describeSensors(CloudView& view) {
  if (sensors_ && !sensors_->empty()) {
    if (sensors_->size() != input_->size()) {
      return fail(ErrorCode::kBadInput,
                  "there are " + std::to_string(sensors_->size()) + " sensor positions for " +
                      std::to_string(input_->size()) + " points; give one for each point");
    }
    if (params_.viewpoint) {
      return fail(ErrorCode::kBadArgument,
                  "a viewpoint and sensor positions are both set; clear one of them");
    }
    view.sensors = sensors_->data();
    view.sensors_stride = sizeof(Eigen::Vector3d);
  } else if constexpr (pcl::traits::has_field<PointT, pcl::fields::vp_x>::value) {
    const bool known = std::any_of(input_->begin(), input_->end(), [](const PointT& p) {
      return p.vp_x != 0 || p.vp_y != 0 || p.vp_z != 0;
    });
    if (!known || params_.viewpoint) return true;
    view.sensors = reinterpret_cast<const unsigned char*>(input_->points.data()) +
                   pcl::traits::offset<PointT, pcl::fields::vp_x>::value;
    view.sensors_stride = sizeof(PointT);
    view.sensors_scalar = CloudView::Scalar::kFloat;
  }
  return true;
}

template <typename PointT>
bool SLIMFit<PointT>::describeFrames(CloudView& view) {
  if (!frames_ || frames_->empty()) return true;
  if (frames_->size() != input_->size()) {
    return fail(ErrorCode::kBadInput, "there are " + std::to_string(frames_->size()) +
                                          " frame numbers for " + std::to_string(input_->size()) +
                                          " points; give one for each point");
  }
  view.frame_numbers = frames_->data();
  return true;
}

template <typename PointT>
bool SLIMFit<PointT>::describeNormals(CloudView& view, std::vector<float>& estimated) {
  if (normals_) {
    if (normals_->size() != input_->size()) {
      return fail(ErrorCode::kBadInput, "there are " + std::to_string(normals_->size()) +
                                            " normals for " + std::to_string(input_->size()) +
                                            " points; give one for each point");
    }
    view.normal = normals_->points.data()->normal;
    view.normal_stride = sizeof(pcl::Normal);
  } else if (normal_neighbours_ != 0) {
    if (!estimateNormals(estimated)) return false;
    if (view.sensors) faceSensors(view, estimated);
    view.normal = estimated.data();
    view.normal_stride = 3 * sizeof(float);
  } else if constexpr (pcl::traits::has_normal<PointT>::value) {
    view.normal = reinterpret_cast<const unsigned char*>(input_->points.data()) +
                  pcl::traits::offset<PointT, pcl::fields::normal_x>::value;
    view.normal_stride = sizeof(PointT);
  }
  return true;
}

template <typename PointT>
bool SLIMFit<PointT>::prepareSearch(const typename PointCloud::ConstPtr& cloud) {
  using Organized = pcl::search::OrganizedNeighbor<PointT>;
  const auto organized = std::dynamic_pointer_cast<Organized>(search_);
  const bool unsuitable = organized && !cloud->isOrganized();
  if (!unsuitable) search_->setInputCloud(cloud);
  if (!unsuitable && (!organized || organized->isValid())) return true;
  return fail(ErrorCode::kBadInput,
              "OrganizedNeighbor needs an organized cloud seen by one camera; set another search");
}

template <typename PointT>
pcl::IndicesPtr SLIMFit<PointT>::finiteSelection() const {
  auto selected = std::make_shared<pcl::Indices>();
  const std::size_t count = use_indices_ && indices_ ? indices_->size() : input_->size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto index = use_indices_ && indices_ ? (*indices_)[i] : static_cast<pcl::index_t>(i);
    if (pcl::isFinite((*input_)[static_cast<std::size_t>(index)])) selected->push_back(index);
  }
  return selected;
}

template <typename PointT>
bool SLIMFit<PointT>::findNormals(const pcl::IndicesPtr& selected, NormalCloud& normals) {
  bool all_finite = true;
  for (std::size_t i = 0; i < input_->size(); ++i) all_finite &= pcl::isFinite((*input_)[i]);
  auto plain = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  pcl::copyPointCloud(*input_, *plain);
  plain->is_dense = all_finite;
  pcl::search::Search<pcl::PointXYZ>::Ptr search;
  if (!search_) {
    search = makeSearch(plain);
  } else {
    typename PointCloud::ConstPtr cloud = input_;
    if (!all_finite && input_->is_dense) {  // search objects believe is_dense
      auto honest = std::make_shared<PointCloud>(*input_);
      honest->is_dense = false;
      cloud = honest;
    }
    if (!prepareSearch(cloud)) return false;
    search = std::make_shared<PlainPointSearch<PointT>>(search_);
  }
  error_ = pclNormals(plain, selected, search, normal_neighbours_, params_, normals);
  return !error_;
}

template <typename PointT>
bool SLIMFit<PointT>::estimateNormals(std::vector<float>& estimated) {
  if (normal_neighbours_ < 3) {
    return fail(ErrorCode::kBadArgument, "a normal needs at least 3 neighbours; raise k");
  }
  error_ = params_.validate();
  if (error_) return false;
  const pcl::IndicesPtr selected = finiteSelection();
  estimated.assign(3 * input_->size(), 0.0f);
  if (selected->empty()) return true;  // the fit reports the error
  NormalCloud normals;
  try {
    if (!findNormals(selected, normals)) return false;
  } catch (const std::exception& failure) {
    return fail(ErrorCode::kBadInput, std::string("PCL's normals: ") + failure.what());
  }
  if (normals.size() != selected->size()) {
    return fail(ErrorCode::kBadInput, "PCL could not estimate normals; set another search");
  }
  for (std::size_t i = 0; i < selected->size(); ++i) {
    std::memcpy(&estimated[3 * static_cast<std::size_t>((*selected)[i])], normals[i].normal,
                3 * sizeof(float));
  }
  return true;
}

}  // namespace pcl_slim

#define PCL_SLIM_INSTANTIATE_SLIMFit(PointT) \
  template class PCL_SLIM_EXPORT pcl_slim::SLIMFit<PointT>;
