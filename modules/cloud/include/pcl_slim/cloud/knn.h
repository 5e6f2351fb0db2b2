// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Exact k nearest neighbours of stored points; keeps its scratch memory between queries.
 *
 * The neighbours in Morton order bound the distance; one ball query does the rest. One object
 * per thread, which share no cache line.
 */
class alignas(64) NeighborSearch {
 public:
  explicit NeighborSearch(const PointStore& store) : store_(store) {}

  /** \brief Looks at every stride-th stored point only: an even sample of the cloud. */
  NeighborSearch(const PointStore& store, std::size_t stride) : store_(store), stride_(stride) {}

  /** \brief The k points nearest to stored point i, itself included where it is looked at, nearest
   * first (ties by index); fewer if there are fewer. \param[out] neighbors stored indices.
   * \param[out] distances_sq squared local distances. \param[in] about a squared distance that
   * probably contains k points and few more, which saves time, not points; 0: none is known. */
  PCL_SLIM_EXPORT void nearest(std::size_t i, std::size_t k, std::vector<std::uint32_t>& neighbors,
                               std::vector<float>& distances_sq, float about = 0);

  /** \brief The same points in stored order, for whom the nearest first is no use: cheaper.
   * \return the squared distance of the farthest. */
  PCL_SLIM_EXPORT float nearestSet(std::size_t i, std::size_t k,
                                   std::vector<std::uint32_t>& neighbors, float about = 0);

 private:
  std::size_t collectNearest(std::size_t i, std::size_t k, float about);
  void findBlocks(const std::array<double, 3>& center, float limit_sq);
  float boundRadiusSq(std::size_t i, std::size_t k, const std::array<double, 3>& center);
  std::size_t dropUnsampled(std::size_t count);
  void collect(const std::array<double, 3>& center, float limit_sq);

  const PointStore& store_;
  std::size_t stride_ = 1;             ///< of the points looked at
  std::vector<std::uint32_t> blocks_;  ///< to be looked through
  AlignedVector<float> distances_sq_;  ///< of what was collected from them ...
  AlignedVector<std::uint32_t> points_;
  AlignedVector<std::uint64_t> keys_, spare_;  ///< ... and both in one: distances high, points low
};

}  // namespace pcl_slim
