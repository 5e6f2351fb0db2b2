// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/mesh/mesh_faces.h"

namespace pcl_slim::detail {

/** \brief Counts edges along which two faces run in the same direction, so that their sides disagree,
 * and edges of more than two faces. O(corners log corners). */
void
countEdges(const MeshFaces& faces, std::uint64_t& disagreeing, std::uint64_t& nonmanifold);

}  // namespace pcl_slim::detail
