// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

/** \brief Compares vertex by vertex and face by face. Edges are sharp where the original's faces
 * part by more than 40 degrees. O(vertices log faces). */
Measures
compare(const Pair& pair, const Points& smoothed);

}  // namespace pcl_slim::mesh_bench
