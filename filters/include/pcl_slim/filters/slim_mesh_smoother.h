// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/memory.h>

#include "pcl_slim/core/export.h"
#include "pcl_slim/filters/given_surface.h"
#include "pcl_slim/filters/slim_fit_base.h"
#include "pcl_slim/mesh/mesh_smoothing.h"

namespace pcl_slim {

/** \brief Smooths a polygon mesh by the SLIM surface of its vertices (Ohtake, Belyaev, Alexa:
 * Sparse low-degree implicit surfaces, SGP 2005, Fig. 20): faces get the surface's normals at their
 * projected centroids, and vertices follow. Edges of machine parts stay sharp, and no face turns
 * over.
 *
 * A replacement for pcl::MeshSmoothingLaplacianVTK:
 * \code
 * pcl_slim::SLIMMeshSmoother smoother;
 * smoother.setInputMesh(mesh);
 * pcl::PolygonMesh smooth;
 * if (!smoother.process(smooth)) std::cerr << smoother.getError().message << "\n";
 * \endcode
 *
 * Vertices and faces keep their order, with every field of the vertices kept; x y z are written in
 * their type, float or double. Vertices with a NaN or infinite coordinate, and those that no face
 * names, stay as they are; faces with such a vertex, with a vertex twice or with fewer than three
 * are ignored. The result is the same for any number of threads.
 *
 * No mesh, one without vertices, without x y z of type float or double, without a usable face, or
 * with a face that names no vertex is an error: the output is then empty and getError() gives the
 * reason.
 *
 * Setters of the fit are those of SLIMFit. setSharpFeatures() keeps or rounds all edges; without a
 * call of it this is decided by the mesh's angles.
 */
class PCL_SLIM_EXPORT SLIMMeshSmoother : public SLIMFitBase, public GivenSurface {
 public:
  using Ptr = pcl::shared_ptr<SLIMMeshSmoother>;
  using ConstPtr = pcl::shared_ptr<const SLIMMeshSmoother>;

  // Input ----------------------------------------------------------------------------------------

  /** \brief The mesh: triangles or larger faces. Normals are taken from the faces. */
  void setInputMesh(const pcl::PolygonMesh::ConstPtr& mesh) { input_ = mesh; }
  pcl::PolygonMesh::ConstPtr getInputMesh() const { return input_; }

  // Parameters -----------------------------------------------------------------------------------

  /** \brief What to do at edges (default: decided by the mesh's angles). */
  void setEdges(MeshEdges edges) { edges_ = edges; }
  MeshEdges getEdges() const { return edges_; }

  /** \brief setEdges() by the setter of SLIMFit: keep all, or round all. */
  void setSharpFeatures(bool sharp) { edges_ = sharp ? MeshEdges::kSharp : MeshEdges::kRounded; }
  bool getSharpFeatures() const { return edges_ == MeshEdges::kSharp; }

  /** \brief Whether to write the smooth mesh's normals at the vertices, where the mesh has fields
   * normal_x normal_y normal_z of type float (default on). Off, they are kept as they are. */
  void setComputeNormals(bool compute) { compute_normals_ = compute; }
  bool getComputeNormals() const { return compute_normals_; }

  // Running --------------------------------------------------------------------------------------

  /** \brief Smooths. \return false with getError() and an empty output when it cannot. The output
   * may be the input mesh. O(vertices + faces) time and memory. */
  bool process(pcl::PolygonMesh& output);

  /** \brief What the last run did and what it left alone. */
  const MeshSmoothStatistics& getMeshStatistics() const { return mesh_statistics_; }

 private:
  Error smooth(pcl::PolygonMesh& made);

  pcl::PolygonMesh::ConstPtr input_;
  MeshEdges edges_ = MeshEdges::kMeasured;
  bool compute_normals_ = true;
  MeshSmoothStatistics mesh_statistics_;
};

}  // namespace pcl_slim
