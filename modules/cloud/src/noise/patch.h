// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

constexpr int kCubicTerms = 10;      ///< coefficients of a cubic in two variables
constexpr int kCubicMoments = 28;    ///< monomials of twice its degree
constexpr std::size_t kPadding = 8;  ///< columns end with room for a whole vector

/** \brief Points, or other triples, as three columns. */
class PatchPoints {
 public:
  void resize(std::size_t count) {
    count_ = count;
    for (auto& column : columns_) column.resize(count + kPadding);
  }
  /** \brief Drops all but the first. */
  void cut(std::size_t count) { count_ = count; }

  std::size_t size() const { return count_; }
  double* operator[](std::size_t axis) { return columns_[axis].data(); }
  const double* operator[](std::size_t axis) const { return columns_[axis].data(); }

  Eigen::Vector3d at(std::size_t i) const {
    return {columns_[0][i], columns_[1][i], columns_[2][i]};
  }
  void set(std::size_t i, const Eigen::Vector3d& point) {
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

/** \brief SIMD inner loops of the noise estimate, compiled per instruction set and chosen at run
 * time. */
namespace kernels {

PatchSums sumPatch(const PatchPoints& points);

/** \brief Coordinates along the columns of a matrix. */
void turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned);

/** \brief Sums of first coordinates as heights over the third and second. */
CubicSums sumCubic(const PatchPoints& places);

/** \brief The residuals of heights after a cubic. \param[out] residuals with room for kPadding more
 * \return their sum of squares. */
double cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms],
                      double* residuals);

/** \brief Heights along a direction. \param[out] heights with room for kPadding more */
void heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights);

/** \brief Number and sum of the points above a height. */
std::size_t sumAbove(const PatchPoints& points, const double* heights, double middle,
                     Eigen::Vector3d& sum);

HeightGap gapAbout(const double* heights, std::size_t count, double middle);

}  // namespace kernels

/** \brief Some neighbours of a point. */
struct Patch {
  PatchPoints points;  ///< relative to the sample
  double radius = 0;
};

/** \brief Eigenvalues, ascending, and eigenvectors of points' covariance. */
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principalAxes(const PatchPoints& points);

/** \brief Drops points of another sheet than the sample's: where a gap parts the patch's heights
 * more than either side spreads, keeps the sample's side. \return true if it dropped points. */
bool keepOwnSheet(const PatchSheetConstants& constants, Patch& patch);

/** \brief The k points of a search nearest to a sample; where the store has normals, those whose
 * normal is opposed to the sample's are left out. \param[in] about as in
 * NeighborSearch::nearestSet() */
void patchAbout(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
                Patch& patch, double about = 0);

/** \brief A squared radius that probably contains factor times the points of a patch, on a surface.
 */
inline double probableSquare(double radius, double factor) {
  constexpr double kMargin = 1.4;
  return kMargin * factor * radius * radius;
}

/** \brief A cubic height field over a patch's two main axes, in units of the patch's radius. */
struct PatchCubic {
  PatchPoints places;  ///< of the points: along the normal and the two axes, lesser first
  AlignedVector<double> residuals;  ///< of the heights; kPadding more than places
  double variance = 0;  ///< of the residuals per degree of freedom, squared local lengths
};

/** \brief Fits a cubic to a patch by least squares. \return false where there are too few points.
 */
bool fitCubic(const Patch& patch, PatchCubic& cubic);

/** \brief The variance of isotropic noise whose residuals a patch shows. A patch is a ball about
 * one of its points and cuts heights off: of a plane's noise s a radius R >= 2.2 s leaves s^2 (1 -
 * 2 q - 22 q^2), with q the residuals' variance over R^2, to one per cent of s (docs/theory.md,
 * "Noise"). */
double uncutVariance(double variance, double radius);

/** \brief The same of many places along the Morton curve, with the mean of q about each.
 * \param[in,out] variances < 0: not known */
void putBackCutOff(const std::vector<double>& radii, const NoiseConstants& constants, int threads,
                   std::vector<double>& variances);

/** \brief The stride of the points looked at for patches of k points. */
inline std::size_t patchStride(std::size_t k, const NoiseConstants& constants) {
  return std::max<std::size_t>(1, k / constants.patch_points);
}

/** \brief Residual variance of a cubic on the patch of k points about a sample, on the sample's own
 * sheet where two run through it, in squared local lengths; < 0: too few points. \param[in] search
 * over every patchStride(k)-th point \param[out] radius of the patch */
double patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample,
                     std::size_t k, const NoiseConstants& constants, double& radius);

/** \brief The points of the smallest patches: first_neighbors, doubled until half of them are no
 * lines. Where rings of a turning lidar are many spacings apart, no noise shows along one of them.
 */
std::size_t smallestPatch(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief Mean of the values that are not negative, without a share of the largest and as many of
 * the smallest; 0 of none. Sorts them. */
double trimmedMean(std::vector<double>& values, double trim);

/** \brief Relative standard error of that mean, by the values' winsorized variance (Tukey and
 * McLaughlin 1963); 0 of fewer than two. */
double trimmedMeanError(std::vector<double> values, double trim);

/** \brief Trimmed means over windows about each of the values, which are in Morton order. */
std::vector<float> windowedMeans(const std::vector<double>& values, const NoiseConstants& constants,
                                 int threads);

/** \brief Whether a variance grows no more from k to 2 k neighbours than white noise's may. */
inline bool isFlat(double narrow, double wider, const NoiseConstants& constants) {
  return wider <= std::exp2(constants.shared.chance) * narrow;
}

/** \brief Calls measure(search, sample, s) at evenly strided points, s counting them. */
template <typename Measure>
std::vector<double> sampleStore(const PointStore& store, std::size_t samples, std::size_t stride,
                                int threads, const Measure& measure) {
  samples = std::min(samples, store.size());
  std::vector<double> values(samples);
  std::vector<NeighborSearch> searches(static_cast<std::size_t>(threads),
                                       NeighborSearch(store, stride));
  parallelFor(samples, threads, 4, [&](std::size_t s, int thread) {
    const std::size_t sample = (2 * s + 1) * store.size() / (2 * samples);
    values[s] = measure(searches[static_cast<std::size_t>(thread)], sample, s);
  });
  return values;
}

/** \brief The residuals of cubics on patches of k points, place by place. */
struct PatchScale {
  std::size_t k = 0;
  std::size_t stride = 1;         ///< every stride-th of a patch's points is looked at
  std::vector<double> variances;  ///< squared local lengths; < 0: too few points
  std::vector<double> shared;     ///< sharedInPatch(); < 0: not known
  std::vector<double> radii;

  /** \brief Variance at a place times the number of points that share it there. */
  double power(std::size_t place) const;
};

/** \brief Places of a store, among points thinned step by step: wide patches are measured on a part
 * of their points, those of neighbouring places on different parts. What one part shows by chance,
 * as many patches contain the same points, others do not. */
class ThinnedPlaces {
 public:
  ThinnedPlaces(const PointStore& store, std::size_t count);

  /** \brief Thins to every stride-th point; a power of two, no less than before. O(n). */
  void thinTo(std::size_t stride, int threads);

  std::size_t size() const { return places_.size(); }
  /** \brief The places' points, each a number within the part of its place. */
  const std::vector<std::size_t>& places() const { return places_; }

  /** \brief Calls measure(store, search, place, s) at every place s: its stored point, and the
   * points that are left around it. */
  template <typename Measure>
  void forEach(int threads, const Measure& measure) const {
    const std::size_t parts = parts_.empty() ? 1 : parts_.size();
    std::vector<NeighborSearch> searches;
    for (std::size_t i = 0; i < parts * static_cast<std::size_t>(threads); ++i)
      searches.emplace_back(storeOf(i % parts));
    parallelFor(places_.size(), threads, 4, [&](std::size_t s, int thread) {
      const std::size_t part = s % parts;
      measure(storeOf(part), searches[static_cast<std::size_t>(thread) * parts + part], places_[s],
              s);
    });
  }

 private:
  static constexpr std::size_t kFirst = 4;  ///< up to this stride there is one part, for speed
  static constexpr std::size_t kParts = 32;

  const PointStore& storeOf(std::size_t part) const {
    return parts_.empty() ? whole_ : parts_[part];
  }

  const PointStore& whole_;
  std::vector<PointStore> parts_;  ///< of place s the part s modulo their number; none: the whole
  std::vector<std::size_t> places_;
  std::size_t stride_ = 1;
};

/** \brief Measures patches of k points. O(places) in addition to thinning. \param[in] narrower a
 * scale of the same places, whose radii speed this one up */
PatchScale measureScale(ThinnedPlaces& points, std::size_t k, const NoiseConstants& constants,
                        int threads, const PatchScale* narrower = nullptr);

/** \brief The same at evenly strided places of a store. */
PatchScale measureScale(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                        int threads);

/** \brief Mean variance of a scale without its largest and smallest, with what patches' ends cut
 * off. */
double levelOf(const PatchScale& scale, const NoiseConstants& constants);

/** \brief Number of points that share their errors, by a scale. 1: none do. */
double correlationOf(const PatchScale& scale, const NoiseConstants& constants);

}  // namespace pcl_slim::detail
