// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/morton_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace pcl_slim {
namespace {

using Values = AlignedVector<std::uint64_t>;

/** Numbers of so many bits, drawn so that their leading bits are shared by many or by few. */
Values numbers(std::size_t count, int bits, int shared_bits) {
  std::mt19937_64 random(count + static_cast<std::size_t>(bits));
  Values values(count);
  for (auto& v : values) v = random() >> (64 - bits) >> (random() % 3 == 0 ? 0 : shared_bits);
  return values;
}

/** Sorts by a comparison of bits from low on, and by sortByBits. */
void expectSorted(const Values& values, int low, int high) {
  Values expected = values;
  std::stable_sort(expected.begin(), expected.end(),
                   [low](std::uint64_t a, std::uint64_t b) { return a >> low < b >> low; });
  for (const int threads : {1, 2, 7}) {
    Values sorted = values;
    sortByBits(sorted, low, high, threads);
    EXPECT_EQ(sorted, expected) << values.size() << " numbers, bits " << low << " to " << high;
  }
}

TEST(SortByBits, AgreesWithAStableSort) {
  for (const std::size_t count : {0u, 1u, 2u, 40u, 1000u, 30000u, 200000u}) {
    for (const int bits : {1, 9, 33, 64}) {
      for (const int low : {0, 7, 20}) {
        if (low < bits) expectSorted(numbers(count, bits, bits / 3), low, bits);
      }
    }
  }
}

/** Keys that share leading bits with few, with many, and wholly. */
TEST(SortByKey, AgreesWithAStableSort) {
  for (const std::size_t count : {0u, 1u, 2u, 100u, 5000u, 150000u}) {
    for (const int shared_bits : {0, 20, 45, 60}) {
      Values keys = numbers(count, 63, shared_bits);
      for (std::size_t i = 0; i < count; i += 3) keys[i] = keys[count - 1 - i];
      AlignedVector<std::uint32_t> expected(count);
      std::iota(expected.begin(), expected.end(), 0u);
      std::stable_sort(expected.begin(), expected.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
      for (const int threads : {1, 2, 7}) {
        Values sorted = keys;
        AlignedVector<std::uint32_t> order;
        sortByKey(sorted, order, threads);
        ASSERT_EQ(order, expected) << count << " keys";
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(sorted[i], keys[order[i]]);
      }
    }
  }
}

TEST(SortByLeadingBits, AgreesWithAStableSortOfThoseBits) {
  for (const std::size_t count : {0u, 1u, 2u, 100u, 5000u, 20000u, 300000u}) {
    for (const int shared_bits : {0, 20, 45, 60}) {
      const Values keys = numbers(count, 63, shared_bits);
      for (const int threads : {1, 2, 7}) {
        Values sorted = keys;
        AlignedVector<std::uint32_t> order, expected(count);
        const int cut = sortByLeadingBits(sorted, order, threads);
        std::iota(expected.begin(), expected.end(), 0u);
        std::stable_sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
          return keys[a] >> cut < keys[b] >> cut;
        });
        EXPECT_LE(cut, 8) << count << " keys";
        ASSERT_EQ(order, expected) << count << " keys";
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(sorted[i], keys[order[i]] >> cut << cut);
      }
    }
  }
}

TEST(SortByBits, EqualAndOrderedNumbersStay) {
  expectSorted(Values(50000, 77), 0, 40);
  Values rising(50000);
  for (std::size_t i = 0; i < rising.size(); ++i) rising[i] = i << 13;
  expectSorted(rising, 3, 40);
  std::reverse(rising.begin(), rising.end());
  expectSorted(rising, 3, 40);
}

TEST(SortByBits, AllInOneBucketIsNoWorse) {
  // Leading bits equal, as where one far point stretches a grid.
  Values values = numbers(100000, 12, 0);
  values[500] |= std::uint64_t{1} << 43;
  expectSorted(values, 0, 44);
}

}  // namespace
}  // namespace pcl_slim
