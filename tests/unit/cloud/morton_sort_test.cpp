// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/morton_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pcl_slim {
namespace {

using Values = AlignedVector<std::uint64_t>;

/** Numbers of so many bits, drawn so that their leading bits are shared by many or by few. */
Values
numbers(std::size_t count, int bits, int shared_bits)
{
  std::mt19937_64 random(count + static_cast<std::size_t>(bits));
  Values values(count);
  for (auto& v : values) v = random() >> (64 - bits) >> (random() % 3 == 0 ? 0 : shared_bits);
  return values;
}

/** Sorts by a comparison of bits from low on, and by sortByBits. */
void
expectSorted(const Values& values, int low, int high)
{
  Values expected = values;
  std::stable_sort(expected.begin(), expected.end(),
                   [low](std::uint64_t a, std::uint64_t b) { return a >> low < b >> low; });
  for (const int threads : {1, 2, 7}) {
    Values sorted = values;
    sortByBits(sorted, low, high, threads);
    EXPECT_EQ(sorted, expected) << values.size() << " numbers, bits " << low << " to " << high;
  }
}

TEST(SortByBits, AgreesWithAStableSort)
{
  for (const std::size_t count : {0u, 1u, 2u, 40u, 1000u, 30000u, 200000u}) {
    for (const int bits : {1, 9, 33, 64}) {
      for (const int low : {0, 7, 20}) {
        if (low < bits) expectSorted(numbers(count, bits, bits / 3), low, bits);
      }
    }
  }
}

TEST(SortByBits, EqualAndOrderedNumbersStay)
{
  expectSorted(Values(50000, 77), 0, 40);
  Values rising(50000);
  for (std::size_t i = 0; i < rising.size(); ++i) rising[i] = i << 13;
  expectSorted(rising, 3, 40);
  std::reverse(rising.begin(), rising.end());
  expectSorted(rising, 3, 40);
}

TEST(SortByBits, AllInOneBucketIsNoWorse)
{
  // Leading bits equal, as where one far point stretches a grid.
  Values values = numbers(100000, 12, 0);
  values[500] |= std::uint64_t{1} << 43;
  expectSorted(values, 0, 44);
}

TEST(SortByKey, BreaksTiesByIndex)
{
  std::mt19937_64 random(3);
  AlignedVector<std::uint64_t> keys(100000);
  AlignedVector<std::uint32_t> indices(keys.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    keys[i] = (random() >> 1) / (random() % 2 ? 1 : std::uint64_t{1} << 55);
    indices[i] = i;
  }
  const auto original = keys;
  sortByKey(keys, indices, 2);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    ASSERT_EQ(keys[i], original[indices[i]]);
    if (i > 0) {
      ASSERT_TRUE(keys[i - 1] < keys[i] || (keys[i - 1] == keys[i] && indices[i - 1] < indices[i]));
    }
  }
}

}  // namespace
}  // namespace pcl_slim
