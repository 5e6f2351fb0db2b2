// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/core/progress.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/fit/fit.h"
#include "pcl_slim/mesh/mesh_faces.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief What to do at sharp edges between faces. */
enum class MeshEdges : std::uint8_t {
  kMeasured,  ///< sharp if the mesh has few and strong edges, as machine parts have
  kRounded,   ///< smooth across them, as over a body
  kSharp,     ///< keep them
};

/** \brief How a mesh is smoothed. */
struct MeshSmoothParams {
  /** The fit to the vertices. Its sharp_features follows from edges; with paper_mode no normal is
   * filtered, and vertices go to the planes through the projected centroids in one step. */
  FitParams fit;
  MeshEdges edges = MeshEdges::kMeasured;

  /** \brief Names the first parameter outside its range. */
  Error validate() const { return fit.validate(); }
};

/** \brief What a smoothing did and what it left alone. */
struct MeshSmoothStatistics {
  FitStatistics fit;                 ///< of the last fit; empty with a given surface
  std::uint64_t faces = 0;           ///< faces given
  std::uint64_t faces_left_out = 0;  ///< of less than three corners, or with one that is not finite
  std::uint64_t faces_unsupported = 0;  ///< on no surfel: their normals come from their neighbours
  std::uint64_t disagreeing_edges = 0;  ///< two faces run along an edge in the same direction
  std::uint64_t nonmanifold_edges = 0;  ///< edges of more than two faces
  std::uint64_t moved = 0;              ///< vertices with a new position
  std::uint64_t isolated = 0;           ///< finite vertices without a face: they keep their place
  std::uint64_t non_finite = 0;         ///< vertices with a NaN or infinite coordinate
  std::uint64_t held = 0;       ///< vertices not moved at some step, so that no face turns over
  bool sharp = false;           ///< edges were kept
  double sharp_share = 0;       ///< share of the mesh's bending in its sharp edges
  double noise = 0;             ///< deviation of the vertices' noise, mean edge lengths
  double rms_displacement = 0;  ///< of moved vertices, world units
  double max_displacement = 0;
};

/** \brief A smoothed mesh: vertices and faces in the order given. */
struct SmoothedMesh {
  std::vector<Vector3> vertices;      ///< world coordinates
  std::vector<Vector3> normals;       ///< unit, at the vertices; zero for those without faces
  std::vector<Vector3> face_normals;  ///< unit, to the face's own side; zero where left out
};

/** \brief Smooths a mesh by the SLIM surface of its vertices (Ohtake, Belyaev, Alexa 2005, section
 * 5, Fig. 20): centroids of faces are projected onto the surface, eq. 7 gives the faces' normals
 * there, and vertices minimise quadratic errors to the faces' planes.
 *
 * By default the normals found are weighed against those of the mesh itself, each averaged over the
 * faces around it, and vertices follow in small steps; where edges are kept, the surface's normals
 * decide which neighbours belong to one side. No face turns over. Faces, and vertices without
 * faces, stay.
 *
 * \param[in] cloud the vertices; its normals and indices are not read. \param[in] surface a surface
 * of these vertices in place of a fit, or null. \return an error for faces that name no vertex,
 * none that can be used, parameters out of range, or cancellation; the result is then empty. The
 * same for any number of threads. O(vertices + faces).
 */
PCL_SLIM_EXPORT Error smoothMesh(const CloudView& cloud, const MeshFaces& faces,
                                 const MeshSmoothParams& params, const SLIMSurface* surface,
                                 SmoothedMesh& result, MeshSmoothStatistics* statistics = nullptr,
                                 SLIMSurface* fitted = nullptr, Progress* progress = nullptr);

}  // namespace pcl_slim
