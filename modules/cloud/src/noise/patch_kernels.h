// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

constexpr int kCubicTerms = 10;      ///< coefficients of a cubic in two variables
constexpr int kCubicMoments = 28;    ///< monomials of twice its degree
constexpr std::size_t kPadding = 8;  ///< columns end with room for a whole vector

/** \brief Points, or other triples, as three columns. */
class PatchPoints {
 public:
  void resize(std::size_t count)
  {
    count_ = count;
    for (auto& column : columns_) column.resize(count + kPadding);
  }
  /** \brief Drops all but the first. */
  void cut(std::size_t count) { count_ = count; }

  std::size_t size() const { return count_; }
  double* operator[](std::size_t axis) { return columns_[axis].data(); }
  const double* operator[](std::size_t axis) const { return columns_[axis].data(); }

  Eigen::Vector3d at(std::size_t i) const
  {
    return {columns_[0][i], columns_[1][i], columns_[2][i]};
  }
  void set(std::size_t i, const Eigen::Vector3d& point)
  {
    for (std::size_t a = 0; a < 3; ++a) columns_[a][i] = point[static_cast<Eigen::Index>(a)];
  }

 private:
  std::array<AlignedVector<double>, 3> columns_;
  std::size_t count_ = 0;
};

/** \brief Sums over points and over their products xx, xy, xz, yy, yz, zz. */
struct PatchSums {
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/** \brief Sums of the normal equations of a cubic height field, terms in graded order. */
struct CubicSums {
  std::array<double, kCubicMoments> moments;
  std::array<double, kCubicTerms> heights;  ///< of the heights times each term
};

/** \brief The gap of heights about a middle value. */
struct HeightGap {
  double lowest, highest;
  double end_below, begin_above;  ///< the heights next to the middle on either side
  std::size_t above;
};

/** \brief SIMD inner loops of the noise estimate, compiled per instruction set and chosen at run time. */
namespace kernels {

PatchSums
sumPatch(const PatchPoints& points);

/** \brief Coordinates along the columns of a matrix. */
void
turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned);

/** \brief Sums of first coordinates as heights over the third and second. */
CubicSums
sumCubic(const PatchPoints& places);

/** \brief The residuals of heights after a cubic. \param[out] residuals with room for kPadding more
 * \return their sum of squares. */
double
cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms], double* residuals);

/** \brief Heights along a direction. \param[out] heights with room for kPadding more */
void
heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights);

/** \brief Number and sum of the points above a height. */
std::size_t
sumAbove(const PatchPoints& points, const double* heights, double middle, Eigen::Vector3d& sum);

HeightGap
gapAbout(const double* heights, std::size_t count, double middle);

}  // namespace kernels
}  // namespace pcl_slim::detail
