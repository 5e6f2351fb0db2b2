// SPDX-License-Identifier: BSD-3-Clause
#include "splat_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "splat_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::splat_kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Doubles = hn::CappedTag<double, 4>;
using HalfFloats = hn::Rebind<float, Doubles>;
using Words = hn::CappedTag<std::uint64_t, 8>;

bool
boxOfPoints(const unsigned char* first, std::size_t stride, std::size_t n, float low[3],
            float high[3])
{
  const hn::CappedTag<float, 4> d;
  // As many axes at a time as a vector holds; what lies behind the third is looked at in vain.
  for (std::size_t axis = 0; axis < 3; axis += hn::Lanes(d)) {
    auto least = hn::Set(d, std::numeric_limits<float>::max()), largest = hn::Neg(least);
    auto bad = hn::Zero(d);
    for (std::size_t i = 0; i < n; ++i) {
      const auto p = hn::LoadU(d, reinterpret_cast<const float*>(first + i * stride) + axis);
      bad = hn::Add(bad, hn::Sub(p, p));
      least = hn::Min(least, p);
      largest = hn::Max(largest, p);
    }
    float lanes[3][4];
    hn::StoreU(bad, d, lanes[0]);
    hn::StoreU(least, d, lanes[1]);
    hn::StoreU(largest, d, lanes[2]);
    for (std::size_t a = axis; a < std::min<std::size_t>(3, axis + hn::Lanes(d)); ++a) {
      if (lanes[0][a - axis] != 0) return false;
      low[a] = lanes[1][a - axis];
      high[a] = lanes[2][a - axis];
    }
  }
  return true;
}

void
toCells(const OctreeFrame& frame, float* x, float* y, float* z, std::size_t n)
{
  const Doubles d;
  const HalfFloats df;
  const auto scale = hn::Set(d, frame.scale);
  const auto last = hn::Set(df, frame.last);
  float* const columns[3] = {x, y, z};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto low = hn::Set(d, frame.origin[a]);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
      const auto world = hn::PromoteTo(d, hn::Load(df, columns[a] + i));
      const auto cells = hn::DemoteTo(df, hn::Mul(hn::Sub(world, low), scale));
      hn::Store(hn::Min(cells, last), df, columns[a] + i);
    }
  }
}

/** Two zero bits behind each of the low 21 bits. */
template <typename V>
V
spread(Words d, V v)
{
  const auto step = [d](V bits, int shift, std::uint64_t mask) {
    return hn::And(hn::Or(bits, hn::ShiftLeftSame(bits, shift)), hn::Set(d, mask));
  };
  v = step(v, 32, 0x1f00000000ffffULL);
  v = step(v, 16, 0x1f0000ff0000ffULL);
  v = step(v, 8, 0x100f00f00f00f00fULL);
  v = step(v, 4, 0x10c30c30c30c30c3ULL);
  return step(v, 2, 0x1249249249249249ULL);
}

void
packKeys(const float* x, const float* y, const float* z, const std::uint32_t* index, std::size_t n,
         int depth, int index_bits, std::uint64_t* packed)
{
  const Words d;
  const hn::Rebind<float, Words> df;
  const hn::Rebind<std::int32_t, Words> di;
  const hn::Rebind<std::uint32_t, Words> du;
  const auto scale = hn::Set(df, static_cast<float>(1 << depth));
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto cell = [&](const float* column) {
      const auto c = hn::ConvertTo(di, hn::Mul(hn::Load(df, column + i), scale));
      return spread(d, hn::PromoteTo(d, hn::BitCast(du, c)));
    };
    const auto code = hn::Or(hn::ShiftLeft<2>(cell(x)), hn::Or(hn::ShiftLeft<1>(cell(y)), cell(z)));
    const auto low = hn::PromoteTo(d, hn::Load(du, index + i));
    hn::StoreU(hn::Or(hn::ShiftLeftSame(code, index_bits), low), d, packed + i);
  }
}

/** Cube root of q from 216/24389 on, the tangent line below (CIE 15). */
template <typename V>
V
labRoot(Floats d, V q)
{
  const auto threshold = hn::Set(d, 216.0f / 24389.0f);
  const hn::RebindToSigned<Floats> di;
  const auto high = hn::Max(q, threshold);
  // 1/cbrt by its exponent, within 4 %; three steps of Newton reach a float's last bits.
  const auto bits = hn::ConvertTo(d, hn::BitCast(di, high));
  const auto third = hn::ConvertTo(di, hn::Mul(bits, hn::Set(d, 1.0f / 3.0f)));
  auto r = hn::BitCast(d, hn::Sub(hn::Set(di, 0x54a2fa8c), third));
  const auto q_third = hn::Mul(high, hn::Set(d, 1.0f / 3.0f));
  for (int step = 0; step < 3; ++step) {
    const auto r2 = hn::Mul(r, r);
    r = hn::Sub(hn::Mul(r, hn::Set(d, 4.0f / 3.0f)), hn::Mul(q_third, hn::Mul(r2, r2)));
  }
  const auto root = hn::Mul(hn::Mul(high, r), r);
  const auto line = hn::Add(hn::Mul(q, hn::Set(d, 841.0f / 108.0f)), hn::Set(d, 16.0f / 116.0f));
  return hn::IfThenElse(hn::Gt(q, threshold), root, line);
}

void
labOfLinear(const float to_xyz[9], float* r, float* g, float* b, std::size_t n)
{
  const Floats d;
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto red = hn::Load(d, r + i), green = hn::Load(d, g + i), blue = hn::Load(d, b + i);
    const auto rootOf = [&](const float* row) {
      const auto q =
          hn::Add(hn::Add(hn::Mul(hn::Set(d, row[0]), red), hn::Mul(hn::Set(d, row[1]), green)),
                  hn::Mul(hn::Set(d, row[2]), blue));
      return labRoot(d, q);
    };
    const auto fx = rootOf(to_xyz), fy = rootOf(to_xyz + 3), fz = rootOf(to_xyz + 6);
    hn::Store(hn::Sub(hn::Mul(fy, hn::Set(d, 116.0f)), hn::Set(d, 16.0f)), d, r + i);
    hn::Store(hn::Mul(hn::Sub(fx, fy), hn::Set(d, 500.0f)), d, g + i);
    hn::Store(hn::Mul(hn::Sub(fy, fz), hn::Set(d, 200.0f)), d, b + i);
  }
}

void
normalizeOne(float& x, float& y, float& z)
{
  const float sq = x * x + y * y + z * z;
  if (std::abs(sq - 1.0f) < 1e-3f) return;
  const bool usable = sq > 1e-24f && std::isfinite(sq);
  const float scale = usable ? 1.0f / std::sqrt(sq) : 0.0f;
  x = usable ? x * scale : 0.0f;
  y = usable ? y * scale : 0.0f;
  z = usable ? z * scale : 0.0f;
}

void
normalize(float* x, float* y, float* z, std::size_t n)
{
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < n; i += lanes) {
    const auto u = hn::Load(d, x + i), v = hn::Load(d, y + i), w = hn::Load(d, z + i);
    const auto sq = hn::Add(hn::Add(hn::Mul(u, u), hn::Mul(v, v)), hn::Mul(w, w));
    const auto off = hn::Abs(hn::Sub(sq, hn::Set(d, 1.0f)));
    if (hn::AllTrue(d, hn::Lt(off, hn::Set(d, 1e-3f)))) continue;
    for (std::size_t k = i; k < i + lanes; ++k) normalizeOne(x[k], y[k], z[k]);
  }
}

float
farthestAndNearest(const float* x, const float* y, const float* z, std::size_t n,
                   const float center[3], std::size_t& nearest)
{
  const hn::CappedTag<float, 4> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const auto cx = hn::Set(d, center[0]), cy = hn::Set(d, center[1]), cz = hn::Set(d, center[2]);
  auto largest = hn::Zero(d), least = hn::Set(d, std::numeric_limits<float>::max());
  auto at = hn::Zero(di), index = hn::Iota(di, 0);
  const auto count = hn::Set(di, static_cast<std::int32_t>(n));
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto u = hn::Sub(hn::LoadU(d, x + i), cx), v = hn::Sub(hn::LoadU(d, y + i), cy),
               w = hn::Sub(hn::LoadU(d, z + i), cz);
    const auto sq = hn::Add(hn::Add(hn::Mul(u, u), hn::Mul(v, v)), hn::Mul(w, w));
    const auto inside = hn::RebindMask(d, hn::Lt(index, count));
    const auto nearer = hn::And(inside, hn::Lt(sq, least));
    largest = hn::Max(largest, hn::IfThenElseZero(inside, sq));
    least = hn::IfThenElse(nearer, sq, least);
    at = hn::IfThenElse(hn::RebindMask(di, nearer), index, at);
    index = hn::Add(index, hn::Set(di, lanes));
  }
  float far[4], near[4];
  std::int32_t places[4];
  hn::StoreU(largest, d, far);
  hn::StoreU(least, d, near);
  hn::StoreU(at, di, places);
  std::int32_t best = 0;
  for (std::int32_t k = 1; k < lanes; ++k) {
    far[0] = std::max(far[0], far[k]);
    if (near[k] < near[best] || (near[k] == near[best] && places[k] < places[best])) best = k;
  }
  nearest = static_cast<std::size_t>(places[best]);
  return far[0];
}

#if HWY_TARGET != HWY_SCALAR
/** Sums of four vectors of four, as ((0 + 1) + (2 + 3)) each. */
template <typename V>
V
sumsOfFour(Doubles d, V a, V b, V c, V e)
{
  const auto ab = hn::Add(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
  const auto ce = hn::Add(hn::InterleaveLower(d, c, e), hn::InterleaveUpper(d, c, e));
  return hn::Add(hn::ConcatLowerLower(d, ce, ab), hn::ConcatUpperUpper(d, ce, ab));
}
#endif

/** A vector's lanes, from part on, of four sums of everything: point i counts in lane i % 4.
 * quads: where vectors are shorter than four, the lanes; else the sums of all four. */
void
sumLanes(const float* const columns[9], std::size_t n, std::size_t part, double (*quads)[4],
         [[maybe_unused]] double sums[kNumSums])
{
  const Doubles d;
  const HalfFloats df;
  auto x1 = hn::Zero(d), y1 = x1, z1 = x1, p2 = x1, u1 = x1, v1 = x1, w1 = x1, uu = x1, uv = x1,
       uw = x1, vv = x1, vw = x1, ww = x1, l1 = x1, a1 = x1, b1 = x1, c2 = x1;
  const auto step = [&](const auto& at) {
    const auto x = at(0), y = at(1), z = at(2);
    x1 = hn::Add(x1, x);
    y1 = hn::Add(y1, y);
    z1 = hn::Add(z1, z);
    p2 = hn::Add(p2, hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    const auto u = at(3), v = at(4), w = at(5);
    u1 = hn::Add(u1, u);
    v1 = hn::Add(v1, v);
    w1 = hn::Add(w1, w);
    uu = hn::Add(uu, hn::Mul(u, u));
    uv = hn::Add(uv, hn::Mul(u, v));
    uw = hn::Add(uw, hn::Mul(u, w));
    vv = hn::Add(vv, hn::Mul(v, v));
    vw = hn::Add(vw, hn::Mul(v, w));
    ww = hn::Add(ww, hn::Mul(w, w));
    const auto l = at(6), a = at(7), b = at(8);
    l1 = hn::Add(l1, l);
    a1 = hn::Add(a1, a);
    b1 = hn::Add(b1, b);
    c2 = hn::Add(c2, hn::Add(hn::Add(hn::Mul(l, l), hn::Mul(a, a)), hn::Mul(b, b)));
  };
  std::size_t i = part;
  const std::size_t whole = n / 4 * 4;
  for (; i < whole; i += 4) {
    step([&](int c) { return hn::PromoteTo(d, hn::LoadU(df, columns[c] + i)); });
  }
  if (i < n) {
    const auto inside = hn::FirstN(df, n - i);
    step([&](int c) {
      return hn::PromoteTo(d, hn::IfThenElseZero(inside, hn::LoadU(df, columns[c] + i)));
    });
  }
#if HWY_TARGET != HWY_SCALAR
  if (hn::Lanes(d) == 4) {
    hn::StoreU(sumsOfFour(d, x1, y1, z1, p2), d, sums);
    hn::StoreU(sumsOfFour(d, u1, v1, w1, uu), d, sums + 4);
    hn::StoreU(sumsOfFour(d, uv, uw, vv, vw), d, sums + 8);
    hn::StoreU(sumsOfFour(d, ww, l1, a1, b1), d, sums + 12);
    hn::StoreU(c2, d, quads[0]);
    return;
  }
#endif
  const auto put = [&](std::size_t k, decltype(x1) sum) { hn::StoreU(sum, d, quads[k] + part); };
  put(0, x1), put(1, y1), put(2, z1), put(3, p2);
  put(4, u1), put(5, v1), put(6, w1);
  put(7, uu), put(8, uv), put(9, uw), put(10, vv), put(11, vw), put(12, ww);
  put(13, l1), put(14, a1), put(15, b1), put(16, c2);
}

double
sumOfQuad(const double quad[4])
{
  return (quad[0] + quad[1]) + (quad[2] + quad[3]);
}

void
sumPoints(const float* const columns[9], std::size_t n, double sums[kNumSums])
{
  double quads[kNumSums][4];
  const std::size_t lanes = hn::Lanes(Doubles());
  for (std::size_t part = 0; part < 4; part += lanes) sumLanes(columns, n, part, quads, sums);
  for (std::size_t k = 0; k < kNumSums && lanes < 4; ++k) sums[k] = sumOfQuad(quads[k]);
  if (lanes == 4) sums[16] = sumOfQuad(quads[0]);
}

}  // namespace pcl_slim::splat_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::splat_kernels {

HWY_EXPORT(boxOfPoints);
HWY_EXPORT(toCells);
HWY_EXPORT(packKeys);
HWY_EXPORT(labOfLinear);
HWY_EXPORT(normalize);
HWY_EXPORT(farthestAndNearest);
HWY_EXPORT(sumPoints);

void
labOfLinear(const float to_xyz[9], float* r, float* g, float* b, std::size_t n)
{
  HWY_DYNAMIC_DISPATCH(labOfLinear)(to_xyz, r, g, b, n);
}

void
normalize(float* x, float* y, float* z, std::size_t n)
{
  HWY_DYNAMIC_DISPATCH(normalize)(x, y, z, n);
}

bool
boxOfPoints(const unsigned char* first, std::size_t stride, std::size_t n, float low[3],
            float high[3])
{
  return HWY_DYNAMIC_DISPATCH(boxOfPoints)(first, stride, n, low, high);
}

void
toCells(const OctreeFrame& frame, float* x, float* y, float* z, std::size_t n)
{
  HWY_DYNAMIC_DISPATCH(toCells)(frame, x, y, z, n);
}

void
packKeys(const float* x, const float* y, const float* z, const std::uint32_t* index, std::size_t n,
         int depth, int index_bits, std::uint64_t* packed)
{
  HWY_DYNAMIC_DISPATCH(packKeys)(x, y, z, index, n, depth, index_bits, packed);
}

float
farthestAndNearest(const float* x, const float* y, const float* z, std::size_t n,
                   const float center[3], std::size_t& nearest)
{
  return HWY_DYNAMIC_DISPATCH(farthestAndNearest)(x, y, z, n, center, nearest);
}

void
sumPoints(const float* const columns[9], std::size_t n, double sums[kNumSums])
{
  HWY_DYNAMIC_DISPATCH(sumPoints)(columns, n, sums);
}

}  // namespace pcl_slim::splat_kernels
#endif
