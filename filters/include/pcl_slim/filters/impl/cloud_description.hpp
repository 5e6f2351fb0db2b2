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
#include <string>
#include <type_traits>

#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/pcl_normals.h"

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

/** Checks that there is one of what is given for each point of a cloud. */
inline Error checkOneEach(std::size_t count, const char* what, std::size_t points) {
  if (count == points) return {};
  return badInput("there are " + std::to_string(count) + " " + what + " for " +
                  std::to_string(points) + " points; give one for each point");
}

/** Describes which of a cloud's points are used. */
inline Error describeIndices(const pcl::IndicesConstPtr& indices, CloudView& view) {
  static_assert(sizeof(pcl::index_t) == sizeof(std::int32_t), "PCL is built with 32-bit indices");
  if (!indices) return {};
  for (const auto index : *indices) {
    if (index < 0 || static_cast<std::size_t>(index) >= view.size) {
      return badInput("index " + std::to_string(index) + " is outside the cloud of " +
                      std::to_string(view.size) + " points");
    }
  }
  if (indices->empty()) return badInput("the indices are empty; select points");
  view.indices = reinterpret_cast<const std::int32_t*>(indices->data());
  view.num_indices = indices->size();
  return {};
}

/** Describes where points were seen from, if that is known. */
template <typename PointT>
Error describeSensors(const CloudInput<PointT>& input, bool has_viewpoint, CloudView& view) {
  const pcl::PointCloud<PointT>& cloud = *input.cloud;
  if (input.sensors && !input.sensors->empty()) {
    if (Error error = checkOneEach(input.sensors->size(), "sensor positions", cloud.size()))
      return error;
    if (has_viewpoint) {
      return {ErrorCode::kBadArgument,
              "a viewpoint and sensor positions are both set; clear one of them"};
    }
    view.sensors = input.sensors->data();
    view.sensors_stride = sizeof(Eigen::Vector3d);
  } else if constexpr (pcl::traits::has_field<PointT, pcl::fields::vp_x>::value) {
    const bool known = std::any_of(cloud.begin(), cloud.end(), [](const PointT& p) {
      return p.vp_x != 0 || p.vp_y != 0 || p.vp_z != 0;
    });
    if (!known || has_viewpoint) return {};
    view.sensors = reinterpret_cast<const unsigned char*>(cloud.points.data()) +
                   pcl::traits::offset<PointT, pcl::fields::vp_x>::value;
    view.sensors_stride = sizeof(PointT);
    view.sensors_scalar = CloudView::Scalar::kFloat;
  }
  return {};
}

/** Checks the input and describes all of its points but for their normals. */
template <typename PointT>
Error describePoints(const CloudInput<PointT>& input, const FitParams& params, CloudView& view) {
  namespace traits = pcl::traits;
  namespace fields = pcl::fields;
  static_assert(std::is_same<typename traits::datatype<PointT, fields::x>::type, float>::value,
                "SLIMFit reads x y z of type float");
  if (!input.cloud) return badInput("no input cloud is set; call setInputCloud()");
  const pcl::PointCloud<PointT>& cloud = *input.cloud;
  if (cloud.empty()) return badInput("the input cloud is empty; give it points");
  view.size = cloud.size();
  view.xyz = reinterpret_cast<const unsigned char*>(cloud.points.data()) +
             traits::offset<PointT, fields::x>::value;
  view.xyz_stride = sizeof(PointT);
  view.sensor = sensorOf(cloud);
  if (Error error = describeSensors(input, params.viewpoint.has_value(), view)) return error;
  if (input.frames && !input.frames->empty()) {
    if (Error error = checkOneEach(input.frames->size(), "frame numbers", cloud.size()))
      return error;
    view.frame_numbers = input.frames->data();
  }
  return describeIndices(input.indices, view);
}

/** Gives the search object its cloud; an error if it does not accept it. */
template <typename PointT>
Error prepareSearch(const typename pcl::PointCloud<PointT>::ConstPtr& cloud,
                    pcl::search::Search<PointT>& search) {
  auto* organized = dynamic_cast<pcl::search::OrganizedNeighbor<PointT>*>(&search);
  const bool unsuitable = organized != nullptr && !cloud->isOrganized();
  if (!unsuitable) search.setInputCloud(cloud);
  if (!unsuitable && (organized == nullptr || organized->isValid())) return {};
  return badInput(
      "OrganizedNeighbor needs an organized cloud seen by one camera; set another search");
}

/** PCL's normals of the selected points; it may throw. */
template <typename PointT>
Error findNormals(const CloudInput<PointT>& input, const pcl::IndicesConstPtr& selected,
                  const FitParams& params, pcl::PointCloud<pcl::Normal>& normals) {
  const pcl::PointCloud<PointT>& cloud = *input.cloud;
  bool all_finite = true;
  for (std::size_t i = 0; i < cloud.size(); ++i) all_finite &= pcl::isFinite(cloud[i]);
  auto plain = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  pcl::copyPointCloud(cloud, *plain);
  plain->is_dense = all_finite;
  pcl::search::Search<pcl::PointXYZ>::Ptr search;
  if (!input.search) {
    search = makeSearch(plain);
  } else {
    typename pcl::PointCloud<PointT>::ConstPtr searched = input.cloud;
    if (!all_finite && cloud.is_dense) {  // search objects believe is_dense
      auto honest = std::make_shared<pcl::PointCloud<PointT>>(cloud);
      honest->is_dense = false;
      searched = honest;
    }
    if (Error error = prepareSearch<PointT>(searched, *input.search)) return error;
    search = std::make_shared<PlainPointSearch<PointT>>(input.search);
  }
  return pclNormals(plain, selected, search, input.normal_neighbours, params, normals);
}

/** PCL's normals of the points to use that are finite, zero for all others. */
template <typename PointT>
Error estimateNormals(const CloudInput<PointT>& input, const FitParams& params,
                      std::vector<float>& estimated) {
  if (input.normal_neighbours < 3)
    return {ErrorCode::kBadArgument, "a normal needs at least 3 neighbours; raise k"};
  if (Error error = params.validate()) return error;
  const pcl::PointCloud<PointT>& cloud = *input.cloud;
  auto selected = std::make_shared<pcl::Indices>();
  const std::size_t count = input.indices ? input.indices->size() : cloud.size();
  for (std::size_t i = 0; i < count; ++i) {
    const auto index = input.indices ? (*input.indices)[i] : static_cast<pcl::index_t>(i);
    if (pcl::isFinite(cloud[static_cast<std::size_t>(index)])) selected->push_back(index);
  }
  estimated.assign(3 * cloud.size(), 0.0f);
  if (selected->empty()) return {};  // the fit reports the error
  pcl::PointCloud<pcl::Normal> normals;
  try {
    if (Error error = findNormals(input, selected, params, normals)) return error;
  } catch (const std::exception& failure) {
    return badInput(std::string("PCL's normals: ") + failure.what());
  }
  if (normals.size() != selected->size())
    return badInput("PCL could not estimate normals; set another search");
  for (std::size_t i = 0; i < selected->size(); ++i) {
    std::memcpy(&estimated[3 * static_cast<std::size_t>((*selected)[i])], normals[i].normal,
                3 * sizeof(float));
  }
  return {};
}

template <typename PointT>
Result<DescribedCloud> describeCloud(const CloudInput<PointT>& input, const FitParams& params) {
  DescribedCloud described;
  CloudView& view = described.view;
  if (Error error = describePoints(input, params, view)) return error;
  described.kept = {input.cloud, input.indices, input.normals, input.sensors, input.frames};
  if (input.normals) {
    if (Error error = checkOneEach(input.normals->size(), "normals", view.size)) return error;
    view.normal = input.normals->points.data()->normal;
    view.normal_stride = sizeof(pcl::Normal);
  } else if (input.normal_neighbours != 0) {
    if (Error error = estimateNormals(input, params, described.estimated)) return error;
    faceNormals(view, params.viewpoint, params.threads, described.estimated);
    view.normal = described.estimated.data();
    view.normal_stride = 3 * sizeof(float);
  } else if constexpr (pcl::traits::has_normal<PointT>::value) {
    view.normal = reinterpret_cast<const unsigned char*>(input.cloud->points.data()) +
                  pcl::traits::offset<PointT, pcl::fields::normal_x>::value;
    view.normal_stride = sizeof(PointT);
  }
  return described;
}

}  // namespace pcl_slim
