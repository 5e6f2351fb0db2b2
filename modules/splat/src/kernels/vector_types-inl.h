// SPDX-License-Identifier: BSD-3-Clause
// Vector types of the splat kernels. The guard toggles: Highway compiles a kernel file once per
// instruction set.
#if defined(PCL_SLIM_SPLAT_VECTOR_TYPES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SLIM_SPLAT_VECTOR_TYPES_INL
#undef PCL_SLIM_SPLAT_VECTOR_TYPES_INL
#else
#define PCL_SLIM_SPLAT_VECTOR_TYPES_INL
#endif

#include <cstdint>

#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Words = hn::CappedTag<std::uint64_t, 8>;
using Doubles = hn::CappedTag<double, 8>;
using HalfFloats = hn::Rebind<float, Doubles>;  ///< floats as many as Doubles has lanes

}  // namespace pcl_slim::detail::splat_kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
