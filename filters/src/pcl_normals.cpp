// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/filters/pcl_normals.h"

#include <pcl/common/point_tests.h>
#include <pcl/features/normal_3d.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <string>

#include "pcl_slim/cloud/side_evidence.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/filters/estimated_normals.h"

#ifdef PCL_NO_PRECOMPILE
namespace pcl_slim {

namespace {

/** \brief The distance of PCL's trees as a type of our own, for which FLANN's function that makes
 * an index of any kind makes the one kind that PCL asks for: the other seven are most of the time
 * to compile this file. */
struct SquaredDistance : flann::L2_Simple<float> {};

using PointTree =
    pcl::search::KdTree<pcl::PointXYZ, pcl::KdTreeFLANN<pcl::PointXYZ, SquaredDistance>>;

}  // namespace

}  // namespace pcl_slim

template <>
inline flann::NNIndex<pcl_slim::SquaredDistance>* flann::create_index_by_type<
    pcl_slim::SquaredDistance>(const flann_algorithm_t, const Matrix<float>& points,
                               const IndexParams& params,
                               const pcl_slim::SquaredDistance& distance) {
  return new KDTreeSingleIndex<pcl_slim::SquaredDistance>(points, params, distance);
}
#endif

namespace pcl_slim {

#ifndef PCL_NO_PRECOMPILE
using PointTree = pcl::search::KdTree<pcl::PointXYZ>;
#endif

pcl::search::Search<pcl::PointXYZ>::Ptr makeSearch(
    const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud) {
  if (cloud->isOrganized()) {
    auto organized = std::make_shared<pcl::search::OrganizedNeighbor<pcl::PointXYZ>>();
    organized->setInputCloud(cloud);
    if (organized->isValid()) return organized;
  }
  auto tree = std::make_shared<PointTree>();
  tree->setInputCloud(cloud);
  return tree;
}

namespace {

// Squared distances in floats: neither infinite across the cloud nor zero between neighbours.
constexpr float kLargest = 1e18f;
constexpr float kLeastSpan = 1e-12f;

/** Checks that PCL can estimate normals of a cloud. */
Error checkCloud(const pcl::PointCloud<pcl::PointXYZ>& cloud, int neighbours) {
  float largest = 0, low[3] = {}, high[3] = {};
  std::size_t finite = 0;
  for (const pcl::PointXYZ& p : cloud) {
    if (!pcl::isFinite(p)) continue;
    for (int a = 0; a < 3; ++a) {
      largest = std::max(largest, std::abs(p.data[a]));
      low[a] = finite == 0 ? p.data[a] : std::min(low[a], p.data[a]);
      high[a] = finite == 0 ? p.data[a] : std::max(high[a], p.data[a]);
    }
    ++finite;
  }
  if (neighbours < 3 || static_cast<std::size_t>(neighbours) > finite) {
    return {ErrorCode::kBadArgument, "normals from " + std::to_string(neighbours) +
                                         " neighbours of " + std::to_string(finite) +
                                         " points: give a number from 3 to that of the points"};
  }
  const float span = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  if (largest <= kLargest && (span >= kLeastSpan || span == 0.0f)) return {};
  return badInput("PCL's normals take squares of coordinates in floats, which these are too " +
                  std::string(largest > kLargest ? "large" : "small") + " for: scale the cloud");
}

/** As pcl::NormalEstimation computes it. \return false: there is none, and all of it is NaN. */
bool normalOf(const pcl::PointCloud<pcl::PointXYZ>& cloud, pcl::index_t point,
              const pcl::search::Search<pcl::PointXYZ>& search, int neighbours,
              const Eigen::Vector4f& viewpoint, pcl::Normal& normal) {
  thread_local pcl::Indices near;
  thread_local std::vector<float> distances_sq;
  const pcl::PointXYZ& own = cloud[static_cast<std::size_t>(point)];
  Eigen::Vector4f n;
  if (!pcl::isFinite(own) ||
      search.nearestKSearch(cloud, point, neighbours, near, distances_sq) == 0 ||
      !pcl::computePointNormal(cloud, near, n, normal.curvature)) {
    normal.normal_x = normal.normal_y = normal.normal_z = normal.curvature =
        std::numeric_limits<float>::quiet_NaN();
    return false;
  }
  pcl::flipNormalTowardsViewpoint(own, viewpoint[0], viewpoint[1], viewpoint[2], n[0], n[1], n[2]);
  normal.normal_x = n[0];
  normal.normal_y = n[1];
  normal.normal_z = n[2];
  return true;
}

}  // namespace

Error pclNormals(const pcl::PointCloud<pcl::PointXYZ>::ConstPtr& cloud,
                 const pcl::IndicesConstPtr& selected,
                 const pcl::search::Search<pcl::PointXYZ>::Ptr& search, int neighbours,
                 const FitParams& params, pcl::PointCloud<pcl::Normal>& normals) {
  if (Error error = checkThreads(params.threads)) return error;
  if (Error error = checkCloud(*cloud, neighbours)) return error;
  const std::size_t count = selected ? selected->size() : cloud->size();
  Eigen::Vector4f viewpoint = Eigen::Vector4f::Zero();
  if (params.viewpoint) {
    for (int a = 0; a < 3; ++a)
      viewpoint[a] = static_cast<float>((*params.viewpoint)[static_cast<std::size_t>(a)]);
  } else if (cloud->sensor_origin_.head<3>().allFinite()) {
    viewpoint = cloud->sensor_origin_;
  }
  normals.clear();
  normals.resize(count);
  std::atomic<bool> dense{true};
  parallelFor(count, resolveThreads(params.threads), 256, [&](std::size_t i, int) {
    const pcl::index_t point = selected ? (*selected)[i] : static_cast<pcl::index_t>(i);
    if (!normalOf(*cloud, point, *search, neighbours, viewpoint, normals[i])) dense = false;
  });
  normals.is_dense = dense;
  return {};
}

namespace {

/** A cloud's finite points as floats PCL can square: from the first of them, and where they are
 * very large or small, scaled by a power of two. */
struct PlainPoints {
  pcl::PointCloud<pcl::PointXYZ>::Ptr points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::vector<std::size_t> source;  ///< the point of the cloud that each is
  std::array<double, 3> origin{};
  double scale = 1.0;

  explicit PlainPoints(const CloudView& view) {
    double largest = 0;
    for (std::size_t i = 0; i < view.size; ++i) {
      const std::array<double, 3> p = view.position(i);
      if (!isFinite(p)) continue;
      if (source.empty()) origin = p;
      source.push_back(i);
      for (std::size_t a = 0; a < 3; ++a) {
        largest = std::max(largest, std::abs(0.5 * p[a] - 0.5 * origin[a]));
      }
    }
    constexpr int kLeastExponent = -1000;  // the inverse of a smaller power is infinite
    if (largest > 0 && (largest > 1e12 || largest < 1e-9)) {
      scale = std::exp2(-std::max(std::ilogb(largest), kLeastExponent));
    }
    for (const std::size_t i : source) {
      const std::array<double, 3> p = local(view.position(i));
      points->push_back(pcl::PointXYZ(static_cast<float>(p[0]), static_cast<float>(p[1]),
                                      static_cast<float>(p[2])));
    }
  }

  std::array<double, 3> local(const std::array<double, 3>& world) const {
    return {scale * (world[0] - origin[0]), scale * (world[1] - origin[1]),
            scale * (world[2] - origin[2])};
  }
};

}  // namespace

Error estimateNormals(const CloudView& cloud, int k,
                      const std::optional<std::array<double, 3>>& viewpoint, int threads,
                      std::vector<float>& normals) {
  const PlainPoints plain(cloud);
  normals.assign(cloud.size * 3, std::numeric_limits<float>::quiet_NaN());
  if (plain.source.empty()) return {};
  FitParams params;
  params.threads = threads;
  pcl::PointCloud<pcl::Normal> estimated;
  if (Error error =
          pclNormals(plain.points, nullptr, makeSearch(plain.points), k, params, estimated))
    return error;
  for (std::size_t i = 0; i < plain.source.size(); ++i) {
    std::memcpy(&normals[3 * plain.source[i]], estimated[i].normal, 3 * sizeof(float));
  }
  faceNormals(cloud, viewpoint, threads, normals);
  return {};
}

}  // namespace pcl_slim
