// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comparison/mesh_surface.h"
#include "mesh/bench_mesh.h"

namespace pcl_slim::mesh_bench {

/** \brief How a smoothed mesh compares with the original; lengths in the original's mean edges. */
struct Measures {
  double surface_rms = 0;  ///< distances of the vertices from the original's surface
  double vertex_rms = 0;   ///< distances of the vertices from their originals
  double angle = 0;        ///< mean angle between the normals of a face and its original, degrees
  double volume = 0;       ///< volume over the original's, less 1
  double sharp_rms = 0;    ///< as surface_rms, of vertices on sharp edges; 0: there are none
  double sharp_angle = 0;  ///< mean error of the angle between faces at sharp edges, degrees
  std::size_t folded = 0;  ///< faces that face more than 90 degrees away from their originals
  std::size_t newly_folded = 0;  ///< those among them that did not so in the input
};

/** \brief Compares smoothed meshes with the original of a pair, vertex by vertex and face by face.
 * Edges are sharp where the original's faces part by more than 40 degrees. What concerns the
 * original alone is found once, in O(faces log faces). */
class Comparison {
 public:
  /** \brief The pair must outlive it. */
  explicit Comparison(const Pair& pair);

  /** \brief O(vertices log faces), on all cores. */
  Measures of(const Points& smoothed) const;

 private:
  void measureFaces(const Points& smoothed, Measures& m) const;
  std::vector<std::uint8_t> sharpVertices() const;

  const Pair& pair_;
  comparison::MeshSurface surface_;
  MeshTopology topology_;
  Points normals_, noisy_normals_,
      sides_;                        ///< sides: sums of the areas of a face and those around it
  std::vector<std::uint8_t> sharp_;  ///< vertices at which two faces part by a sharp edge
};

}  // namespace pcl_slim::mesh_bench
