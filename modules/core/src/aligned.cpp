// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/aligned.h"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pcl_slim {

namespace {

constexpr std::align_val_t kLine{64};

/** Requests large pages where the block has room for some. Memory that was used before keeps the
 * pages it has; refusal does no harm. */
void useLargePages([[maybe_unused]] void* block, [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t kLargePage = std::size_t{1} << 21, kPage = std::size_t{1} << 12;
  if (bytes < 2 * kLargePage) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(block);
  const std::uintptr_t first = (begin + kPage - 1) / kPage * kPage;
  const std::uintptr_t last = (begin + bytes) / kPage * kPage;
  madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

}  // namespace

void* allocateAligned(std::size_t bytes) {
  void* const block = ::operator new(bytes, kLine);
  useLargePages(block, bytes);
  return block;
}

void freeAligned(void* block) {
  ::operator delete(block, kLine);
}

}  // namespace pcl_slim
