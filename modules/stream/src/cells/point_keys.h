// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

/** \brief Morton codes of the points of pieces, as a PointStore in the same frame computes them. */
class PointKeys {
 public:
  static constexpr std::uint64_t kLeftOut = ~std::uint64_t{0};

  PointKeys(const StoreFrame& frame, int threads) : frame_(frame), threads_(threads) {}

  /** \brief Computes the codes of a piece: one a point in order, kLeftOut for points that no store
   * takes. O(points). */
  const AlignedVector<std::uint64_t>& of(const CloudView& piece);

 private:
  void slice(const CloudView& piece, std::size_t begin, std::size_t end);

  const StoreFrame& frame_;
  int threads_;
  AlignedVector<std::uint64_t> keys_;
};

/** \brief Depth of the cells of the finest grid: Morton codes have three bits a level. */
constexpr int kDeepestCell = 21;

/** \brief Code of the cell of a depth that holds a point. */
inline std::uint64_t
cellOf(std::uint64_t key, int depth)
{
  return key >> (3 * (kDeepestCell - depth));
}

/** \brief Hash of a position, the same for equal ones: thins a cloud whatever its order. */
std::uint64_t
placeHash(const std::array<double, 3>& p);

}  // namespace pcl_slim::detail
