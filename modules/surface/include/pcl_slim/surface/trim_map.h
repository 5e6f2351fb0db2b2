// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/weight_kernel.h"

namespace pcl_slim {

/** \brief Where an open surfel's ball contains data: side x side bits, 1 inside, at nodes
 * over the square [-1, 1]^2 of the surfel's (u, v) plane in units of its radius.
 *
 * Nodes are stored row by row from v = -1 up, each row from u = -1 up, eight to a byte, lowest bit
 * first. A map refers to memory of its surface. Surfels without a map are closed: their data reach
 * everywhere.
 */
struct TrimMap {
  static constexpr int kLeastSide = 5, kMostSide = 128;

  int side = 0;  ///< 0: closed
  const std::uint8_t* bits = nullptr;

  bool closed() const { return side == 0; }
  bool at(int column, int row) const {
    const int k = row * side + column;
    return (bits[k >> 3] >> (k & 7) & 1) != 0;
  }
  /** \brief Bytes that the bits of a map take. */
  static constexpr std::size_t numBytes(int side) {
    return (static_cast<std::size_t>(side) * static_cast<std::size_t>(side) + 7) / 8;
  }
};

/** \brief How far outside of its data a surfel is at (u, v) in its unit disc: 0 where every node
 * about is inside, 1 where none is, and 1/2 on the border.
 *
 * The bits are blended by quadratic B-splines over 3 x 3 nodes. With blending weights w the
 * surface ends where sum w outside = 1/2 sum w. O(1).
 */
PCL_SLIM_EXPORT double outsideShare(const TrimMap& map, double u, double v);

/** \brief How many points a surfel's ball has beside a ball without holes, of points as dense: the
 * ratio of their effective numbers, (sum w)^2 / sum w^2 for weights w. 1 where the map is closed, or
 * has nothing inside. O(nodes). */
PCL_SLIM_EXPORT double filledShare(const TrimMap& map, WeightKernel kernel);

}  // namespace pcl_slim
