// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <exception>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Largest number of threads accepted; more are a mistake, and each costs memory. */
constexpr int kMostThreads = 4096;

/** \brief An error for a number of threads that is negative or above kMostThreads. */
PCL_SLIM_EXPORT Error
checkThreads(int requested);

/** \brief Number of threads to use for a request: 0 (or less) means every available core. */
PCL_SLIM_EXPORT int
resolveThreads(int requested);

/** \brief Runs body(i, thread) for i in [0, count), in chunks handed out dynamically.
 *
 * The order in which indices run is unspecified, so body must write by index only; sums belong
 * into fixed-size partial results that are added in index order afterwards. All callers share one
 * pool, oneTBB's: fewer threads than requested may run, so no body may wait for another to begin.
 * Loops inside a body run on its thread alone. An exception of a body ends the loop and is rethrown.
 */
template <typename Body>
void
parallelFor(std::size_t count, int threads, std::size_t chunk, const Body& body);

}  // namespace pcl_slim

#include "pcl_slim/core/impl/parallel.hpp"
