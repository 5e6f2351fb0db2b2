// SPDX-License-Identifier: BSD-3-Clause
#include "place_order.h"

#include <algorithm>

#include "pcl_slim/cloud/morton.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

AlignedVector<std::uint32_t> mortonOrder(const Vector3* places, std::size_t count, int threads,
                                         std::size_t& finite) {
  threads = resolveThreads(threads);
  constexpr std::size_t kChunk = 65536;
  constexpr std::uint64_t kLast = (std::uint64_t{1} << 63) - 1;
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  std::vector<Bounds> boxes(chunks);
  std::vector<std::size_t> counts(chunks, 0);
  parallelFor(chunks, threads, 1, [&](std::size_t c, int) {
    for (std::size_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i) {
      if (!isFinite(places[i])) continue;
      boxes[c].add(places[i]);
      ++counts[c];
    }
  });
  Bounds box;
  finite = 0;
  for (std::size_t c = 0; c < chunks; ++c) {
    finite += counts[c];
    if (counts[c] == 0) continue;
    box.add(boxes[c].low);
    box.add(boxes[c].high);
  }
  double width = 0;
  for (std::size_t a = 0; a < 3; ++a) width = std::max(width, box.high[a] - box.low[a]);
  const double scale = width > 0 && width < Bounds::kInfinity ? 1 / width : 0;
  AlignedVector<std::uint64_t> keys(count);
  parallelFor(count, threads, kChunk, [&](std::size_t i, int) {
    const Vector3& p = places[i];
    keys[i] = !isFinite(p) ? kLast
                           : std::min(kLast - 1, mortonCode((p[0] - box.low[0]) * scale - 0.5,
                                                            (p[1] - box.low[1]) * scale - 0.5,
                                                            (p[2] - box.low[2]) * scale - 0.5));
  });
  AlignedVector<std::uint32_t> order;
  sortByKey(keys, order, threads);
  return order;
}

std::vector<std::uint32_t> evenChoice(const Vector3* places, std::size_t count, std::size_t most,
                                      int threads) {
  std::size_t finite = 0;
  const auto order = mortonOrder(places, count, threads, finite);
  std::vector<std::uint32_t> chosen(std::min(finite, most));
  // In double: products of two counts may be too large for 64 bits of an integer.
  const double step =
      static_cast<double>(finite) / static_cast<double>(std::max<std::size_t>(chosen.size(), 1));
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    chosen[k] =
        order[std::min(static_cast<std::size_t>(static_cast<double>(k) * step), finite - 1)];
  }
  return chosen;
}

}  // namespace pcl_slim::detail
