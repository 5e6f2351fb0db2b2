// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/core/aligned.h"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pcl_slim {

namespace {

constexpr std::size_t kLine = 64;
constexpr std::size_t kLargePage = std::size_t{1} << 21;

/** Where a block of that size starts: large pages do not pay for less than one. */
std::align_val_t
alignmentOf(std::size_t bytes)
{
  return std::align_val_t(bytes >= kLargePage ? kLargePage : kLine);
}

}  // namespace

void*
allocateAligned(std::size_t bytes)
{
  void* const block = ::operator new(bytes, alignmentOf(bytes));
#ifdef MADV_HUGEPAGE
  if (bytes >= kLargePage) madvise(block, bytes, MADV_HUGEPAGE);  // a hint: refusal does no harm
#endif
  return block;
}

void
freeAligned(void* block, std::size_t bytes)
{
  ::operator delete(block, alignmentOf(bytes));
}

}  // namespace pcl_slim
