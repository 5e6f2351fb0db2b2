// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>
#include <pcl/surface/processing.h>

#include <functional>
#include <utility>
#include <vector>

#include "pcl_slim/filters/slim_smoother_base.h"

namespace pcl_slim {

/** \brief Smooths a cloud by moving its points onto the SLIM surface fitted to it (Ohtake, Belyaev,
 * Alexa: Sparse low-degree implicit surfaces, SGP 2005, equations 6 to 8).
 *
 * A replacement for pcl::MovingLeastSquares with all of its setters
 * (docs/slim_projection_smoother.md):
 * \code
 * pcl_slim::SLIMProjectionSmoother<pcl::PointXYZ, pcl::PointNormal> smoother;
 * smoother.setInputCloud(cloud);
 * pcl::PointCloud<pcl::PointNormal> smooth;
 * smoother.process(smooth);
 * \endcode
 *
 * The output has one point for each point of the cloud, or for each index, in the same order.
 * Without indices width and height stay. Header and sensor pose are copied, and so is every field
 * that both point types have. Points equal in place move alike. Points with a NaN or infinite
 * coordinate stay as they are; points that no surfel supports (outliers) keep their place and are
 * listed by getUnsupported(). Numbers are computed in double, relative to the cloud's middle, and
 * rounded to float last. The result is the same for any number of threads.
 *
 * Each ball of the surface finds its own radius from the noise and the shape; setSearchRadius(),
 * setPenalty() or setTargetError() set how smooth the result is. The output's field curvature is
 * the surface variation, as PCL's classes write and read it, unless setCurvature() is called.
 *
 * With setUpsamplingMethod() the output has other points than the input: those that the surface
 * supports, in a cloud of height 1, with the fields of the input point each belongs to
 * (getCorrespondingIndices()).
 *
 * Points that are nowhere a surface (a dozen or fewer, those of lines) stay as they are: a warning,
 * printed as PCL prints warnings and returned by getWarning(). A missing or empty cloud, one
 * without a finite point, and indices out of range are errors: the output is then empty, the error
 * printed as PCL prints errors, and returned by getError().
 *
 * Compiled for all of PCL_XYZ_POINT_TYPES, in and out. For a point type of your own, include
 * pcl_slim/filters/impl/slim_projection_smoother.hpp where you use it.
 */
template <typename PointInT, typename PointOutT = PointInT>
class SLIMProjectionSmoother : public pcl::CloudSurfaceProcessing<PointInT, PointOutT>,
                               public SLIMSmootherBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMProjectionSmoother<PointInT, PointOutT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMProjectionSmoother<PointInT, PointOutT>>;
  using PointCloudIn = pcl::PointCloud<PointInT>;
  using PointCloudOut = pcl::PointCloud<PointOutT>;
  using PointCloudInPtr = typename PointCloudIn::Ptr;
  using PointCloudInConstPtr = typename PointCloudIn::ConstPtr;
  using PointCloudOutPtr = typename PointCloudOut::Ptr;
  using PointCloudOutConstPtr = typename PointCloudOut::ConstPtr;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;
  using NormalCloudPtr = NormalCloud::Ptr;
  using KdTree = pcl::search::Search<PointInT>;
  using KdTreePtr = typename KdTree::Ptr;
  using SearchMethod = std::function<int(pcl::index_t, double, pcl::Indices&, std::vector<float>&)>;

  // Input ----------------------------------------------------------------------------------------

  /** \brief Normals of the input cloud, one for each of its points; null: those of PointInT if it
   * has any. A zero or non-finite normal counts as missing: the point is left out of the fit, and
   * smoothed nevertheless. */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief Search object for setNormalEstimationNeighbors(); null: one that suits the cloud.
   * Smoothing has its own index and needs none. */
  void setSearchMethod(const KdTreePtr& search) { search_ = search; }
  KdTreePtr getSearchMethod() const { return search_; }

  /** \brief Estimates normals from the k nearest neighbours, as pcl::NormalEstimation does, and
   * fits with them; 0 estimates none (default: none are needed). */
  void setNormalEstimationNeighbors(int k) { normal_neighbours_ = k; }
  int getNormalEstimationNeighbors() const { return normal_neighbours_; }

  /** \brief The cloud whose points UpsamplingMethod DISTINCT_CLOUD projects. */
  void setDistinctCloud(PointCloudInConstPtr cloud) { distinct_cloud_ = std::move(cloud); }
  PointCloudInConstPtr getDistinctCloud() const { return distinct_cloud_; }

  // Running --------------------------------------------------------------------------------------

  /** \brief Smooths. Empty output and getError() when it cannot. The output may be the input
   * cloud. O(points) time and memory. */
  void process(PointCloudOut& output) override;

 protected:
  using pcl::PCLBase<PointInT>::input_;
  using pcl::PCLBase<PointInT>::indices_;
  using pcl::PCLBase<PointInT>::use_indices_;

  void performProcessing(PointCloudOut& output) override;

 private:
  PointCloudInConstPtr distinct_cloud_;
  NormalCloud::ConstPtr normals_;
  KdTreePtr search_;
  int normal_neighbours_ = 0;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_projection_smoother.hpp"
#endif
