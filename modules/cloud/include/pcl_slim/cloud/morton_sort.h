// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Sorts fewer than 2^32 keys of 63 bits ascending, ties by their places.
 *
 * sortByLeadingBits(), then a comparison sort inside the short runs that share them.
 * O(N); same result for any number of threads. \param[out] order old position of each key. */
PCL_SLIM_EXPORT void sortByKey(AlignedVector<std::uint64_t>& keys,
                               AlignedVector<std::uint32_t>& order, int threads);

/** \brief Sorts fewer than 2^32 keys of 63 bits by their leading bits, ties by their places.
 *
 * As sortByBits(), of numbers of a place and the bits below those the first pass distinguishes, as
 * many as fit: 52 bits in all of 10M keys, 63 of up to 4,095. Few points of a scan share them.
 * \param[out] keys the other bits are 0. \param[out] order old position of each key. \return how
 * many bits the others are. O(N) for Morton codes of surfaces and volumes, O(N log N) at worst; 8
 * bytes a key more; same result for any number of threads. */
PCL_SLIM_EXPORT int sortByLeadingBits(AlignedVector<std::uint64_t>& keys,
                                      AlignedVector<std::uint32_t>& order, int threads);

/** \brief Sorts fewer than 2^32 numbers by their bits [low, high), stably; bits above must be
 * equal.
 *
 * One radix pass over all, then passes over the leading bits inside the buckets it makes, which fit
 * into a cache unless most numbers share their first bits, then insertion where few share those.
 * O(N) for Morton codes of surfaces and volumes, O(N log N) at worst; 8 bytes a number more; same
 * result for any number of threads.
 */
PCL_SLIM_EXPORT void sortByBits(AlignedVector<std::uint64_t>& values, int low, int high,
                                int threads);

}  // namespace pcl_slim
