// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <vector>

#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr int kFirstBits = 12;        ///< of the pass over all
constexpr int kFirstBitsOfMany = 10;  ///< of so many that more streams would miss the TLB
constexpr std::size_t kMany = std::size_t{1} << 22;
constexpr int kDigitBits = 9;       ///< of passes inside buckets
constexpr int kDigitBitsOfFew = 7;  ///< inside those too small for more digits to pay
constexpr std::size_t kSmall = 2048;
constexpr std::size_t kFew = 48;  ///< numbers for which counting digits does not pay

std::size_t
digitOf(std::uint64_t value, int shift, int bits)
{
  return static_cast<std::size_t>(value >> shift & ((std::uint64_t{1} << bits) - 1));
}

/** Sorts by bits from low on, stably; for few numbers or such as are nearly in order. */
void
insertionSort(std::uint64_t* values, std::size_t n, int low)
{
  for (std::size_t i = 1; i < n; ++i) {
    const std::uint64_t value = values[i];
    std::size_t at = i;
    for (; at > 0 && values[at - 1] >> low > value >> low; --at) values[at] = values[at - 1];
    values[at] = value;
  }
}

/** Sorts what is in order down to bit sorted by bits from low on as well. */
void
sortFiner(std::uint64_t* values, std::size_t n, int low, int sorted)
{
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = begin + 1;
    while (end < n && values[end] >> sorted == values[begin] >> sorted) ++end;
    if (end - begin <= kFew) {
      insertionSort(values + begin, end - begin, low);
    } else {
      std::stable_sort(values + begin, values + end,
                       [low](std::uint64_t a, std::uint64_t b) { return a >> low < b >> low; });
    }
    begin = end;
  }
}

/** One stable pass from values to out. */
void
digitPass(const std::uint64_t* values, std::uint64_t* out, std::size_t n, int shift, int bits)
{
  std::array<std::uint32_t, std::size_t{1} << kDigitBits> next;
  const std::size_t digits = std::size_t{1} << bits;
  std::fill_n(next.begin(), digits, 0);
  for (std::size_t i = 0; i < n; ++i) ++next[digitOf(values[i], shift, bits)];
  std::uint32_t total = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    const std::uint32_t count = next[d];
    next[d] = total;
    total += count;
  }
  for (std::size_t i = 0; i < n; ++i) out[next[digitOf(values[i], shift, bits)]++] = values[i];
}

/** Leading bits after which few of n numbers agree, if they lie on a surface: every three leave a
 * quarter of them. */
int
tellingBits(std::size_t n)
{
  int bits = 0;
  for (; n > 1; n /= 4) bits += 3;
  return bits;
}

/** Sorts one bucket, which lies in spare, into values; bits from high on are equal. */
void
sortBucket(std::uint64_t* values, std::uint64_t* spare, std::size_t n, int low, int high)
{
  std::uint64_t *from = spare, *to = values;
  if (n <= kFew) {
    insertionSort(from, n, low);
  } else {
    const int digit = n < kSmall ? kDigitBitsOfFew : kDigitBits;
    const int passes = std::max(1, (tellingBits(n) + digit / 2) / digit);
    const int sorted = std::max(low, high - passes * digit);
    for (int shift = sorted; shift < high; shift += digit) {
      digitPass(from, to, n, shift, std::min(digit, high - shift));
      std::swap(from, to);
    }
    if (sorted > low) sortFiner(from, n, low, sorted);
  }
  if (from != values) std::copy_n(from, n, values);
}

/** Scatters values into spare by their leading digit. \return where each bucket begins. */
std::vector<std::size_t>
scatter(const AlignedVector<std::uint64_t>& values, AlignedVector<std::uint64_t>& spare, int shift,
        int bits, int threads)
{
  const std::size_t n = values.size(), digits = std::size_t{1} << bits;
  const std::size_t slices = n < kMany / 64 ? 1 : static_cast<std::size_t>(threads);
  std::vector<std::uint32_t> next(slices * digits, 0);
  std::vector<std::size_t> begins(digits + 1, n);
  const auto forSlice = [&](const auto& body) {
    parallelFor(slices, threads, 1, [&](std::size_t s, int) {
      std::uint32_t* own = next.data() + s * digits;
      for (std::size_t i = n * s / slices; i < n * (s + 1) / slices; ++i) {
        body(own[digitOf(values[i], shift, bits)], values[i]);
      }
    });
  };
  forSlice([](std::uint32_t& count, std::uint64_t) { ++count; });
  std::uint32_t total = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    begins[d] = total;
    for (std::size_t s = 0; s < slices; ++s) {
      const std::uint32_t count = next[s * digits + d];
      next[s * digits + d] = total;
      total += count;
    }
  }
  forSlice([&](std::uint32_t& place, std::uint64_t value) { spare[place++] = value; });
  return begins;
}

}  // namespace

void
sortByBits(AlignedVector<std::uint64_t>& values, int low, int high, int threads)
{
  const std::size_t n = values.size();
  if (n < 2 || high <= low) return;
  if (n <= kFew) return insertionSort(values.data(), n, low);
  const int bits = std::min(n < kMany ? kFirstBits : kFirstBitsOfMany, high - low),
            shift = high - bits;
  AlignedVector<std::uint64_t> spare(n);
  const auto begins = scatter(values, spare, shift, bits, threads);
  parallelFor(begins.size() - 1, threads, 64, [&](std::size_t d, int) {
    const std::size_t begin = begins[d], count = begins[d + 1] - begin;
    if (count > 0) sortBucket(values.data() + begin, spare.data() + begin, count, low, shift);
  });
}

}  // namespace pcl_slim
