// SPDX-License-Identifier: BSD-3-Clause
// The pixels of a block as one vector or two, so that one load of a leaf's data is used for many
// pixels, and of two vectors a processor runs both chains of operations side by side. Functions and
// operators are Highway's. The guard toggles: Highway compiles a kernel file once per instruction
// set.
#if defined(PCL_SLIM_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_LANES_INL
#undef PCL_SLIM_LANES_INL
#else
#define PCL_SLIM_LANES_INL
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"
#include "pcl_slim/surface/detail/kernel_math-inl.h"
#include "pcl_slim/surface/weight_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX3  // vectors of sixteen lanes: one contains a block's pixels

using Part = hn::CappedTag<float, 16>;
using UintPart = hn::RebindToUnsigned<Part>;

constexpr int kLanes = static_cast<int>(hn::MaxLanes(Part()));

using Vec = hn::Vec<Part>;
using UintVec = hn::Vec<UintPart>;
using Mask = hn::Mask<Part>;

HWY_INLINE Vec set(float value) {
  return Set(Part(), value);
}

HWY_INLINE UintVec setUint(std::uint32_t value) {
  return Set(UintPart(), value);
}

/** \param[in] values aligned. */
HWY_INLINE Vec load(const float* values) {
  return Load(Part(), values);
}

HWY_INLINE void store(Vec v, float* values) {
  Store(v, Part(), values);
}

HWY_INLINE void store(UintVec v, std::uint32_t* values) {
  Store(v, UintPart(), values);
}

HWY_INLINE UintVec IfThenElse(Mask m, UintVec yes, UintVec no) {
  return IfThenElse(RebindMask(UintPart(), m), yes, no);
}

HWY_INLINE bool AllFalse(Mask m) {
  return AllFalse(Part(), m);
}

HWY_INLINE bool AllTrue(Mask m) {
  return AllTrue(Part(), m);
}

HWY_INLINE std::size_t CountTrue(Mask m) {
  return CountTrue(Part(), m);
}

/** The smallest lane. */
HWY_INLINE float smallest(Vec v) {
  return GetLane(MinOfLanes(Part(), v));
}

/** The first lane. */
HWY_INLINE float firstLane(Vec v) {
  return GetLane(v);
}

/** Stores a[0], b[0], a[1], b[1], ... \param[out] values aligned. */
HWY_INLINE void storeInterleaved(Vec a, Vec b, float* values) {
  StoreInterleaved2(a, b, Part(), values);
}

/** Stores a[0], b[0], c[0], a[1], ... \param[out] values aligned. */
HWY_INLINE void storeInterleaved(Vec a, Vec b, Vec c, float* values) {
  StoreInterleaved3(a, b, c, Part(), values);
}

/** What a function of vectors of Highway's makes of each part of some. */
template <typename Function, typename... Vectors>
HWY_INLINE Vec byParts(const Function& function, Vectors... vectors) {
  return function(vectors...);
}

#else  // vectors of eight lanes or fewer: two do

using Part = hn::CappedTag<float, 8>;
using UintPart = hn::RebindToUnsigned<Part>;

constexpr int kPartLanes = static_cast<int>(hn::MaxLanes(Part()));
constexpr int kLanes = 2 * kPartLanes;

/** Members by name: compilers keep an array in memory. Copied one by one: of a whole compilers make
 * copies of 16 bytes, which a load of 32 waits for. */
template <class V>
struct Pair {
  V low, high;

  Pair() = default;
  Pair(V l, V h) : low(l), high(h) {}
  Pair(const Pair& other) : low(other.low), high(other.high) {}
  Pair& operator=(const Pair& other) {
    low = other.low;
    high = other.high;
    return *this;
  }
  HWY_INLINE Pair& operator+=(const Pair& b) { return *this = {low + b.low, high + b.high}; }
  HWY_INLINE Pair& operator*=(const Pair& b) { return *this = {low * b.low, high * b.high}; }
};

using Vec = Pair<hn::Vec<Part>>;
using UintVec = Pair<hn::Vec<UintPart>>;

template <class V>
HWY_INLINE Pair<V> numberOf(NumberType<Pair<V>>, double value) {
  return {number<V>(value), number<V>(value)};
}

struct Mask {
  hn::Mask<Part> low, high;

  Mask() = default;
  Mask(hn::Mask<Part> l, hn::Mask<Part> h) : low(l), high(h) {}
  Mask(const Mask& other) : low(other.low), high(other.high) {}
  Mask& operator=(const Mask& other) {
    low = other.low;
    high = other.high;
    return *this;
  }
};

#define PCL_SLIM_PAIR_OPERATOR(Result, op)                    \
  HWY_INLINE Result operator op(const Vec& a, const Vec& b) { \
    return {a.low op b.low, a.high op b.high};                \
  }
#define PCL_SLIM_PAIR_1(Result, Name, Argument) \
  HWY_INLINE Result Name(const Argument& a) {   \
    return {hn::Name(a.low), hn::Name(a.high)}; \
  }
#define PCL_SLIM_PAIR_2(Result, Name, Argument)                  \
  HWY_INLINE Result Name(const Argument& a, const Argument& b) { \
    return {hn::Name(a.low, b.low), hn::Name(a.high, b.high)};   \
  }
#define PCL_SLIM_PAIR_3(Name)                                                 \
  HWY_INLINE Vec Name(const Vec& a, const Vec& b, const Vec& c) {             \
    return {hn::Name(a.low, b.low, c.low), hn::Name(a.high, b.high, c.high)}; \
  }

PCL_SLIM_PAIR_OPERATOR(Vec, +)
PCL_SLIM_PAIR_OPERATOR(Vec, -)
PCL_SLIM_PAIR_OPERATOR(Vec, *)
PCL_SLIM_PAIR_OPERATOR(Vec, /)
PCL_SLIM_PAIR_OPERATOR(Mask, <)
PCL_SLIM_PAIR_OPERATOR(Mask, <=)
PCL_SLIM_PAIR_OPERATOR(Mask, >)
PCL_SLIM_PAIR_OPERATOR(Mask, >=)
PCL_SLIM_PAIR_OPERATOR(Mask, ==)
PCL_SLIM_PAIR_1(Vec, Neg, Vec)
PCL_SLIM_PAIR_1(Vec, Abs, Vec)
PCL_SLIM_PAIR_1(Vec, Sqrt, Vec)
PCL_SLIM_PAIR_1(Mask, Not, Mask)
PCL_SLIM_PAIR_2(Vec, Min, Vec)
PCL_SLIM_PAIR_2(Vec, Max, Vec)
PCL_SLIM_PAIR_2(Mask, And, Mask)
PCL_SLIM_PAIR_2(Mask, Or, Mask)
PCL_SLIM_PAIR_2(Mask, Xor, Mask)
PCL_SLIM_PAIR_2(Mask, AndNot, Mask)
PCL_SLIM_PAIR_3(MulAdd)
PCL_SLIM_PAIR_3(NegMulAdd)
PCL_SLIM_PAIR_3(MulSub)

#undef PCL_SLIM_PAIR_OPERATOR
#undef PCL_SLIM_PAIR_1
#undef PCL_SLIM_PAIR_2
#undef PCL_SLIM_PAIR_3

HWY_INLINE Vec set(float value) {
  const auto same = Set(Part(), value);
  return {same, same};
}

HWY_INLINE UintVec setUint(std::uint32_t value) {
  const auto same = Set(UintPart(), value);
  return {same, same};
}

/** \param[in] values aligned. */
HWY_INLINE Vec load(const float* values) {
  return {Load(Part(), values), Load(Part(), values + kPartLanes)};
}

HWY_INLINE void store(const Vec& v, float* values) {
  Store(v.low, Part(), values);
  Store(v.high, Part(), values + kPartLanes);
}

HWY_INLINE void store(const UintVec& v, std::uint32_t* values) {
  Store(v.low, UintPart(), values);
  Store(v.high, UintPart(), values + kPartLanes);
}

HWY_INLINE Vec IfThenElse(const Mask& m, const Vec& yes, const Vec& no) {
  return {IfThenElse(m.low, yes.low, no.low), IfThenElse(m.high, yes.high, no.high)};
}

HWY_INLINE Vec IfThenElseZero(const Mask& m, const Vec& yes) {
  return {IfThenElseZero(m.low, yes.low), IfThenElseZero(m.high, yes.high)};
}

HWY_INLINE UintVec IfThenElse(const Mask& m, const UintVec& yes, const UintVec& no) {
  const UintPart d;
  return {IfThenElse(RebindMask(d, m.low), yes.low, no.low),
          IfThenElse(RebindMask(d, m.high), yes.high, no.high)};
}

HWY_INLINE bool AllFalse(const Mask& m) {
  return AllFalse(Part(), Or(m.low, m.high));
}

HWY_INLINE bool AllTrue(const Mask& m) {
  return AllTrue(Part(), And(m.low, m.high));
}

HWY_INLINE std::size_t CountTrue(const Mask& m) {
  return CountTrue(Part(), m.low) + CountTrue(Part(), m.high);
}

/** The smallest lane. */
HWY_INLINE float smallest(const Vec& v) {
  return GetLane(MinOfLanes(Part(), Min(v.low, v.high)));
}

/** The first lane. */
HWY_INLINE float firstLane(const Vec& v) {
  return GetLane(v.low);
}

/** Stores a[0], b[0], a[1], b[1], ... \param[out] values aligned. */
HWY_INLINE void storeInterleaved(const Vec& a, const Vec& b, float* values) {
  StoreInterleaved2(a.low, b.low, Part(), values);
  StoreInterleaved2(a.high, b.high, Part(), values + 2 * kPartLanes);
}

/** Stores a[0], b[0], c[0], a[1], ... \param[out] values aligned. */
HWY_INLINE void storeInterleaved(const Vec& a, const Vec& b, const Vec& c, float* values) {
  StoreInterleaved3(a.low, b.low, c.low, Part(), values);
  StoreInterleaved3(a.high, b.high, c.high, Part(), values + 3 * kPartLanes);
}

/** What a function of vectors of Highway's makes of each part of some. */
template <typename Function>
HWY_INLINE Vec byParts(const Function& function, const Vec& a) {
  return {function(a.low), function(a.high)};
}

template <typename Function>
HWY_INLINE Vec byParts(const Function& function, const Vec& a, const Vec& b) {
  return {function(a.low, b.low), function(a.high, b.high)};
}

#endif

HWY_INLINE Vec dot3(const Vec& ax, const Vec& ay, const Vec& az, const Vec& bx, const Vec& by,
                    const Vec& bz) {
  return MulAdd(ax, bx, MulAdd(ay, by, Mul(az, bz)));
}

/** G at squared relative distances below 1. */
HWY_INLINE Vec blendWeight(WeightKernel kernel, const Vec& s_sq) {
  return forKernel(kernel, [&](auto k) HWY_ATTR {
    return byParts([](auto part) HWY_ATTR { return kernelWeight<decltype(k)::value>(part); }, s_sq);
  });
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif
