// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace pcl_slim {

/** \brief Memory that starts on a cache line. From 2 MiB on it starts on a large page, and the
 * system is asked for such: a page comes at its first use, and that takes a quarter of the time of
 * a pass or two over new memory in small pages. Throws std::bad_alloc. */
void*
allocateAligned(std::size_t bytes);

/** \brief Gives back what allocateAligned(bytes) gave. */
void
freeAligned(void* block, std::size_t bytes);

/** \brief Allocator with 64-byte alignment that leaves new plain values uninitialised. */
template <typename T>
struct AlignedAllocator {
  using value_type = T;
  AlignedAllocator() = default;
  template <typename U>
  AlignedAllocator(const AlignedAllocator<U>&)
  {
  }

  T* allocate(std::size_t n) { return static_cast<T*>(allocateAligned(n * sizeof(T))); }
  void deallocate(T* p, std::size_t n) { freeAligned(p, n * sizeof(T)); }

  template <typename U>
  void construct(U* p)
  {
    ::new (static_cast<void*>(p)) U;
  }
  template <typename U, typename... Args>
  void construct(U* p, Args&&... args)
  {
    ::new (static_cast<void*>(p)) U(static_cast<Args&&>(args)...);
  }

  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
  friend bool operator!=(const AlignedAllocator&, const AlignedAllocator&) { return false; }
};

/** \brief Vector whose data starts on a cache line; resize() does not clear new values. */
template <typename T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

}  // namespace pcl_slim
