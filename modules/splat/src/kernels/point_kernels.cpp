// SPDX-License-Identifier: BSD-3-Clause
#include "kernels/splat_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/point_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "kernels/vector_types-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE {

bool boxOfPoints(const unsigned char* first, std::size_t stride, std::size_t n, float low[3],
                 float high[3]) {
  const hn::CappedTag<float, 4> d;
  // As many axes at a time as a vector has lanes; lanes behind the third axis are ignored.
  for (std::size_t axis = 0; axis < 3; axis += hn::Lanes(d)) {
    auto least = Set(d, std::numeric_limits<float>::max()), largest = Neg(least);
    auto bad = Zero(d);
    for (std::size_t i = 0; i < n; ++i) {
      const auto p = LoadU(d, reinterpret_cast<const float*>(first + i * stride) + axis);
      bad += p - p;
      least = Min(least, p);
      largest = Max(largest, p);
    }
    float lanes[3][4];
    StoreU(bad, d, lanes[0]);
    StoreU(least, d, lanes[1]);
    StoreU(largest, d, lanes[2]);
    for (std::size_t a = axis; a < std::min<std::size_t>(3, axis + hn::Lanes(d)); ++a) {
      if (lanes[0][a - axis] != 0) return false;
      low[a] = lanes[1][a - axis];
      high[a] = lanes[2][a - axis];
    }
  }
  return true;
}

void gatherVectors(const unsigned char* first, std::size_t stride, const std::uint32_t* points,
                   std::size_t n, float* x, float* y, float* z) {
  for (std::size_t k = 0; k < n; k += 4) {
    const float* p[4];
    for (std::size_t i = 0; i < 4; ++i) {
      p[i] = reinterpret_cast<const float*>(first + points[k + i] * stride);
    }
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t i = 0; i < 4; ++i) {
      x[k + i] = p[i][0], y[k + i] = p[i][1], z[k + i] = p[i][2];
    }
#else
    const hn::FixedTag<float, 4> d;
    const auto a = LoadU(d, p[0]), b = LoadU(d, p[1]), c = LoadU(d, p[2]), e = LoadU(d, p[3]);
    const auto ac = InterleaveLower(d, a, c), be = InterleaveLower(d, b, e);
    StoreU(InterleaveLower(d, ac, be), d, x + k);
    StoreU(InterleaveUpper(d, ac, be), d, y + k);
    StoreU(InterleaveLower(d, InterleaveUpper(d, a, c), InterleaveUpper(d, b, e)), d, z + k);
#endif
  }
}

void toCells(const OctreeFrame& frame, float* x, float* y, float* z, std::size_t n) {
  const Doubles d;
  const HalfFloats df;
  const auto scale = Set(d, frame.scale);
  const auto last = Set(df, frame.last);
  float* const columns[3] = {x, y, z};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto low = Set(d, frame.origin[a]);
    for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
      const auto world = PromoteTo(d, Load(df, columns[a] + i));
      const auto cells = DemoteTo(df, (world - low) * scale);
      Store(Min(cells, last), df, columns[a] + i);
    }
  }
}

/** Two zero bits behind each of the low 21 bits. */
template <typename V>
V spread(Words d, V v) {
  const auto step = [d](V bits, int shift, std::uint64_t mask) {
    return (bits | ShiftLeftSame(bits, shift)) & Set(d, mask);
  };
  v = step(v, 32, 0x1f00000000ffffULL);
  v = step(v, 16, 0x1f0000ff0000ffULL);
  v = step(v, 8, 0x100f00f00f00f00fULL);
  v = step(v, 4, 0x10c30c30c30c30c3ULL);
  return step(v, 2, 0x1249249249249249ULL);
}

/** Codes of as many positions as a vector has lanes, times a power of two. */
hn::Vec<Words> mortonCodes(const float* x, const float* y, const float* z, float scale) {
  const Words d;
  const hn::Rebind<float, Words> df;
  const hn::Rebind<std::int32_t, Words> di;
  const hn::Rebind<std::uint32_t, Words> du;
  const auto cell = [&](const float* column) {
    const auto c = ConvertTo(di, LoadU(df, column) * Set(df, scale));
    return spread(d, PromoteTo(d, BitCast(du, c)));
  };
  return hn::ShiftLeft<2>(cell(x)) | (hn::ShiftLeft<1>(cell(y)) | cell(z));
}

void mortonKeys(const float* x, const float* y, const float* z, std::size_t n, int depth,
                std::uint64_t* keys) {
  const Words d;
  const auto scale = static_cast<float>(1 << depth);
  for (std::size_t i = 0; i < n; i += hn::Lanes(d)) {
    StoreU(mortonCodes(x + i, y + i, z + i, scale), d, keys + i);
  }
}

void normalizeOne(float& x, float& y, float& z) {
  const float sq = x * x + y * y + z * z;
  if (std::abs(sq - 1.0f) < 1e-3f) return;
  const bool usable = sq > 1e-24f && std::isfinite(sq);
  const float scale = usable ? 1.0f / std::sqrt(sq) : 0.0f;
  x = usable ? x * scale : 0.0f;
  y = usable ? y * scale : 0.0f;
  z = usable ? z * scale : 0.0f;
}

void normalize(float* x, float* y, float* z, std::size_t n) {
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < n; i += lanes) {
    const auto u = Load(d, x + i), v = Load(d, y + i), w = Load(d, z + i);
    const auto sq = u * u + v * v + w * w;
    const auto off = Abs(sq - Set(d, 1.0f));
    if (AllTrue(d, off < Set(d, 1e-3f))) continue;
    for (std::size_t k = i; k < i + lanes; ++k) normalizeOne(x[k], y[k], z[k]);
  }
}

}  // namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::splat_kernels {

HWY_EXPORT(normalize);
void normalize(float* x, float* y, float* z, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(normalize)(x, y, z, n);
}

HWY_EXPORT(boxOfPoints);
bool boxOfPoints(const unsigned char* first, std::size_t stride, std::size_t n, float low[3],
                 float high[3]) {
  return HWY_DYNAMIC_DISPATCH(boxOfPoints)(first, stride, n, low, high);
}

HWY_EXPORT(gatherVectors);
void gatherVectors(const unsigned char* first, std::size_t stride, const std::uint32_t* points,
                   std::size_t n, float* x, float* y, float* z) {
  HWY_DYNAMIC_DISPATCH(gatherVectors)(first, stride, points, n, x, y, z);
}

HWY_EXPORT(toCells);
void toCells(const OctreeFrame& frame, float* x, float* y, float* z, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(toCells)(frame, x, y, z, n);
}

HWY_EXPORT(mortonKeys);
void mortonKeys(const float* x, const float* y, const float* z, std::size_t n, int depth,
                std::uint64_t* keys) {
  HWY_DYNAMIC_DISPATCH(mortonKeys)(x, y, z, n, depth, keys);
}

}  // namespace pcl_slim::detail::splat_kernels
#endif
