// SPDX-License-Identifier: BSD-3-Clause
#include "sides/side_cells.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sides/cell_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, 8>;
using Wide = hn::Vec<Doubles>;

HWY_INLINE double sumOf(Wide v) {
  return GetLane(SumOfLanes(Doubles(), v));
}

/** Mask of a group's lanes whose bits are set. \param[in] first bit of the group */
HWY_INLINE hn::Mask<Doubles> maskOf(std::uint64_t cells, std::size_t first) {
  const std::uint8_t bits[8] = {static_cast<std::uint8_t>(cells >> first)};
  return hn::LoadMaskBits(Doubles(), bits);
}

CellSums sumCells(const NearCells& near, std::uint64_t chosen) {
  const Doubles d;
  Wide sums[10];
  for (auto& sum : sums) sum = Zero(d);
  for (std::size_t k = 0; chosen >> k != 0; k += hn::Lanes(d)) {
    const auto count = IfThenElseZero(maskOf(chosen, k), Load(d, near.columns[0].data() + k));
    sums[0] += count;
    Wide offset[3];
    for (std::size_t a = 0; a < 3; ++a) {
      offset[a] = Load(d, near.columns[1 + a].data() + k);
      sums[1 + a] = MulAdd(count, offset[a], sums[1 + a]);
    }
    for (std::size_t a = 0, c = 4; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b, ++c) {
        const auto product = MulAdd(offset[a], offset[b], Load(d, near.columns[c].data() + k));
        sums[c] = MulAdd(count, product, sums[c]);
      }
    }
  }
  CellSums result;
  for (std::size_t c = 0; c < result.size(); ++c) result[c] = sumOf(sums[c]);
  return result;
}

TwoSheets separateCells(const NearCells& near, std::size_t count,
                        const std::array<double, 3>& normal, double mean, int passes) {
  const Doubles d;
  const auto x = Set(d, normal[0]), y = Set(d, normal[1]), z = Set(d, normal[2]);
  const auto& columns = near.columns;
  const auto at = [&](std::size_t c, std::size_t k)
                      HWY_ATTR { return Load(d, columns[c].data() + k); };
  HWY_ALIGN std::array<double, NearCells::kCapacity> heights;
  Wide squares = Zero(d), points = Zero(d);
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const auto height =
        MulAdd(x, at(1, k), MulAdd(y, at(2, k), MulAdd(z, at(3, k), Set(d, -mean))));
    const auto along_x = MulAdd(x, at(4, k), (y + y) * at(5, k)) + (z + z) * at(6, k);
    const auto along_y = MulAdd(y, at(7, k), (z + z) * at(8, k));
    const auto variance = MulAdd(x, along_x, MulAdd(y, along_y, z * z * at(9, k)));
    // Columns are 0 beyond the last cell, but the first `count` cells may end before it.
    const auto number = IfThenElseZero(FirstN(d, HWY_MIN(hn::Lanes(d), count - k)), at(0, k));
    points += number;
    squares = MulAdd(number, MulAdd(height, height, variance), squares);
    Store(height, d, heights.data() + k);
  }
  TwoSheets two;
  two.square = sumOf(squares);
  const double total = sumOf(points);
  double middle = 0;
  for (int pass = 0; pass < passes; ++pass) {
    Wide numbers = Zero(d), sums = Zero(d);
    const std::uint64_t before = two.higher;
    two.higher = 0;
    for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
      const auto height = Load(d, heights.data() + k);
      const auto over = And(height > Set(d, middle), FirstN(d, HWY_MIN(hn::Lanes(d), count - k)));
      const auto number = IfThenElseZero(over, at(0, k));
      numbers += number;
      sums = MulAdd(number, height, sums);
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, over, bits);
      two.higher |= static_cast<std::uint64_t>(bits[0]) << k;
    }
    if (pass > 0 && two.higher == before) break;  // the means are those of the pass before
    two.above = sumOf(numbers);
    const double below = total - two.above, sum = sumOf(sums);
    two.gap = 0;
    if (!(two.above > 0 && below > 0)) return two;
    two.gap = sum / two.above + sum / below;
    middle = 0.5 * (sum / two.above - sum / below);
  }
  return two;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(sumCells);
CellSums sumCells(const NearCells& near, std::uint64_t chosen) {
  return HWY_DYNAMIC_DISPATCH(sumCells)(near, chosen);
}

HWY_EXPORT(separateCells);
TwoSheets separateCells(const NearCells& near, std::size_t count,
                        const std::array<double, 3>& normal, double mean, int passes) {
  return HWY_DYNAMIC_DISPATCH(separateCells)(near, count, normal, mean, passes);
}

}  // namespace pcl_slim::detail::kernels
#endif
