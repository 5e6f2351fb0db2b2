// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "mesh/bench_mesh.h"

namespace pcl_slim::mesh_bench {

/** \brief Bilateral filter of vertices over the planes of faces near them (Jones, Durand, Desbrun:
 * Non-iterative, feature-preserving mesh smoothing, SIGGRAPH 2003). Both widths in mean edges. */
struct JonesParams {
  double spatial =
      2;  ///< sigma_f: standard deviation over distances; normals are mollified by half
  double range = 0.5;  ///< sigma_g: over the heights of planes
};

Points jonesFilter(const Points& vertices, const MeshFaces& faces, const JonesParams& params);

/** \brief Called with how far an iterative filter has come, with the mesh as it would be if it ended
 * there. */
using Snapshot = std::function<void(int iterations, const Points& vertices)>;

/** \brief Bilateral filter of face normals, local scheme, then vertices that follow them (Zheng,
 * Fu, Au, Tai: Bilateral normal filtering for mesh denoising, TVCG 2011). */
struct NormalFilterParams {
  double range = 0.35;         ///< sigma over differences of normals
  std::vector<int> snapshots;  ///< numbers of iterations to be reported, ascending
  int vertex_iterations = 10;  ///< of the vertex update
};

void bilateralNormalFilter(const Points& vertices, const MeshFaces& faces,
                           const NormalFilterParams& params, const Snapshot& tell);

/** \brief The same with weights from a guidance: the mean normal of the most consistent patch that
 * contains a face; vertices follow after each iteration (Zhang, Deng, Zhang, Bouaziz, Liu: Guided mesh
 * normal filtering, Pacific Graphics 2015). */
void guidedNormalFilter(const Points& vertices, const MeshFaces& faces,
                        const NormalFilterParams& params, const Snapshot& tell);

/** \brief Projects vertices onto the SLIM surface fitted to them, as SLIMProjectionSmoother does.
 */
Error plainProjection(const Points& vertices, const MeshFaces& faces, bool sharp, int threads,
                      Points& made);

/** \brief Moves vertices towards given face normals: each by the mean of the steps to the planes
 * through the centroids of its faces (Sun, Rosin, Martin, Langbein: Fast and effective
 * feature-preserving mesh denoising, TVCG 2007). */
void followNormals(const Points& normals, const MeshFaces& faces, const MeshTopology& topology,
                   int iterations, Points& vertices);

/** \brief Faces within a distance of a face's centroid, reached over shared corners; the face
 * itself comes first. seen must be as long as the faces and contain no number above f. */
void facesWithin(const Points& centroids, const MeshTopology& topology, std::uint32_t f,
                 double reach, std::vector<std::uint32_t>& seen, std::vector<std::uint32_t>& found);

}  // namespace pcl_slim::mesh_bench
