// SPDX-License-Identifier: BSD-3-Clause
#include "noise/patch.h"

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

HWY_INLINE double sumOf(Wide v) {
  return GetLane(SumOfLanes(Doubles(), v));
}

/** Calls body(index of the first lane, mask of the lanes before the end) for every group of lanes.
 */
template <typename Body>
HWY_INLINE void forGroups(std::size_t count, const Body& body) {
  const Doubles d;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d))
    body(i, FirstN(d, std::min(hn::Lanes(d), count - i)));
}

PatchSums sumPatch(const PatchPoints& points) {
  const Doubles d;
  Wide first[3], second[6];
  for (auto& sum : first) sum = Zero(d);
  for (auto& sum : second) sum = Zero(d);
  forGroups(points.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    Wide p[3];
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = IfThenElseZero(inside, Load(d, points[a] + i));
      first[a] += p[a];
    }
    for (int a = 0, k = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b, ++k) second[k] = MulAdd(p[a], p[b], second[k]);
    }
  });
  PatchSums sums;
  for (int a = 0, k = 0; a < 3; ++a) {
    sums.first[a] = sumOf(first[a]);
    for (int b = a; b < 3; ++b, ++k) sums.second(a, b) = sums.second(b, a) = sumOf(second[k]);
  }
  return sums;
}

void heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights) {
  const Doubles d;
  const auto x = Set(d, direction[0]), y = Set(d, direction[1]), z = Set(d, direction[2]);
  for (std::size_t i = 0; i < points.size(); i += hn::Lanes(d)) {
    const auto yz = MulAdd(y, Load(d, points[1] + i), z * Load(d, points[2] + i));
    StoreU(MulAdd(x, Load(d, points[0] + i), yz), d, heights + i);
  }
}

void turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned) {
  turned.resize(points.size());
  for (std::size_t a = 0; a < 3; ++a)
    heightsAlong(points, axes.col(static_cast<Eigen::Index>(a)), turned[a]);
}

CubicSums sumCubic(const PatchPoints& places) {
  const Doubles d;
  Wide moments[kCubicMoments], heights[kCubicTerms];
  for (auto& sum : moments) sum = Zero(d);
  for (auto& sum : heights) sum = Zero(d);
  forGroups(places.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto u = IfThenElseZero(inside, Load(d, places[2] + i));
    const auto v = IfThenElseZero(inside, Load(d, places[1] + i));
    const auto h = IfThenElseZero(inside, Load(d, places[0] + i));
    addGradedTerms<6>(IfThenElseZero(inside, Set(d, 1.0)), u, v, moments);
    addGradedTerms<3>(h, u, v, heights);
  });
  CubicSums sums;
  for (std::size_t k = 0; k < kCubicMoments; ++k) sums.moments[k] = sumOf(moments[k]);
  for (std::size_t k = 0; k < kCubicTerms; ++k) sums.heights[k] = sumOf(heights[k]);
  return sums;
}

double cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms],
                      double* residuals) {
  const Doubles d;
  Wide c[kCubicTerms], squares = Zero(d);
  for (int k = 0; k < kCubicTerms; ++k) c[k] = Set(d, terms[k]);
  forGroups(places.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto u = Load(d, places[2] + i), v = Load(d, places[1] + i);
    const auto cubic = MulAdd(MulAdd(MulAdd(c[9], v, c[5]), v, c[2]), v, c[0]);
    const auto square = MulAdd(MulAdd(c[8], v, c[4]), v, c[1]);
    const auto line = MulAdd(MulAdd(c[6], u, MulAdd(c[7], v, c[3])), u, square);
    const auto height = MulAdd(line, u, cubic);
    const auto residual = IfThenElseZero(inside, Load(d, places[0] + i) - height);
    squares = MulAdd(residual, residual, squares);
    StoreU(residual, d, residuals + i);
  });
  return sumOf(squares);
}

std::size_t sumAbove(const PatchPoints& points, const double* heights, double middle,
                     Eigen::Vector3d& sum) {
  const Doubles d;
  Wide sums[3] = {Zero(d), Zero(d), Zero(d)};
  std::size_t count = 0;
  forGroups(points.size(), [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto above = And(inside, LoadU(d, heights + i) > Set(d, middle));
    count += CountTrue(d, above);
    for (std::size_t a = 0; a < 3; ++a) sums[a] += IfThenElseZero(above, Load(d, points[a] + i));
  });
  sum = {sumOf(sums[0]), sumOf(sums[1]), sumOf(sums[2])};
  return count;
}

HeightGap gapAbout(const double* heights, std::size_t count, double middle) {
  const Doubles d;
  const auto none = Set(d, std::numeric_limits<double>::max());
  Wide lowest = none, begin_above = none, highest = Neg(none), end_below = Neg(none);
  std::size_t above = 0;
  forGroups(count, [&](std::size_t i, hn::Mask<Doubles> inside) HWY_ATTR {
    const auto h = LoadU(d, heights + i);
    const auto over = And(inside, h > Set(d, middle));
    const auto under = AndNot(over, inside);
    above += CountTrue(d, over);
    lowest = Min(lowest, IfThenElse(inside, h, none));
    highest = Max(highest, IfThenElse(inside, h, Neg(none)));
    begin_above = Min(begin_above, IfThenElse(over, h, none));
    end_below = Max(end_below, IfThenElse(under, h, Neg(none)));
  });
  return {GetLane(MinOfLanes(d, lowest)), GetLane(MaxOfLanes(d, highest)),
          GetLane(MaxOfLanes(d, end_below)), GetLane(MinOfLanes(d, begin_above)), above};
}

}  // namespace pcl_slim::detail::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_slim::detail::kernels {

HWY_EXPORT(sumPatch);
PatchSums sumPatch(const PatchPoints& points) {
  return HWY_DYNAMIC_DISPATCH(sumPatch)(points);
}

HWY_EXPORT(turnPatch);
void turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned) {
  HWY_DYNAMIC_DISPATCH(turnPatch)(points, axes, turned);
}

HWY_EXPORT(sumCubic);
CubicSums sumCubic(const PatchPoints& places) {
  return HWY_DYNAMIC_DISPATCH(sumCubic)(places);
}

HWY_EXPORT(cubicResiduals);
double cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms],
                      double* residuals) {
  return HWY_DYNAMIC_DISPATCH(cubicResiduals)(places, terms, residuals);
}

HWY_EXPORT(heightsAlong);
void heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights) {
  HWY_DYNAMIC_DISPATCH(heightsAlong)(points, direction, heights);
}

HWY_EXPORT(sumAbove);
std::size_t sumAbove(const PatchPoints& points, const double* heights, double middle,
                     Eigen::Vector3d& sum) {
  return HWY_DYNAMIC_DISPATCH(sumAbove)(points, heights, middle, sum);
}

HWY_EXPORT(gapAbout);
HeightGap gapAbout(const double* heights, std::size_t count, double middle) {
  return HWY_DYNAMIC_DISPATCH(gapAbout)(heights, count, middle);
}

}  // namespace pcl_slim::detail::kernels
#endif
