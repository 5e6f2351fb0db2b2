// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/morton_sort.h"

#include <algorithm>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr std::size_t kSlice = 1 << 14;  ///< keys a thread takes at a time
constexpr std::size_t kFew = 1 << 15;    ///< keys that one thread sorts

using Keys = AlignedVector<std::uint64_t>;
using Indices = AlignedVector<std::uint32_t>;

template <typename Body>
void
forAll(std::size_t n, int threads, const Body& body)
{
  parallelFor(n, threads, kSlice, [&](std::size_t i, int) { body(i); });
}

/** Sorts [begin, end), whose keys share their leading bits, by the whole key and the index. */
void
sortRun(Keys& keys, Indices& indices, std::size_t begin, std::size_t end)
{
  if (std::is_sorted(keys.begin() + begin, keys.begin() + end)) return;  // indices already ascend
  std::vector<std::pair<std::uint64_t, std::uint32_t>> run(end - begin);
  for (std::size_t i = begin; i < end; ++i) run[i - begin] = {keys[i], indices[i]};
  std::sort(run.begin(), run.end());
  for (std::size_t i = begin; i < end; ++i) {
    keys[i] = run[i - begin].first;
    indices[i] = run[i - begin].second;
  }
}

void
sortRuns(Keys& keys, Indices& indices, int low_bits, int threads)
{
  const std::size_t n = keys.size();
  const std::size_t slices = static_cast<std::size_t>(threads) * 8;
  // A run belongs to the slice it starts in.
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    const std::size_t slice_end = n * (s + 1) / slices;
    std::size_t i = n * s / slices;
    while (i > 0 && i < slice_end && keys[i] >> low_bits == keys[i - 1] >> low_bits) ++i;
    while (i < slice_end) {
      std::size_t end = i + 1;
      while (end < n && keys[end] >> low_bits == keys[i] >> low_bits) ++end;
      if (end - i > 1) sortRun(keys, indices, i, end);
      i = end;
    }
  });
}

}  // namespace

void
sortByKey(Keys& keys, Indices& order, int threads)
{
  const std::size_t n = keys.size();
  if (n < kFew) threads = 1;
  Keys leading = keys;
  const int low_bits = sortByLeadingBits(leading, order, threads);
  forAll(n, threads, [&](std::size_t i) { leading[i] = keys[order[i]]; });
  keys.swap(leading);
  sortRuns(keys, order, low_bits, threads);
}

}  // namespace pcl_slim
