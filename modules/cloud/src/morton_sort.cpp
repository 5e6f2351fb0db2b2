// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/morton_sort.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr int kDigitBits = 11;
constexpr std::size_t kBuckets = std::size_t{1} << kDigitBits;
constexpr int kKeyBits = 63;

using Keys = AlignedVector<std::uint64_t>;
using Indices = AlignedVector<std::uint32_t>;
using Histogram = std::array<std::size_t, kBuckets>;

std::size_t
digitOf(std::uint64_t key, int shift)
{
  return (key >> shift) & (kBuckets - 1);
}

/** One stable pass: slices count their digits, then scatter to offsets that keep their order. */
void
radixPass(const Keys& keys, const Indices& indices, Keys& keys_out, Indices& indices_out, int shift,
          int threads)
{
  const std::size_t n = keys.size();
  const auto slices = static_cast<std::size_t>(threads);
  std::vector<Histogram> offsets(slices);
  const auto sliceBegin = [&](std::size_t s) { return n * s / slices; };

  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    Histogram& count = offsets[s];
    count.fill(0);
    for (std::size_t i = sliceBegin(s); i < sliceBegin(s + 1); ++i)
      ++count[digitOf(keys[i], shift)];
  });
  std::size_t total = 0;
  for (std::size_t digit = 0; digit < kBuckets; ++digit) {
    for (std::size_t s = 0; s < slices; ++s) {
      const std::size_t count = offsets[s][digit];
      offsets[s][digit] = total;
      total += count;
    }
  }
  parallelFor(slices, threads, 1, [&](std::size_t s, int) {
    Histogram& next = offsets[s];
    for (std::size_t i = sliceBegin(s); i < sliceBegin(s + 1); ++i) {
      const std::size_t target = next[digitOf(keys[i], shift)]++;
      keys_out[target] = keys[i];
      indices_out[target] = indices[i];
    }
  });
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
sortByKey(Keys& keys, Indices& indices, int threads)
{
  const std::size_t n = keys.size();
  if (n < 2) return;
  const int used = n < (std::size_t{1} << 15) ? 1 : threads;
  // Enough leading bits that few points share them: three digits up to a few million points.
  const int passes = n < (std::size_t{1} << 22) ? 3 : 4;
  const int low_bits = kKeyBits - passes * kDigitBits;
  Keys keys_spare(n);
  Indices indices_spare(n);
  for (int pass = 0; pass < passes; ++pass) {
    radixPass(keys, indices, keys_spare, indices_spare, low_bits + pass * kDigitBits, used);
    keys.swap(keys_spare);
    indices.swap(indices_spare);
  }
  sortRuns(keys, indices, low_bits, used);
}

}  // namespace pcl_slim
