// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/core/aligned.h"

namespace pcl_slim {

/** \brief Sorts keys ascending, ties by index; keys and indices are moved together.
 *
 * Stable radix passes over the leading bits, then a comparison sort inside the short runs that
 * share them. O(N); same result for any number of threads.
 */
void
sortByKey(AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& indices, int threads);

}  // namespace pcl_slim
