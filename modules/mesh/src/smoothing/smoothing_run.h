// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/mesh/mesh_smoothing.h"
#include "smoothing/face_geometry.h"
#include "smoothing/face_projection.h"
#include "smoothing/vertex_update.h"

namespace pcl_slim::detail {

/** \brief One smoothing of a mesh whose faces are all usable. */
class SmoothingRun {
 public:
  /** \brief Faces must outlive this object. \param[in] surface in place of a fit, or null. */
  SmoothingRun(const MeshFaces& faces, const std::vector<Vector3>& vertices,
               const MeshSmoothParams& params, const SLIMSurface* surface,
               MeshSmoothStatistics& statistics, Progress* progress);

  Error run();

  const std::vector<Vector3>& vertices() const { return moved_; }
  const std::vector<Vector3>& normals() const { return normals_; }
  /** \brief Of the smooth mesh, at its vertices. */
  std::vector<Vector3> vertexNormals() const;
  const std::vector<std::uint8_t>& held() const { return held_; }
  SLIMSurface takeFitted() { return std::move(fitted_); }

 private:
  /** \brief As the paper has it: one projection, one step of the vertices. */
  Error runAsPaper();
  /** \brief Smooth everywhere: the mesh's normals, weighed against the surface's. */
  Error runRounded();
  /** \brief Edges kept: the mesh's normals, averaged as far as the surface's agree. Only as far as
   * needed to see that there are no edges to keep, where that is asked. */
  Error runSharp();

  /** \brief One round of runSharp(). */
  Error sharpRound();
  /** \brief Whether the normals found are those of a mesh with edges. */
  bool hasSharpEdges();
  /** \brief Fits to the vertices as given, with normals from those of the faces, and projects the
   * centroids of the faces as they are now. */
  Error project(const std::vector<Vector3>& normals, FaceProjection& made);
  /** \brief Puts all vertices back and moves them towards the normals. */
  void moveVertices(int steps);

  MovingMesh moving();
  FaceGeometry facesNow() const;

  const MeshFaces& faces_;
  const std::vector<Vector3>& given_;
  MeshSmoothParams params_;
  const SLIMSurface* surface_;
  MeshSmoothStatistics& statistics_;
  Progress* progress_;
  MeshTopology topology_;
  FaceGeometry geometry_;  ///< of the mesh as given
  std::vector<Vector3> moved_, normals_;
  std::vector<std::uint8_t> held_;
  SLIMSurface fitted_;
};

}  // namespace pcl_slim::detail
