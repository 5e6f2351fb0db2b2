// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/vector3.h"
#include "smoothing/face_geometry.h"

namespace pcl_slim::detail {

/** \brief The input of a pass over face normals in addition to the normals. */
struct NormalFilter {
  const FaceGeometry& geometry;
  const MeshTopology& topology;
  double range = 0.5;  ///< deviation over differences of guiding normals
  int threads = 0;
};

/** \brief Means of the normals of each face and those around it, weighed by area and by how much
 * their guiding normals agree with the face's. A face that finds no other keeps its normal. */
std::vector<Vector3>
filterNormals(const NormalFilter& filter, const std::vector<Vector3>& guide,
              const std::vector<Vector3>& normals);

/** \brief Means of the normals of the faces around each face, weighed by area; zero without any. */
std::vector<Vector3>
ringNormals(const NormalFilter& filter, const std::vector<Vector3>& normals);

/** \brief Replaces normals that differ from all around them by the mean of those. No edge separates one
 * face from all its neighbours by that much (66 degrees from their mean); folds and slivers do. */
void
mendLoneNormals(const NormalFilter& filter, std::vector<Vector3>& normals);

/** \brief Unit vectors along normals + weight * others, where others are not zero. */
void
pullNormals(const std::vector<Vector3>& others, double weight, std::vector<Vector3>& normals);

}  // namespace pcl_slim::detail
