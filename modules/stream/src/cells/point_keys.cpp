// SPDX-License-Identifier: BSD-3-Clause
#include "cells/point_keys.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"
#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

namespace {

constexpr std::size_t kSlice = 1 << 14;  ///< points a thread takes at a time
constexpr std::size_t kBatch = kernels::kMortonBatch;

}  // namespace

const AlignedVector<std::uint64_t>&
PointKeys::of(const CloudView& piece)
{
  const std::size_t n = piece.count();
  keys_.resize(n + kBatch);
  parallelFor((n + kSlice - 1) / kSlice, threads_, 1,
              [&](std::size_t s, int) { slice(piece, s * kSlice, std::min(n, (s + 1) * kSlice)); });
  return keys_;
}

void
PointKeys::slice(const CloudView& piece, std::size_t begin, std::size_t end)
{
  const CloudReader reader(piece);
  const bool normals = frame_.with_normals;
  const auto& center = frame_.bulk_center;
  // Neither NaN nor infinity is within a finite reach.
  const double reach = std::min(frame_.bulk_reach, std::numeric_limits<double>::max());
  alignas(64) double batch[3][kBatch] = {};
  alignas(64) std::uint64_t codes[kBatch];
  for (std::size_t first = begin; first < end; first += kBatch) {
    const std::size_t count = std::min(kBatch, end - first);
    bool wanted[kBatch];
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t input = piece.inputIndex(first + i);
      const auto p = reader.position(input);
      const double farthest = std::max(
          {std::abs(p[0] - center[0]), std::abs(p[1] - center[1]), std::abs(p[2] - center[2])});
      const bool near = farthest <= reach && !std::isnan(p[0] + p[1] + p[2]);
      wanted[i] = near && (!normals || reader.hasNormal(input));
      for (std::size_t a = 0; a < 3; ++a) batch[a][i] = wanted[i] ? p[a] : frame_.origin[a];
    }
    kernels::mortonCodes(batch, frame_.origin.data(), 1.0 / frame_.scale, codes);
    for (std::size_t i = 0; i < count; ++i) keys_[first + i] = wanted[i] ? codes[i] : kLeftOut;
  }
}

std::uint64_t
placeHash(const std::array<double, 3>& p)
{
  std::uint64_t hash = 0x2545f4914f6cdd1du;
  for (const double coordinate : p) {
    const double value = coordinate + 0.0;  // -0 is 0
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  hash *= 0xbf58476d1ce4e5b9u;
  return hash ^ hash >> 32;
}

}  // namespace pcl_slim::detail
