// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/given_surface.h"
#include "pcl_slim/filters/slim_fit_base.h"
#include "pcl_slim/mesh/mesh_extraction.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

/** \brief Parameters and results of SLIMReconstruction that do not depend on the point type;
 * MeshParams documents each. Values are checked when reconstruct() runs. */
class PCL_SLIM_EXPORT SLIMReconstructionBase : public SLIMFitBase, public GivenSurface {
 public:
  // Parameters -----------------------------------------------------------------------------------

  /** \brief All parameters of the mesh together; threads and trimming are those of the fit's
   * setters. */
  void setMeshParams(const MeshParams& params) { mesh_params_ = params; }
  const MeshParams& getMeshParams() const { return mesh_params_; }

  /** \brief Largest distance between mesh and surface, in the cloud's units; 0 (default): a quarter
   * of the noise, and at least 1e-4 of the diagonal. */
  void setTolerance(double tolerance) { mesh_params_.tolerance = tolerance; }
  double getTolerance() const { return mesh_params_.tolerance; }

  /** \brief Collapses edges until there are no more triangles; 0: no limit (default). */
  void setMaxTriangles(std::uint64_t count) { mesh_params_.max_triangles = count; }
  std::uint64_t getMaxTriangles() const { return mesh_params_.max_triangles; }

  /** \brief Holes of the mesh are closed unless as large as a disc of this diameter, in spacings of
   * the points (default 6); 0 keeps all that the surface has. Those of the surface are set by
   * setHoleSize(); unless that is called, the surface keeps what the mesh needs. */
  void setMeshHoleSize(double spacings) { mesh_params_.hole_size = spacings; }
  double getMeshHoleSize() const { return mesh_params_.hole_size; }

  /** \brief Closes every border loop, so that the mesh is a body (default off). */
  void setWatertight(bool watertight) { mesh_params_.watertight = watertight; }
  bool getWatertight() const { return mesh_params_.watertight; }

  /** \brief Leaves out components with fewer points (default 50); 0 keeps all. */
  void setMinComponentPoints(double points) { mesh_params_.min_component_points = points; }
  double getMinComponentPoints() const { return mesh_params_.min_component_points; }

  /** \brief Rounds of tangential smoothing of the triangles (default 2). */
  void setRelaxation(int rounds) { mesh_params_.relax = rounds; }
  int getRelaxation() const { return mesh_params_.relax; }

  /** \brief Whether a pcl::PolygonMesh gets fields k1 and k2 (default off). */
  void setComputeCurvature(bool compute) { compute_curvature_ = compute; }
  bool getComputeCurvature() const { return compute_curvature_; }

  /** \brief Whether vertices get the colours of the points nearest to them, where PointT has any
   * (default on). */
  void setColors(bool colors) { colors_ = colors; }
  bool getColors() const { return colors_; }

  // Results --------------------------------------------------------------------------------------

  /** \brief What the last run made and left out. */
  const MeshStatistics& getMeshStatistics() const { return mesh_statistics_; }
  /** \brief The last run's mesh: coordinates in double, normals, curvatures, colours. */
  const TriangleMesh& getMesh() const { return mesh_; }

 protected:
  SLIMReconstructionBase() = default;
  ~SLIMReconstructionBase() = default;

  /** \brief Forgets the last run. */
  void clearMesh();
  /** \brief Fits unless there is a surface, and extracts the mesh. \return whether there is one;
   * getError() gives the reason if not. */
  bool makeMesh(const ScanView& scan);
  /** \brief The surface variation of the 30 vertices around each, 0 where there are too few. */
  std::vector<float> vertexVariation() const;

  MeshParams mesh_params_;
  MeshStatistics mesh_statistics_;
  TriangleMesh mesh_;
  bool compute_curvature_ = false, colors_ = true;

 private:
  /** \brief Fits; with sharp features and normals two surfaces: edges come from one, what is
   * between them and how it is connected from the other. \param[out] sharp the former */
  bool fitSurfaces(const CloudView& cloud, SLIMSurface& surface, SLIMSurface& sharp);
};

}  // namespace pcl_slim
