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

using TrimIntTag = hn::RebindToSigned<Tag>;
using TrimInts = hn::Vec<TrimIntTag>;

/** The nodes nearest to some coordinates, and the weights of them and their neighbours. */
struct TrimSpline {
  TrimInts node;
  Vec weight[3];

  HWY_INLINE TrimSpline(Vec coordinate, float last)
  {
    const Tag d;
    const Vec half = hn::Set(d, 0.5f), scale = hn::Set(d, 0.5f * last);
    // A lane without a number may come along: it must not leave the map.
    Vec x = hn::Max(hn::MulAdd(coordinate, scale, scale), hn::Zero(d));
    x = hn::Min(x, hn::Set(d, last));
    node = hn::ConvertTo(TrimIntTag(), hn::Add(x, half));
    const Vec at = hn::Sub(x, hn::ConvertTo(d, node));
    const Vec low = hn::Sub(half, at), high = hn::Add(half, at);
    weight[0] = hn::Mul(half, hn::Mul(low, low));
    weight[1] = hn::NegMulAdd(at, at, hn::Set(d, 0.75f));
    weight[2] = hn::Mul(half, hn::Mul(high, high));
  }
};

/** outsideShare() at (u, v); the table must not be a closed surfel's. */
HWY_INLINE Vec
outsideShares(const TrimTable& table, Vec u, Vec v)
{
  const Tag d;
  const TrimIntTag di;
  const TrimSpline column(u, table.last), row(v, table.last);
  const TrimInts place =
      hn::Add(hn::Mul(row.node, hn::Set(di, table.words_per_row)), hn::ShiftRight<3>(column.node));
  const TrimInts eight = hn::And(column.node, hn::Set(di, 7));
  const TrimInts shift = hn::Add(eight, hn::Add(eight, eight));
  const TrimInts code = hn::Shr(hn::GatherIndex(di, table.words, place), shift);
  // Most places have all nine nodes inside.
  if (hn::AllTrue(di, hn::Eq(hn::And(code, hn::Set(di, 0x1ff)), hn::Zero(di)))) return hn::Zero(d);
  const auto outside = [&](int bit, Vec weight) HWY_ATTR {
    const auto set = hn::TestBit(code, hn::Set(di, 1 << bit));
    return hn::IfThenElseZero(hn::RebindMask(d, set), weight);
  };
  Vec sum = hn::Zero(d);
  for (int i = 0; i < 3; ++i) {
    const Vec in_column =
        hn::Add(hn::Add(outside(3 * i, row.weight[0]), outside(3 * i + 1, row.weight[1])),
                outside(3 * i + 2, row.weight[2]));
    sum = hn::MulAdd(column.weight[i], in_column, sum);
  }
  return sum;
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
