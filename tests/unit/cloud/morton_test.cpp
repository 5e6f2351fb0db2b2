// SPDX-License-Identifier: BSD-3-Clause
// Morton codes: bit by bit, and those of a batch.
#include "pcl_slim/cloud/morton.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim {

using namespace detail;

namespace {

std::uint64_t bitByBit(const std::uint64_t (&cells)[3]) {
  std::uint64_t code = 0;
  for (int bit = kMortonBits - 1; bit >= 0; --bit) {
    for (const std::uint64_t cell : cells) code = code << 1 | (cell >> bit & 1u);
  }
  return code;
}

TEST(Morton, InterleavesBits) {
  std::mt19937_64 random(3);
  for (int k = 0; k < 1000; ++k) {
    std::uint64_t cells[3];
    double local[3];
    for (int a = 0; a < 3; ++a) {
      cells[a] = random() >> (64 - kMortonBits);
      local[a] = std::ldexp(static_cast<double>(cells[a]) + 0.5, -kMortonBits) - 0.5;
    }
    EXPECT_EQ(mortonCode(local[0], local[1], local[2]), bitByBit(cells));
  }
}

/** On the rims of cells, at the box's faces and beyond them too. */
TEST(Morton, BatchesAgreeWithSinglePoints) {
  const double origin[3] = {3.0, -7.0, 0.125}, inverse_scale = 0.25;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  const double special[] = {-0.5, 0.5, 0.0, -0.51, 2.0, 0x1p-21, -0x1p-21, 0.5 - 0x1p-54};
  for (int k = 0; k < 50; ++k) {
    alignas(64) double batch[3][kernels::kMortonBatch];
    alignas(64) std::uint64_t codes[kernels::kMortonBatch];
    for (std::size_t i = 0; i < kernels::kMortonBatch; ++i) {
      for (int a = 0; a < 3; ++a) {
        const double local = random() % 3 == 0 ? special[random() % 8] : unit(random);
        batch[a][i] = local / inverse_scale + origin[a];
      }
    }
    kernels::mortonCodes(batch, origin, inverse_scale, codes);
    for (std::size_t i = 0; i < kernels::kMortonBatch; ++i) {
      double local[3];
      for (int a = 0; a < 3; ++a) local[a] = (batch[a][i] - origin[a]) * inverse_scale;
      EXPECT_EQ(codes[i], mortonCode(local[0], local[1], local[2])) << i;
    }
  }
}

}  // namespace
}  // namespace pcl_slim
