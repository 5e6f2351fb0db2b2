// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>

#include "kernels/splat_kernels.h"
#include "pcl_slim/core/symmetric.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/cell_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "kernels/vector_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE {

using Quad = hn::CappedTag<double, 4>;

float farthestAndNearest(const float* x, const float* y, const float* z, std::size_t n,
                         const float center[3], std::size_t& nearest) {
  const hn::CappedTag<float, 4> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
  const auto cx = Set(d, center[0]), cy = Set(d, center[1]), cz = Set(d, center[2]);
  auto largest = Zero(d), least = Set(d, std::numeric_limits<float>::max());
  auto at = Zero(di), index = Iota(di, 0);
  const auto count = Set(di, static_cast<std::int32_t>(n));
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    const auto u = LoadU(d, x + i) - cx, v = LoadU(d, y + i) - cy, w = LoadU(d, z + i) - cz;
    const auto sq = u * u + v * v + w * w;
    const auto inside = RebindMask(d, index < count);
    const auto nearer = And(inside, sq < least);
    largest = Max(largest, IfThenElseZero(inside, sq));
    least = IfThenElse(nearer, sq, least);
    at = IfThenElse(RebindMask(di, nearer), index, at);
    index += Set(di, lanes);
  }
  float far[4], near[4];
  std::int32_t places[4];
  StoreU(largest, d, far);
  StoreU(least, d, near);
  StoreU(at, di, places);
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
V sumsOfFour(Quad d, V a, V b, V c, V e) {
  const auto ab = InterleaveLower(d, a, b) + InterleaveUpper(d, a, b);
  const auto ce = InterleaveLower(d, c, e) + InterleaveUpper(d, c, e);
  return ConcatLowerLower(d, ce, ab) + ConcatUpperUpper(d, ce, ab);
}
#endif

/** A vector's lanes, from part on, of four sums of everything: point i counts in lane i % 4.
 * quads: where vectors are shorter than four, the lanes; else the sums of all four. */
void sumLanes(const float* const columns[9], std::size_t n, std::size_t part, double (*quads)[4],
              [[maybe_unused]] double sums[kNumSums]) {
  const Quad d;
  const hn::Rebind<float, Quad> df;
  auto x1 = Zero(d), y1 = x1, z1 = x1, p2 = x1, u1 = x1, v1 = x1, w1 = x1, uu = x1, uv = x1,
       uw = x1, vv = x1, vw = x1, ww = x1, l1 = x1, a1 = x1, b1 = x1, c2 = x1;
  const auto step = [&](const auto& at) {
    const auto x = at(0), y = at(1), z = at(2);
    x1 += x;
    y1 += y;
    z1 += z;
    p2 += x * x + y * y + z * z;
    const auto u = at(3), v = at(4), w = at(5);
    u1 += u;
    v1 += v;
    w1 += w;
    uu += u * u;
    uv += u * v;
    uw += u * w;
    vv += v * v;
    vw += v * w;
    ww += w * w;
    const auto l = at(6), a = at(7), b = at(8);
    l1 += l;
    a1 += a;
    b1 += b;
    c2 += l * l + a * a + b * b;
  };
  std::size_t i = part;
  const std::size_t whole = n / 4 * 4;
  for (; i < whole; i += 4) {
    step([&](int c) { return PromoteTo(d, LoadU(df, columns[c] + i)); });
  }
  if (i < n) {
    const auto inside = FirstN(df, n - i);
    step([&](int c) { return PromoteTo(d, IfThenElseZero(inside, LoadU(df, columns[c] + i))); });
  }
#if HWY_TARGET != HWY_SCALAR
  if (hn::Lanes(d) == 4) {
    StoreU(sumsOfFour(d, x1, y1, z1, p2), d, sums);
    StoreU(sumsOfFour(d, u1, v1, w1, uu), d, sums + 4);
    StoreU(sumsOfFour(d, uv, uw, vv, vw), d, sums + 8);
    StoreU(sumsOfFour(d, ww, l1, a1, b1), d, sums + 12);
    StoreU(c2, d, quads[0]);
    return;
  }
#endif
  const auto put = [&](std::size_t k, decltype(x1) sum) { StoreU(sum, d, quads[k] + part); };
  put(0, x1), put(1, y1), put(2, z1), put(3, p2);
  put(4, u1), put(5, v1), put(6, w1);
  put(7, uu), put(8, uv), put(9, uw), put(10, vv), put(11, vw), put(12, ww);
  put(13, l1), put(14, a1), put(15, b1), put(16, c2);
}

double sumOfQuad(const double quad[4]) {
  return (quad[0] + quad[1]) + (quad[2] + quad[3]);
}

void sumPoints(const float* const columns[9], std::size_t n, double sums[kNumSums]) {
  double quads[kNumSums][4];
  const std::size_t lanes = hn::Lanes(Quad());
  for (std::size_t part = 0; part < 4; part += lanes) sumLanes(columns, n, part, quads, sums);
  for (std::size_t k = 0; k < kNumSums && lanes < 4; ++k) sums[k] = sumOfQuad(quads[k]);
  if (lanes == 4) sums[16] = sumOfQuad(quads[0]);
}

using CellVector = hn::Vec<Doubles>;

/** Symmetric matrices, one in each lane, their entries placed as Symmetric3 has them. */
struct Symmetric {
  CellVector m[6];

  Symmetric squared() const {
    const auto [a, b, c, d, e, f] = m;
    return {{dot(a, a, b, b, c, c), dot(a, b, b, d, c, e), dot(a, c, b, e, c, f),
             dot(b, b, d, d, e, e), dot(b, c, d, e, e, f), dot(c, c, e, e, f, f)}};
  }

  /** Row of the product with a vector. */
  CellVector times(int row, CellVector x, CellVector y, CellVector z) const {
    const SymmetricEntry* at = kSymmetricEntry[row];
    return dot(m[at[0]], x, m[at[1]], y, m[at[2]], z);
  }

  static CellVector dot(CellVector a, CellVector b, CellVector c, CellVector d, CellVector e,
                        CellVector f) {
    return a * b + c * d + e * f;
  }
};

/** det(t I - m). */
CellVector characteristic(const Symmetric& s, CellVector t) {
  const auto a = t - s.m[kXX], b = t - s.m[kYY], c = t - s.m[kZZ];
  const auto d = s.m[kXY], e = s.m[kXZ], f = s.m[kYZ];
  const auto first = a * (b * c - f * f);
  const auto second = d * (d * c + f * e);
  const auto third = e * (d * f + b * e);
  return first - second - third;
}

/** Whether normals have one axis: they are along a line (CellSums::unorientedAbove) and their sum
 * is at least half of what it would be if they shared one side. */
hn::Mask<Doubles> haveOneAxis(const Symmetric& whole, CellVector total, CellVector sum_sq,
                              CellVector count, double widest) {
  const Doubles d;
  const auto value = characteristic(whole, total * Set(d, 1.0 - widest));
  const auto cube = total * total * total;
  const auto one_line = value <= Set(d, 1e-13) * cube;
  const auto half = Set(d, 0.5) * count;
  const auto one_side = sum_sq >= half * half;
  return And(And(one_line, one_side), total > Set(d, 0.5));
}

void commonNormals(const double* cells, std::size_t n, double widest, double* normals) {
  const Doubles d;
  const hn::RebindToSigned<Doubles> di;
  constexpr int kNormal = 5, kProduct = 8;
  const auto row = Iota(di, 0);
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < n; i += lanes) {
    const auto last = Set(di, static_cast<std::int64_t>(n - 1 - i));
    const auto place = Min(row, last) * Set(di, std::int64_t{kCellNumbers});
    const auto number = [&](int k) { return GatherIndex(d, cells + i * kCellNumbers + k, place); };
    Symmetric whole, power;
    for (int k = 0; k < 6; ++k) whole.m[k] = number(kProduct + k);
    const auto count = number(0), x = number(kNormal), y = number(kNormal + 1),
               z = number(kNormal + 2);
    const auto total = whole.m[kXX] + whole.m[kYY] + whole.m[kZZ];
    const auto one_axis =
        haveOneAxis(whole, total, Symmetric::dot(x, x, y, y, z, z), count, widest);
    // Where normals agree, the eighth power leaves one axis of their mean.
    const auto scale = Set(d, 1.0) / total;
    for (int k = 0; k < 6; ++k) power.m[k] = whole.m[k] * scale;
    power = power.squared().squared().squared();
    auto u = power.times(0, x, y, z), v = power.times(1, x, y, z), w = power.times(2, x, y, z);
    const auto length = Set(d, 1.0) / Sqrt(Symmetric::dot(u, u, v, v, w, w));
    u *= length, v *= length, w *= length;
    const auto along = Symmetric::dot(u, whole.times(0, u, v, w), v, whole.times(1, u, v, w), w,
                                      whole.times(2, u, v, w));
    const auto rest = Set(d, 1.0) - along * scale;
    const auto some = count > Set(d, 1.0);
    const auto variance = IfThenElseZero(some, Min(Max(rest, Zero(d)), Set(d, 2.0 / 3.0)));
    double out[4][8];
    StoreU(u, d, out[0]);
    StoreU(v, d, out[1]);
    StoreU(w, d, out[2]);
    StoreU(IfThenElse(one_axis, variance, Set(d, -1.0)), d, out[3]);
    for (std::size_t k = 0; k < std::min(lanes, n - i); ++k) {
      for (std::size_t c = 0; c < 4; ++c) normals[4 * (i + k) + c] = out[c][k];
    }
  }
}

}  // namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::splat_kernels {

HWY_EXPORT(farthestAndNearest);
float farthestAndNearest(const float* x, const float* y, const float* z, std::size_t n,
                         const float center[3], std::size_t& nearest) {
  return HWY_DYNAMIC_DISPATCH(farthestAndNearest)(x, y, z, n, center, nearest);
}

HWY_EXPORT(sumPoints);
void sumPoints(const float* const columns[9], std::size_t n, double sums[kNumSums]) {
  HWY_DYNAMIC_DISPATCH(sumPoints)(columns, n, sums);
}

HWY_EXPORT(commonNormals);
void commonNormals(const double* cells, std::size_t n, double widest, double* normals) {
  HWY_DYNAMIC_DISPATCH(commonNormals)(cells, n, widest, normals);
}

}  // namespace pcl_slim::detail::splat_kernels
#endif
