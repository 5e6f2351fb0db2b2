// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/point_types.h>
#include <pcl/surface/reconstruction.h>

#include <string>
#include <vector>

#include "pcl_slim/filters/slim_reconstruction_base.h"

namespace pcl_slim {

/** \brief Reconstructs a triangle mesh from a cloud: the SLIM surface fitted to it, triangulated.
 *
 * A replacement for pcl::Poisson that needs no normals:
 * \code
 * pcl_slim::SLIMReconstruction<pcl::PointXYZ> reconstruction;
 * reconstruction.setInputCloud(cloud);
 * pcl::PolygonMesh mesh;
 * reconstruction.reconstruct(mesh);
 * if (reconstruction.getError()) std::cerr << reconstruction.getError().message << "\n";
 * \endcode
 *
 * Every setter of the fit is there. Closed bodies give closed meshes; open scans give meshes that
 * end where the points do, with their holes; setWatertight() closes those. Every edge has at most two triangles, which face the
 * side of the normals. A search method is not needed and not used.
 *
 * A missing or empty cloud, one without a finite point, indices and parameters out of range are
 * errors: the output is then empty, and getError() gives the reason. The result is the same for any
 * number of threads.
 *
 * Compiled for the point types SLIMFit is compiled for. For one of your own, include
 * pcl_slim/filters/impl/slim_reconstruction.hpp where you use it.
 */
template <typename PointT>
class SLIMReconstruction : public pcl::SurfaceReconstruction<PointT>,
                           public SLIMReconstructionBase {
 public:
  using Ptr = pcl::shared_ptr<SLIMReconstruction<PointT>>;
  using ConstPtr = pcl::shared_ptr<const SLIMReconstruction<PointT>>;
  using PointCloud = pcl::PointCloud<PointT>;
  using NormalCloud = pcl::PointCloud<pcl::Normal>;

  SLIMReconstruction() { check_tree_ = false; }

  /** \brief Normals of the input cloud, one for each of its points; null: those of PointT, if any.
   */
  void setInputNormals(const NormalCloud::ConstPtr& normals) { normals_ = normals; }
  NormalCloud::ConstPtr getInputNormals() const { return normals_; }

  /** \brief The mesh with fields x y z, normals, rgb where PointT has colours, and k1 k2 if
   * requested; the header is the cloud's. O(points + triangles). */
  void reconstruct(pcl::PolygonMesh& output) override;

  /** \brief The same as points of the input's type, with normals, colours and curvature where it
   * has such fields. curvature is the surface variation of the 30 vertices around, as
   * pcl::NormalEstimation computes it with setKSearch(30). */
  void reconstruct(PointCloud& points, std::vector<pcl::Vertices>& polygons) override;

 protected:
  using pcl::SurfaceReconstruction<PointT>::check_tree_;
  using pcl::SurfaceReconstruction<PointT>::input_;
  using pcl::SurfaceReconstruction<PointT>::indices_;
  using pcl::PCLBase<PointT>::use_indices_;

  void performReconstruction(pcl::PolygonMesh& output) override;
  void performReconstruction(PointCloud& points, std::vector<pcl::Vertices>& polygons) override;
  std::string getClassName() const override { return "SLIMReconstruction"; }

 private:
  /** \brief Makes the mesh; prints an error as PCL's classes do. */
  bool run();

  NormalCloud::ConstPtr normals_;
};

}  // namespace pcl_slim

#ifdef PCL_NO_PRECOMPILE
#include "pcl_slim/filters/impl/slim_reconstruction.hpp"
#endif
