// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/pcl_base.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/search.h>

#include "pcl_slim/filters/cloud_description.h"
#include "pcl_slim/filters/io/surface_conversion.h"
#include "pcl_slim/filters/slim_fit_base.h"

namespace pcl_slim {

/** \brief Fits a SLIM surface, a sparse set of overlapping local polynomials, to a point cloud
 * (Ohtake, Belyaev, Alexa: Sparse low-degree implicit surfaces, SGP 2005).
 *
 * \code
 * pcl_slim::SLIMFit<pcl::PointXYZ> fit;
 * fit.setInputCloud(cloud);
 * pcl_slim::SLIMSurface surface;
 * if (!fit.fit(surface)) std::cerr << fit.getError().message << "\n";
 * \endcode
 *
 * Normals are optional: those of setInputNormals() come first, then estimated ones when
 * setNormalEstimationNeighbors() is set, then the fields of PointT. Without any, each ball
 * finds its own frame, and the surface gets one consistent side (setOrientation, setViewPoint,
 * setSensorPositions).
 *
 * Non-finite points are skipped and counted, duplicates merged, indices honoured. A missing or
 * empty cloud, one without a finite point, and indices out of range are errors. Outputs are
 * cleared first. The result is the same for any number of threads.
 *
 * Compiled for all of PCL_XYZ_POINT_TYPES.
 *
 * For a point type of your own, include pcl_slim/filters/impl/slim_fit.hpp where you use it.
 */
template <typename PointT>
class SLIMFit : public pcl::PCLBase<PointT>, public SLIMFitBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMFit<PointT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMFit<PointT>>;
  using PointCloud = pcl::PointCloud<PointT>;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;
  using SearchPtr = typename pcl::search::Search<PointT>::Ptr;

  // Input ----------------------------------------------------------------------------------------

  /** \brief Normals of the input cloud, one for each of its points; null: none. A zero or
   * non-finite normal counts as missing, and its point is left out. */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief Search object for estimating normals; null: OrganizedNeighbor for projectable
   * organized clouds, otherwise KdTree. The fit itself has its own index. */
  void setSearchMethod(const SearchPtr& search) { search_ = search; }
  SearchPtr getSearchMethod() const { return search_; }

  /** \brief Estimates normals from the k nearest neighbours, as pcl::NormalEstimation does;
   * 0 estimates none (default). */
  void setNormalEstimationNeighbors(int k) { normal_neighbours_ = k; }
  int getNormalEstimationNeighbors() const { return normal_neighbours_; }

  /** \brief Gives the surface the colours of the points (default on); without effect on clouds that
   * have no field rgb or rgba. PointSLIM has no colours: those of fit(SLIMSurface&) are kept. */
  void setColors(bool colors) { colors_ = colors; }
  bool getColors() const { return colors_; }

  // Running --------------------------------------------------------------------------------------

  /** \brief Fits the surface. \return false with getError() when there is none; surface is then
   * empty. O(points) time and memory. */
  bool fit(SLIMSurface& surface);

  /** \brief Fits and converts: one PointSLIM for each surfel, with the cloud's header.
   * \param[out] metadata what fromPCL() needs to give the exact surface back (may be null). */
  bool fit(pcl::PointCloud<PointSLIM>& surfels, SurfaceMetadata* metadata = nullptr);

 protected:
  using pcl::PCLBase<PointT>::input_;
  using pcl::PCLBase<PointT>::indices_;
  using pcl::PCLBase<PointT>::use_indices_;

  /** \brief The cloud and what was set about it. */
  CloudInput<PointT> cloudInput() const;

 private:
  NormalCloud::ConstPtr normals_;
  SearchPtr search_;
  int normal_neighbours_ = 0;
  bool colors_ = true;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_fit.hpp"
#endif
