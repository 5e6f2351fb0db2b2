// SPDX-License-Identifier: BSD-3-Clause
// outsideShare() of many places in one open surfel's disc in parallel. Highway compiles a kernel
// file once per instruction set, so the guard toggles.
#if defined(PCL_SLIM_TRIM_OUTSIDE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_TRIM_OUTSIDE_INL
#undef PCL_SLIM_TRIM_OUTSIDE_INL
#else
#define PCL_SLIM_TRIM_OUTSIDE_INL
#endif

#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "pcl_slim/surface/detail/trim_tables.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

template <class D>
using TrimIntsOf = hn::Vec<hn::RebindToSigned<D>>;

/** The nodes nearest to some coordinates, and the weights of them and their neighbours. */
template <class D>
struct TrimSpline {
  TrimIntsOf<D> node;
  hn::Vec<D> weight[3];

  HWY_INLINE TrimSpline(D d, hn::Vec<D> coordinate, float last) {
    const auto half = Set(d, 0.5f), scale = Set(d, 0.5f * last);
    // A lane without a number may come along: it must not leave the map.
    auto x = Max(MulAdd(coordinate, scale, scale), Zero(d));
    x = Min(x, Set(d, last));
    node = ConvertTo(hn::RebindToSigned<D>(), x + half);
    const auto at = x - ConvertTo(d, node);
    const auto low = half - at, high = half + at;
    weight[0] = half * (low * low);
    weight[1] = NegMulAdd(at, at, Set(d, 0.75f));
    weight[2] = half * (high * high);
  }
};

/** Which of the 3 x 3 nodes about some nodes are outside, a bit each, column by column. */
template <class D>
HWY_INLINE TrimIntsOf<D> trimCodes(D, const TrimTable& table, TrimIntsOf<D> column,
                                   TrimIntsOf<D> row) {
  const hn::RebindToSigned<D> di;
  const auto place = row * Set(di, table.words_per_row) + hn::ShiftRight<3>(column);
  const auto in_word = column & Set(di, 7);
  const auto shift = in_word + (in_word + in_word);
  return (GatherIndex(di, table.words, place) >> shift) & Set(di, 0x1ff);
}

/** outsideShare() at (u, v); the table must not be a closed surfel's. */
template <class D>
HWY_INLINE hn::Vec<D> outsideShares(D d, const TrimTable& table, hn::Vec<D> u, hn::Vec<D> v) {
  const hn::RebindToSigned<D> di;
  const TrimSpline<D> column(d, u, table.last), row(d, v, table.last);
  const auto code = trimCodes(d, table, column.node, row.node);
  // Most places have all nine nodes inside.
  if (AllTrue(di, code == Zero(di))) return Zero(d);
  const auto outside = [&](int bit, hn::Vec<D> weight) HWY_ATTR {
    return IfThenElseZero(RebindMask(d, TestBit(code, Set(di, 1 << bit))), weight);
  };
  auto sum = Zero(d);
  for (int i = 0; i < 3; ++i) {
    const auto in_column = outside(3 * i, row.weight[0]) + outside(3 * i + 1, row.weight[1]) +
                           outside(3 * i + 2, row.weight[2]);
    sum = MulAdd(column.weight[i], in_column, sum);
  }
  return sum;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
