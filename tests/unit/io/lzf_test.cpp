// SPDX-License-Identifier: BSD-3-Clause
#include "io/pcd_file.h"

#include <gtest/gtest.h>
#include <pcl/io/lzf.h>

#include <random>
#include <vector>

namespace {

using pcl_slim::detail::decodeLzf;

/** What PCL writes of some bytes. */
std::vector<std::uint8_t> packed(const std::vector<std::uint8_t>& plain) {
  std::vector<std::uint8_t> made(2 * plain.size() + 16);
  made.resize(pcl::lzfCompress(plain.data(), static_cast<unsigned int>(plain.size()), made.data(),
                               static_cast<unsigned int>(made.size())));
  return made;
}

/** Bytes in runs of random lengths, of which some repeat. */
std::vector<std::uint8_t> someBytes(std::mt19937& random, std::size_t count) {
  std::vector<std::uint8_t> bytes;
  while (bytes.size() < count) {
    const std::size_t run = 1 + random() % 400;
    const bool repeats = random() % 2 == 0 && bytes.size() > 500;
    const std::size_t from = repeats ? random() % (bytes.size() - 400) : 0;
    for (std::size_t i = 0; i < run; ++i)
      bytes.push_back(repeats ? bytes[from + i] : static_cast<std::uint8_t>(random()));
  }
  bytes.resize(count);
  return bytes;
}

TEST(Lzf, DecodesWhatPclEncodes) {
  std::mt19937 random(5);
  for (const std::size_t count : {4u, 33u, 1000u, 20000u, 300000u}) {
    std::vector<std::uint8_t> plain = someBytes(random, count);
    if (count == 1000u) plain.assign(count, 7);  // matches that overlap what they write
    const std::vector<std::uint8_t> from = packed(plain);
    std::vector<std::uint8_t> made(count);
    ASSERT_TRUE(decodeLzf(from.data(), from.size(), made.data(), count)) << count;
    EXPECT_EQ(made, plain);
    EXPECT_FALSE(decodeLzf(from.data(), from.size() - 1, made.data(), count)) << "cut";
    EXPECT_FALSE(decodeLzf(from.data(), from.size(), made.data(), count - 1)) << "too long";
  }
}

TEST(Lzf, KeepsWithinItsBuffersOnAnyBytes) {
  std::mt19937 random(6);
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::uint8_t> from(random() % 60), made(random() % 300);
    for (std::uint8_t& byte : from) byte = static_cast<std::uint8_t>(random());
    decodeLzf(from.data(), from.size(), made.data(), made.size());
  }
}

}  // namespace
