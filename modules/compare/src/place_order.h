// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief The order of places along a Morton curve through their box; those that are not finite come
 * last. O(N), 20 bytes a place while it is made; the same for any number of threads. At most 2^32 - 1
 * places. \param[out] finite how many are finite */
AlignedVector<std::uint32_t> mortonOrder(const Vector3* places, std::size_t count, int threads,
                                         std::size_t& finite);

/** \brief Up to most finite places, evenly along their Morton order. */
std::vector<std::uint32_t> evenChoice(const Vector3* places, std::size_t count, std::size_t most,
                                      int threads);

/** Places of one run are treated by one thread in their order, so that each search can begin with the
 * result of the one before. */
constexpr std::size_t kRun = 512;

}  // namespace pcl_slim::detail
