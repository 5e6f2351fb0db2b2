// SPDX-License-Identifier: BSD-3-Clause
#include "noise/patch_kernels.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "noise/patch_kernels.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#include "pcl_slim/core/detail/graded_terms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_slim::detail::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::CappedTag<double, kPadding>;
using Wide = hn::Vec<Doubles>;

HWY_INLINE double
sumOf(Wide v)
{
  return hn::GetLane(hn::SumOfLanes(Doubles(), v));
}

/** Calls body(first index, mask of those before the end) for every group of lanes. */
template <typename Body>
HWY_INLINE void
forGroups(std::size_t count, const Body& body)
{
  const Doubles d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d))
    body(i, hn::FirstN(d, std::min(hn::Lanes(d), count - i)));
}

PatchSums
sumPatch(const PatchPoints& points)
{
  const Doubles d;
  Wide first[3], second[6];
  for (auto& sum : first) sum = hn::Zero(d);
  for (auto& sum : second) sum = hn::Zero(d);
  forGroups(points.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    Wide p[3];
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = hn::IfThenElseZero(inside, hn::Load(d, points[a] + i));
      first[a] = hn::Add(first[a], p[a]);
    }
    for (int a = 0, k = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b, ++k) second[k] = hn::MulAdd(p[a], p[b], second[k]);
    }
  });
  PatchSums sums;
  for (int a = 0, k = 0; a < 3; ++a) {
    sums.first[a] = sumOf(first[a]);
    for (int b = a; b < 3; ++b, ++k) sums.second(a, b) = sums.second(b, a) = sumOf(second[k]);
  }
  return sums;
}

void
heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights)
{
  const Doubles d;
  const auto x = hn::Set(d, direction[0]), y = hn::Set(d, direction[1]),
             z = hn::Set(d, direction[2]);
  for (std::size_t i = 0; i < points.size(); i += hn::Lanes(d)) {
    const auto yz =
        hn::MulAdd(y, hn::Load(d, points[1] + i), hn::Mul(z, hn::Load(d, points[2] + i)));
    hn::StoreU(hn::MulAdd(x, hn::Load(d, points[0] + i), yz), d, heights + i);
  }
}

void
turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned)
{
  turned.resize(points.size());
  for (std::size_t a = 0; a < 3; ++a)
    heightsAlong(points, axes.col(static_cast<Eigen::Index>(a)), turned[a]);
}

CubicSums
sumCubic(const PatchPoints& places)
{
  const Doubles d;
  Wide moments[kCubicMoments], heights[kCubicTerms];
  for (auto& sum : moments) sum = hn::Zero(d);
  for (auto& sum : heights) sum = hn::Zero(d);
  forGroups(places.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto u = hn::IfThenElseZero(inside, hn::Load(d, places[2] + i));
    const auto v = hn::IfThenElseZero(inside, hn::Load(d, places[1] + i));
    const auto h = hn::IfThenElseZero(inside, hn::Load(d, places[0] + i));
    addGradedTerms<6>(hn::IfThenElseZero(inside, hn::Set(d, 1.0)), u, v, moments);
    addGradedTerms<3>(h, u, v, heights);
  });
  CubicSums sums;
  for (std::size_t k = 0; k < kCubicMoments; ++k) sums.moments[k] = sumOf(moments[k]);
  for (std::size_t k = 0; k < kCubicTerms; ++k) sums.heights[k] = sumOf(heights[k]);
  return sums;
}

double
cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms], double* residuals)
{
  const Doubles d;
  Wide c[kCubicTerms], squares = hn::Zero(d);
  for (int k = 0; k < kCubicTerms; ++k) c[k] = hn::Set(d, terms[k]);
  forGroups(places.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto u = hn::Load(d, places[2] + i), v = hn::Load(d, places[1] + i);
    const auto cubic = hn::MulAdd(hn::MulAdd(hn::MulAdd(c[9], v, c[5]), v, c[2]), v, c[0]);
    const auto square = hn::MulAdd(hn::MulAdd(c[8], v, c[4]), v, c[1]);
    const auto line = hn::MulAdd(hn::MulAdd(c[6], u, hn::MulAdd(c[7], v, c[3])), u, square);
    const auto height = hn::MulAdd(line, u, cubic);
    const auto residual = hn::IfThenElseZero(inside, hn::Sub(hn::Load(d, places[0] + i), height));
    squares = hn::MulAdd(residual, residual, squares);
    hn::StoreU(residual, d, residuals + i);
  });
  return sumOf(squares);
}

std::size_t
sumAbove(const PatchPoints& points, const double* heights, double middle, Eigen::Vector3d& sum)
{
  const Doubles d;
  Wide sums[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  std::size_t count = 0;
  forGroups(points.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto above = hn::And(inside, hn::Gt(hn::LoadU(d, heights + i), hn::Set(d, middle)));
    count += hn::CountTrue(d, above);
    for (std::size_t a = 0; a < 3; ++a)
      sums[a] = hn::Add(sums[a], hn::IfThenElseZero(above, hn::Load(d, points[a] + i)));
  });
  sum = {sumOf(sums[0]), sumOf(sums[1]), sumOf(sums[2])};
  return count;
}

HeightGap
gapAbout(const double* heights, std::size_t count, double middle)
{
  const Doubles d;
  const auto none = hn::Set(d, std::numeric_limits<double>::max());
  Wide lowest = none, begin_above = none, highest = hn::Neg(none), end_below = hn::Neg(none);
  std::size_t above = 0;
  forGroups(count, [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto h = hn::LoadU(d, heights + i);
    const auto over = hn::And(inside, hn::Gt(h, hn::Set(d, middle)));
    const auto under = hn::AndNot(over, inside);
    above += hn::CountTrue(d, over);
    lowest = hn::Min(lowest, hn::IfThenElse(inside, h, none));
    highest = hn::Max(highest, hn::IfThenElse(inside, h, hn::Neg(none)));
    begin_above = hn::Min(begin_above, hn::IfThenElse(over, h, none));
    end_below = hn::Max(end_below, hn::IfThenElse(under, h, hn::Neg(none)));
  });
  return {hn::GetLane(hn::MinOfLanes(d, lowest)), hn::GetLane(hn::MaxOfLanes(d, highest)),
          hn::GetLane(hn::MaxOfLanes(d, end_below)), hn::GetLane(hn::MinOfLanes(d, begin_above)),
          above};
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(sumPatch);
PatchSums
sumPatch(const PatchPoints& points)
{
  return HWY_DYNAMIC_DISPATCH(sumPatch)(points);
}

HWY_EXPORT(turnPatch);
void
turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned)
{
  HWY_DYNAMIC_DISPATCH(turnPatch)(points, axes, turned);
}

HWY_EXPORT(sumCubic);
CubicSums
sumCubic(const PatchPoints& places)
{
  return HWY_DYNAMIC_DISPATCH(sumCubic)(places);
}

HWY_EXPORT(cubicResiduals);
double
cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms], double* residuals)
{
  return HWY_DYNAMIC_DISPATCH(cubicResiduals)(places, terms, residuals);
}

HWY_EXPORT(heightsAlong);
void
heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights)
{
  HWY_DYNAMIC_DISPATCH(heightsAlong)(points, direction, heights);
}

HWY_EXPORT(sumAbove);
std::size_t
sumAbove(const PatchPoints& points, const double* heights, double middle, Eigen::Vector3d& sum)
{
  return HWY_DYNAMIC_DISPATCH(sumAbove)(points, heights, middle, sum);
}

HWY_EXPORT(gapAbout);
HeightGap
gapAbout(const double* heights, std::size_t count, double middle)
{
  return HWY_DYNAMIC_DISPATCH(gapAbout)(heights, count, middle);
}

}  // namespace pcl_slim::detail::kernels
#endif
