// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <exception>

namespace pcl_slim {

/** \brief Number of threads to use for a request: 0 (or less) means every available core. */
int
resolveThreads(int requested);

/** \brief Runs body(i, thread) for i in [0, count), in chunks handed out dynamically.
 *
 * The order in which indices run is unspecified, so body must write by index only; sums belong
 * into fixed-size partial results that are added in index order afterwards. All threads run at once.
 * Inside a body another loop runs on the body's thread alone. The first exception thrown by body is
 * rethrown here once every thread has stopped, and no new chunk is begun.
 */
template <typename Body>
void
parallelFor(std::size_t count, int threads, std::size_t chunk, const Body& body);

}  // namespace pcl_slim

#include "pcl_slim/core/impl/parallel.hpp"
