// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Memory that starts on a cache line; large pages are requested from 4 MiB on.
 *
 * Memory comes at its first use, page by page, and for arrays that are passed over once or twice
 * that costs as much as the passes. Throws std::bad_alloc. */
PCL_SLIM_EXPORT void* allocateAligned(std::size_t bytes);

/** \brief Gives back what allocateAligned() gave. */
PCL_SLIM_EXPORT void freeAligned(void* block);

/** \brief Allocator with 64-byte alignment that leaves new plain values uninitialised. */
template <typename T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <typename U>
  AlignedAllocator(const AlignedAllocator<U>&) {}

  T* allocate(std::size_t n) { return static_cast<T*>(allocateAligned(n * sizeof(T))); }
  void deallocate(T* p, std::size_t) { freeAligned(p); }

  template <typename U>
  void construct(U* p) {
    ::new (static_cast<void*>(p)) U;
  }
  template <typename U, typename... Args>
  void construct(U* p, Args&&... args) {
    ::new (static_cast<void*>(p)) U(static_cast<Args&&>(args)...);
  }

  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
  friend bool operator!=(const AlignedAllocator&, const AlignedAllocator&) { return false; }
};

/** \brief Vector whose data starts on a cache line; resize() does not clear new values. */
template <typename T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

}  // namespace pcl_slim
