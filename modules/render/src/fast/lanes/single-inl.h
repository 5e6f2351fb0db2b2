// SPDX-License-Identifier: BSD-3-Clause
// A block's pixels in one vector, where a vector has sixteen lanes. The guard toggles: Highway compiles a
// kernel file once per instruction set.
#if defined(PCL_SLIM_SINGLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_SINGLE_INL
#undef PCL_SLIM_SINGLE_INL
#else
#define PCL_SLIM_SINGLE_INL
#endif

#include <cstddef>
#include <cstdint>

#include "hwy/highway.h"

#if HWY_TARGET == HWY_AVX3
HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes {

namespace hn = hwy::HWY_NAMESPACE;
using Part = hn::CappedTag<float, 16>;
using UintPart = hn::RebindToUnsigned<Part>;

constexpr int kLanes = static_cast<int>(hn::MaxLanes(Part()));

using Vec = hn::Vec<Part>;
using UintVec = hn::Vec<UintPart>;
using Mask = hn::Mask<Part>;

using hn::Abs;
using hn::Add;
using hn::And;
using hn::AndNot;
using hn::Clamp;
using hn::Div;
using hn::Eq;
using hn::Ge;
using hn::Gt;
using hn::IfThenElse;
using hn::IfThenElseZero;
using hn::Le;
using hn::Lt;
using hn::Max;
using hn::Min;
using hn::Mul;
using hn::MulAdd;
using hn::MulSub;
using hn::Neg;
using hn::NegMulAdd;
using hn::Not;
using hn::Or;
using hn::Sqrt;
using hn::Sub;
using hn::Xor;

HWY_INLINE Vec
set(float value)
{
  return hn::Set(Part(), value);
}

HWY_INLINE UintVec
setUint(std::uint32_t value)
{
  return hn::Set(UintPart(), value);
}

/** \param[in] values aligned. */
HWY_INLINE Vec
load(const float* values)
{
  return hn::Load(Part(), values);
}

HWY_INLINE void
store(Vec v, float* values)
{
  hn::Store(v, Part(), values);
}

HWY_INLINE void
store(UintVec v, std::uint32_t* values)
{
  hn::Store(v, UintPart(), values);
}

HWY_INLINE UintVec
IfThenElse(Mask m, UintVec yes, UintVec no)
{
  return hn::IfThenElse(hn::RebindMask(UintPart(), m), yes, no);
}

HWY_INLINE bool
AllFalse(Mask m)
{
  return hn::AllFalse(Part(), m);
}

HWY_INLINE bool
AllTrue(Mask m)
{
  return hn::AllTrue(Part(), m);
}

HWY_INLINE std::size_t
CountTrue(Mask m)
{
  return hn::CountTrue(Part(), m);
}

/** The smallest lane. */
HWY_INLINE float
smallest(Vec v)
{
  return hn::GetLane(hn::MinOfLanes(Part(), v));
}

/** The first lane. */
HWY_INLINE float
firstLane(Vec v)
{
  return hn::GetLane(v);
}

/** Stores a[0], b[0], a[1], b[1], ... \param[out] values aligned. */
HWY_INLINE void
storeInterleaved(Vec a, Vec b, float* values)
{
  hn::StoreInterleaved2(a, b, Part(), values);
}

/** Stores a[0], b[0], c[0], a[1], ... \param[out] values aligned. */
HWY_INLINE void
storeInterleaved(Vec a, Vec b, Vec c, float* values)
{
  hn::StoreInterleaved3(a, b, c, Part(), values);
}

/** What a function of vectors of Highway's makes of each part of some. */
template <typename Function, typename... Vectors>
HWY_INLINE Vec
byParts(const Function& function, Vectors... vectors)
{
  return function(vectors...);
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE::lanes
HWY_AFTER_NAMESPACE();
#endif
#endif
