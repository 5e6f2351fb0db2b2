// SPDX-License-Identifier: BSD-3-Clause
// Highway's vqsort is no faster: with the leading bits and the places in 64 bits it took 1.29 to
// 2.15 times the radix sort's CPU time, with key and place in 128 bits 1.18 to 1.32 times (1M and
// 10M codes of a surface, 1 and 2 threads, AVX2, busy machine).
#include "pcl_slim/cloud/morton_sort.h"

#include <algorithm>
#include <array>
#include <vector>

#include "pcl_slim/core/parallel.h"

namespace pcl_slim {

namespace {

constexpr int kFirstBits = 14;        ///< of the pass over all
constexpr int kFirstBitsOfFew = 11;   ///< of fewer than 2^18
constexpr int kFirstBitsOfMany = 12;  ///< more bits: too many output streams for the TLB
constexpr std::size_t kMany = std::size_t{1} << 22;
constexpr int kDigitBits = 9;       ///< of passes inside buckets
constexpr int kDigitBitsOfFew = 7;  ///< inside those too small for more digits to pay
constexpr std::size_t kSmall = 2048;
constexpr std::size_t kFew = 32;    ///< numbers for which counting digits does not pay
constexpr std::size_t kMoves = 16;  ///< of insertion, per number, that other sorting beats

/** Sorts by bits from low on, stably; quick where numbers are few or nearly in order. */
void sortNearly(std::uint64_t* values, std::size_t n, int low) {
  const std::size_t most = kMoves * std::max(n, kFew);
  std::size_t moves = 0;
  for (std::size_t i = 1; i < n; ++i) {
    const std::uint64_t value = values[i], bits = value >> low;
    if (values[i - 1] >> low <= bits) continue;
    std::size_t at = i;
    do {
      values[at] = values[at - 1];
      --at;
    } while (at > 0 && values[at - 1] >> low > bits);
    values[at] = value;
    moves += i - at;
    if (moves <= most) continue;
    std::stable_sort(values, values + n,
                     [low](std::uint64_t a, std::uint64_t b) { return a >> low < b >> low; });
    return;
  }
}

/** Counts of one digit's values, then the places where the next of each goes. */
class DigitCounts {
 public:
  DigitCounts(std::uint32_t* counts, int shift, int bits)
      : counts_(counts), shift_(shift), mask_((std::uint64_t{1} << bits) - 1) {}

  void count(const std::uint64_t* values, std::size_t n) const {
    std::uint32_t* const counts = counts_;
    const int shift = shift_;
    const std::uint64_t mask = mask_;
    for (std::size_t i = 0; i < n; ++i) ++counts[values[i] >> shift & mask];
  }

  /** number(i): what goes where values[i] belongs. */
  template <typename Number>
  void scatter(const std::uint64_t* values, std::size_t n, std::uint64_t* out,
               const Number& number) const {
    std::uint32_t* const next = counts_;
    const int shift = shift_;
    const std::uint64_t mask = mask_;
    for (std::size_t i = 0; i < n; ++i) out[next[values[i] >> shift & mask]++] = number(i);
  }

 private:
  std::uint32_t* counts_;
  int shift_;
  std::uint64_t mask_;
};

/** One stable pass from values to out. */
void digitPass(const std::uint64_t* values, std::uint64_t* out, std::size_t n, int shift,
               int bits) {
  std::array<std::uint32_t, std::size_t{1} << kDigitBits> next;
  const std::size_t digits = std::size_t{1} << bits;
  std::fill_n(next.begin(), digits, 0);
  DigitCounts counts(next.data(), shift, bits);
  counts.count(values, n);
  std::uint32_t total = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    const std::uint32_t count = next[d];
    next[d] = total;
    total += count;
  }
  counts.scatter(values, n, out, [values](std::size_t i) { return values[i]; });
}

/** Leading bits after which few of n numbers agree, for points of a surface: every three bits leave
 * a quarter of them. */
int tellingBits(std::size_t n) {
  int bits = 0;
  for (; n > 4; n /= 4) bits += 3;
  return bits;
}

/** Sorts one bucket, stored in spare, into values; bits from high on are equal. */
void sortBucket(std::uint64_t* values, std::uint64_t* spare, std::size_t n, int low, int high) {
  std::uint64_t *from = spare, *to = values;
  int rest = high - low;  // bits that are not in order yet
  if (n > kFew && high > low) {
    const int digit = n < kSmall ? kDigitBitsOfFew : kDigitBits;
    const int passes = std::max(1, (tellingBits(n) + digit / 2) / digit);
    rest = std::max(0, high - passes * digit - low);
    for (int shift = low + rest; shift < high; shift += digit) {
      digitPass(from, to, n, shift, std::min(digit, high - shift));
      std::swap(from, to);
    }
  }
  if (from != values) std::copy_n(from, n, values);
  if (rest > 0) sortNearly(values, n, low);
}

/** Scatters numbers by the leading digit of values: number(i) for values[i]. \return where each
 * bucket begins. */
template <typename Number>
std::vector<std::size_t> scatter(const AlignedVector<std::uint64_t>& values, const Number& number,
                                 AlignedVector<std::uint64_t>& out, int shift, int bits,
                                 int threads) {
  const std::size_t n = values.size(), digits = std::size_t{1} << bits;
  const std::size_t slices = n < kMany / 64 ? 1 : static_cast<std::size_t>(threads);
  std::vector<std::uint32_t> next(slices * digits, 0);
  std::vector<std::size_t> begins(digits + 1, n);
  const auto forSlice = [&](const auto& body) {
    parallelFor(slices, threads, 1, [&](std::size_t s, int) {
      const DigitCounts counts(next.data() + s * digits, shift, bits);
      body(counts, n * s / slices, n * (s + 1) / slices);
    });
  };
  forSlice([&](const DigitCounts& counts, std::size_t begin, std::size_t end) {
    counts.count(values.data() + begin, end - begin);
  });
  std::uint32_t total = 0;
  for (std::size_t d = 0; d < digits; ++d) {
    begins[d] = total;
    for (std::size_t s = 0; s < slices; ++s) {
      const std::uint32_t count = next[s * digits + d];
      next[s * digits + d] = total;
      total += count;
    }
  }
  forSlice([&](const DigitCounts& counts, std::size_t begin, std::size_t end) {
    counts.scatter(values.data() + begin, end - begin, out.data(),
                   [&](std::size_t i) { return number(begin + i); });
  });
  return begins;
}

/** Bits of the pass over all of n numbers. */
int firstBits(std::size_t n) {
  return n < kMany / 16 ? kFirstBitsOfFew : n < kMany ? kFirstBits : kFirstBitsOfMany;
}

}  // namespace

void sortByBits(AlignedVector<std::uint64_t>& values, int low, int high, int threads) {
  const std::size_t n = values.size();
  if (high <= low) return;
  if (n <= kFew) return sortNearly(values.data(), n, low);
  const int bits = std::min(firstBits(n), high - low);
  const int shift = high - bits;
  AlignedVector<std::uint64_t> spare(n);
  const auto begins = scatter(
      values, [&](std::size_t i) { return values[i]; }, spare, shift, bits, threads);
  parallelFor(begins.size() - 1, threads, 64, [&](std::size_t d, int) {
    const std::size_t begin = begins[d], count = begins[d + 1] - begin;
    if (count > 0) sortBucket(values.data() + begin, spare.data() + begin, count, low, shift);
  });
}

int sortByLeadingBits(AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& order,
                      int threads) {
  constexpr int kKeyBits = 63;
  const std::size_t n = keys.size();
  int place_bits = 1;
  while (n >> place_bits != 0) ++place_bits;
  const int bits = firstBits(n), shift = kKeyBits - bits;
  const int cut = std::max(0, shift + place_bits - 64);
  // The bucket implies the leading bits: numbers store those below, as many as fit next to the
  // place.
  const std::uint64_t below = (std::uint64_t{1} << shift) - 1;
  AlignedVector<std::uint64_t> numbers(n);
  const auto begins = scatter(
      keys, [&](std::size_t i) { return (keys[i] & below) >> cut << place_bits | i; }, numbers,
      shift, bits, threads);
  order.resize(n);
  const std::uint64_t place = (std::uint64_t{1} << place_bits) - 1;
  parallelFor(begins.size() - 1, threads, 64, [&](std::size_t d, int) {
    const std::size_t begin = begins[d], end = begins[d + 1];
    if (begin == end) return;
    sortBucket(keys.data() + begin, numbers.data() + begin, end - begin, place_bits,
               place_bits + shift - cut);
    const std::uint64_t leading = std::uint64_t{d} << shift;
    for (std::size_t i = begin; i < end; ++i) {
      order[i] = static_cast<std::uint32_t>(keys[i] & place);
      keys[i] = leading | keys[i] >> place_bits << cut;
    }
  });
  return cut;
}

namespace {

constexpr std::size_t kSlice = 1 << 14;    ///< keys a thread takes at a time
constexpr std::size_t kFewKeys = 1 << 15;  ///< that one thread sorts

using Keys = AlignedVector<std::uint64_t>;
using Indices = AlignedVector<std::uint32_t>;

template <typename Body>
void forAll(std::size_t n, int threads, const Body& body) {
  parallelFor(n, threads, kSlice, [&](std::size_t i, int) { body(i); });
}

/** Sorts [begin, end), whose keys share their leading bits, by the whole key and the index. */
void sortRun(Keys& keys, Indices& indices, std::size_t begin, std::size_t end) {
  if (std::is_sorted(keys.begin() + begin, keys.begin() + end)) return;  // indices already ascend
  std::vector<std::pair<std::uint64_t, std::uint32_t>> run(end - begin);
  for (std::size_t i = begin; i < end; ++i) run[i - begin] = {keys[i], indices[i]};
  std::sort(run.begin(), run.end());
  for (std::size_t i = begin; i < end; ++i) {
    keys[i] = run[i - begin].first;
    indices[i] = run[i - begin].second;
  }
}

void sortRuns(Keys& keys, Indices& indices, int low_bits, int threads) {
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

void sortByKey(Keys& keys, Indices& order, int threads) {
  const std::size_t n = keys.size();
  if (n < kFewKeys) threads = 1;
  Keys leading = keys;
  const int low_bits = sortByLeadingBits(leading, order, threads);
  forAll(n, threads, [&](std::size_t i) { leading[i] = keys[order[i]]; });
  keys.swap(leading);
  sortRuns(keys, order, low_bits, threads);
}

}  // namespace pcl_slim
