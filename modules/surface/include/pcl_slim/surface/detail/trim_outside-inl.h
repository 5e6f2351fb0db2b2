// SPDX-License-Identifier: BSD-3-Clause
// outsideShare() of many places in one open surfel's disc at once. Highway compiles a kernel file
// once per instruction set, so the guard toggles.
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

  HWY_INLINE TrimSpline(D d, hn::Vec<D> coordinate, float last)
  {
    const auto half = hn::Set(d, 0.5f), scale = hn::Set(d, 0.5f * last);
    // A lane without a number may come along: it must not leave the map.
    auto x = hn::Max(hn::MulAdd(coordinate, scale, scale), hn::Zero(d));
    x = hn::Min(x, hn::Set(d, last));
    node = hn::ConvertTo(hn::RebindToSigned<D>(), hn::Add(x, half));
    const auto at = hn::Sub(x, hn::ConvertTo(d, node));
    const auto low = hn::Sub(half, at), high = hn::Add(half, at);
    weight[0] = hn::Mul(half, hn::Mul(low, low));
    weight[1] = hn::NegMulAdd(at, at, hn::Set(d, 0.75f));
    weight[2] = hn::Mul(half, hn::Mul(high, high));
  }
};

/** Which of the 3 x 3 nodes about some nodes are outside, a bit each, column by column. */
template <class D>
HWY_INLINE TrimIntsOf<D>
trimCodes(D, const TrimTable& table, TrimIntsOf<D> column, TrimIntsOf<D> row)
{
  const hn::RebindToSigned<D> di;
  const auto place =
      hn::Add(hn::Mul(row, hn::Set(di, table.words_per_row)), hn::ShiftRight<3>(column));
  const auto in_word = hn::And(column, hn::Set(di, 7));
  const auto shift = hn::Add(in_word, hn::Add(in_word, in_word));
  return hn::And(hn::Shr(hn::GatherIndex(di, table.words, place), shift), hn::Set(di, 0x1ff));
}

/** outsideShare() at (u, v); the table must not be a closed surfel's. */
template <class D>
HWY_INLINE hn::Vec<D>
outsideShares(D d, const TrimTable& table, hn::Vec<D> u, hn::Vec<D> v)
{
  const hn::RebindToSigned<D> di;
  const TrimSpline<D> column(d, u, table.last), row(d, v, table.last);
  const auto code = trimCodes(d, table, column.node, row.node);
  // Most places have all nine nodes inside.
  if (hn::AllTrue(di, hn::Eq(code, hn::Zero(di)))) return hn::Zero(d);
  const auto outside = [&](int bit, hn::Vec<D> weight) HWY_ATTR {
    const auto set = hn::TestBit(code, hn::Set(di, 1 << bit));
    return hn::IfThenElseZero(hn::RebindMask(d, set), weight);
  };
  auto sum = hn::Zero(d);
  for (int i = 0; i < 3; ++i) {
    const auto in_column =
        hn::Add(hn::Add(outside(3 * i, row.weight[0]), outside(3 * i + 1, row.weight[1])),
                outside(3 * i + 2, row.weight[2]));
    sum = hn::MulAdd(column.weight[i], in_column, sum);
  }
  return sum;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
