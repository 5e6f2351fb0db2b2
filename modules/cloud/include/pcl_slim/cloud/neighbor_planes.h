// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Neighbours of the surface variation that pcl_slim writes into PCL's field curvature. */
constexpr std::size_t kVariationNeighbors = 30;

/** \brief The plane through the neighbours of each stored point, by the eigenvalues l0 <= l1 <= l2
 * and eigenvectors of their covariance. */
struct NeighborPlanes {
  std::vector<float> normals;    ///< three per point, unit, of either side
  std::vector<float> variation;  ///< l0 / (l0 + l1 + l2) per point, 0 to 1/3
};

/** \brief Finds them from about k neighbours, the point itself included.
 *
 * Neighbours are those in a ball whose radius follows the local density, for 16 points of Morton
 * order together; where it has fewer than .6 k or more than 1.7 k, the k nearest. Two points or
 * fewer, and points of one line, give some normal perpendicular to the line; a single position z.
 * \param[in] variation false leaves that empty. O(points k). The same for any number of threads.
 * \param[in] only stored points whose planes are wanted, those of others may be 0; null: all */
PCL_SLIM_EXPORT NeighborPlanes findNeighborPlanes(const PointStore& store, std::size_t k,
                                                  bool variation, int threads,
                                                  const std::vector<std::uint32_t>* only = nullptr);

/** \brief The surface variation of the kVariationNeighbors points around each selected point of a
 * cloud: what pcl_slim writes into PCL's field curvature. NaN at points that are not finite or too
 * far from all others, and everywhere in clouds of fewer than three points. O(points). */
PCL_SLIM_EXPORT std::vector<float> surfaceVariation(const CloudView& cloud, int threads);

}  // namespace pcl_slim
