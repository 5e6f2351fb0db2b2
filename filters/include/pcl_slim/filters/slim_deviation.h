// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/pcl_base.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <memory>

#include "pcl_slim/filters/point_deviation.h"
#include "pcl_slim/filters/slim_deviation_base.h"

namespace pcl_slim {

/** \brief Signed distances of a cloud's points from a reference, each with its 95 % level of
 * detection: what is larger is more than the errors of both explain.
 *
 * \code
 * pcl_slim::SLIMDeviation<pcl::PointXYZ> deviation;
 * deviation.setInputCloud(after);
 * deviation.setReference(before);  // a cloud, a SLIMSurface or a pcl::PolygonMesh
 * pcl::PointCloud<pcl_slim::PointDeviation> output;
 * if (!deviation.compute(output)) std::cerr << deviation.getError().message << "\n";
 * \endcode
 *
 * A surface is fitted to the input, unless setSurface() gives one, and its points are moved onto it,
 * which averages their noise; the error that remains is estimated for each. A reference cloud gets a
 * surface with the same parameters. Distances are along the reference's normal, exact for a mesh.
 * Where both have sides, each side of a thin part is compared with the same side; a cloud whose
 * normals face the other way than the reference's is turned.
 *
 * The output has one point for each of the input, or for each index, with width and height kept
 * without indices. Points beyond the reference's border, behind a wall, or beyond setMaxDistance()
 * have no counterpart: their deviation is NaN, as that of points with a NaN coordinate, and is_dense
 * is then false. The result is the same for any number of threads.
 *
 * A missing or empty cloud or reference, one without a finite point, indices out of range, a mesh
 * without triangles and parameters out of range are errors: the output is then empty and getError()
 * gives the reason.
 *
 * Compiled for the inputs SLIMCrestLines is compiled for. For other types include
 * pcl_slim/filters/impl/slim_deviation.hpp where you use them.
 */
template <typename PointT>
class SLIMDeviation : public pcl::PCLBase<PointT>, public SLIMDeviationBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMDeviation<PointT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMDeviation<PointT>>;
  using PointCloud = pcl::PointCloud<PointT>;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;

  // Input ----------------------------------------------------------------------------------------

  /** \brief Normals of the input cloud, one for each of its points; null: those of PointT if it has
   * any. */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief Compares with a cloud; a surface is fitted to it. The last reference set counts. */
  void setReference(const typename PointCloud::ConstPtr& cloud);
  /** \brief The same with a surface, which is shared and must not change while a run uses it. */
  void setReference(const SurfaceConstPtr& surface);
  /** \brief The same with a copy of it. */
  void setReference(const SLIMSurface& surface) {
    setReference(std::make_shared<const SLIMSurface>(surface));
  }
  /** \brief The same with the exact triangles of a mesh. */
  void setReference(const pcl::PolygonMesh::ConstPtr& mesh);

  // Running --------------------------------------------------------------------------------------

  /** \brief Measures. \return false with getError() and an empty output when it cannot.
   * O(points log points) time, 120 bytes a point. */
  bool compute(pcl::PointCloud<PointDeviation>& output);

 protected:
  using pcl::PCLBase<PointT>::input_;
  using pcl::PCLBase<PointT>::indices_;
  using pcl::PCLBase<PointT>::use_indices_;

 private:
  void write(const PlaceColumns& places, const Deviations& deviations,
             pcl::PointCloud<PointDeviation>& output) const;

  NormalCloud::ConstPtr normals_;
  typename PointCloud::ConstPtr reference_cloud_;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_deviation.hpp"
#endif
