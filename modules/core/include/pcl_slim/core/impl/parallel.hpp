// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#ifdef _OPENMP
#include <omp.h>
#endif

#include <cstdint>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

template <typename Body>
void
parallelFor(std::size_t count, int threads, std::size_t chunk, const Body& body)
{
  if (threads <= 1 || count <= chunk) {
    for (std::size_t i = 0; i < count; ++i) body(i, 0);
    return;
  }
#ifdef _OPENMP
  std::exception_ptr failure;
  const auto chunks = static_cast<std::int64_t>((count + chunk - 1) / chunk);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (std::int64_t c = 0; c < chunks; ++c) {
    try {
      const std::size_t begin = static_cast<std::size_t>(c) * chunk;
      const std::size_t end = begin + chunk < count ? begin + chunk : count;
      for (std::size_t i = begin; i < end; ++i) body(i, omp_get_thread_num());
    } catch (...) {
#pragma omp critical(pcl_slim_parallel_failure)
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
#else
  for (std::size_t i = 0; i < count; ++i) body(i, 0);
#endif
}

}  // namespace pcl_slim
