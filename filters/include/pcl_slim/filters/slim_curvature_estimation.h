// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/features/feature.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "pcl_slim/filters/point_curvature.h"
#include "pcl_slim/filters/slim_projection_base.h"

namespace pcl_slim {

/** \brief Curvatures at the points of a cloud, from the SLIM surface fitted to it (Ohtake, Belyaev,
 * Alexa: Sparse low-degree implicit surfaces, SGP 2005, equation 8).
 *
 * \code
 * pcl_slim::SLIMCurvatureEstimation<pcl::PointXYZ> estimation;
 * estimation.setInputCloud(cloud);
 * pcl::PointCloud<pcl_slim::PointCurvature> curvatures;
 * if (!estimation.compute(curvatures)) std::cerr << estimation.getError().message << "\n";
 * \endcode
 *
 * Values are taken where the point meets the surface. Units and signs: PointCurvature. The normal
 * points to the side of the input's normal at that point, if there is one; otherwise towards the
 * viewpoint, if one is set, or what findSideEvidence() finds; otherwise outward; the curvatures'
 * signs follow.
 *
 * PointOutT may be any type with some of these fields, all float; others keep their defaults:
 * those of PointCurvature; pc1 pc2 principal_curvature_x.. (pcl::PrincipalCurvatures: k1, k2 and
 * the tangent of k1); curvature (the surface variation that PCL's classes write and read, see
 * SLIMSmootherBase::kSurfaceVariation); x y z (the place on the surface).
 *
 * As every pcl::Feature: one value for each point, or each index, width and height kept without
 * indices, the surface fitted to setSearchSurface() where that is given. Curvatures and directions
 * are NaN at points that no surfel supports, whose normal is the input's or that of their
 * neighbours; all is NaN at points with a NaN coordinate. is_dense is false where anything is NaN.
 * setKSearch() and setRadiusSearch() need not be called and mean nothing here: each ball of the
 * surface finds its own radius. The result is the same for any number of threads.
 *
 * A missing or empty cloud, one without a finite point, and indices out of range are errors: the
 * output is then empty, the error printed as PCL prints errors, and returned by getError().
 *
 * Compiled for the inputs SLIMCrestLines is compiled for, and for PointCurvature,
 * pcl::PrincipalCurvatures and pcl::Normal as output. For other types include
 * pcl_slim/filters/impl/slim_curvature_estimation.hpp where you use them. An input type of your own
 * needs, as with any pcl::Feature, pcl/kdtree/impl/kdtree_flann.hpp and pcl/search/impl/kdtree.hpp
 * too, and lz4 linked, which FLANN's headers call.
 */
template <typename PointInT, typename PointOutT = PointCurvature>
class SLIMCurvatureEstimation : public pcl::Feature<PointInT, PointOutT>,
                                public SLIMProjectionBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMCurvatureEstimation<PointInT, PointOutT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMCurvatureEstimation<PointInT, PointOutT>>;
  using Base = pcl::Feature<PointInT, PointOutT>;
  using PointCloudOut = typename Base::PointCloudOut;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;

  SLIMCurvatureEstimation() { this->feature_name_ = "SLIMCurvatureEstimation"; }

  // Input ----------------------------------------------------------------------------------------

  /** \brief Normals of the cloud the surface is fitted to (the search surface, else the input), one
   * for each of its points; null: those of PointInT if it has any. */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief Estimates normals from the k nearest neighbours, as pcl::NormalEstimation does, found
   * by the object of setSearchMethod(); 0 estimates none (default: none are needed). */
  void setNormalEstimationNeighbors(int k) { normal_neighbours_ = k; }
  int getNormalEstimationNeighbors() const { return normal_neighbours_; }

  // Running --------------------------------------------------------------------------------------

  /** \brief Computes the curvatures. \return false with getError() and an empty output when it
   * cannot. O(points) time and memory. */
  bool compute(PointCloudOut& output);

 protected:
  using pcl::PCLBase<PointInT>::input_;
  using pcl::PCLBase<PointInT>::indices_;
  using pcl::PCLBase<PointInT>::use_indices_;
  using Base::surface_;

  /** \brief Requires a cloud only: there is nothing to search. */
  bool initCompute() override;

 private:
  void computeFeature(PointCloudOut& output) override;
  /** \brief Fits and projects. */
  bool run(CloudProjection& projection, PointCloudOut& output);
  void write(const pcl::PointCloud<PointInT>& input, const pcl::Indices& indices,
             const CloudProjection& projection, PointCloudOut& output) const;
  bool refuse(ErrorCode code, const std::string& message);
  void complain() const;

  NormalCloud::ConstPtr normals_;
  int normal_neighbours_ = 0;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_curvature_estimation.hpp"
#endif
