// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

constexpr int kCubicTerms = 10;      ///< coefficients of a cubic in two variables
constexpr int kCubicMoments = 28;    ///< monomials up to twice its degree
constexpr std::size_t kPadding = 8;  ///< spare elements at the end of a column, for a whole vector

/** \brief Points or other triples, stored as three columns. */
class PatchPoints {
 public:
  void resize(std::size_t count) {
    count_ = count;
    for (auto& column : columns_) column.resize(count + kPadding);
  }
  /** \brief Keeps only the first points. */
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

/** \brief Sums of the coordinates of points and of their products. */
struct PatchSums {
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/** \brief Sums for the normal equations of a cubic height field; terms are in graded order. */
struct CubicSums {
  std::array<double, kCubicMoments> moments;
  std::array<double, kCubicTerms> heights;  ///< sums of the heights times each term
};

/** \brief The gap between heights below and above a middle value. */
struct HeightGap {
  double lowest, highest;         ///< of all heights
  double end_below, begin_above;  ///< the heights next to the middle on either side
  std::size_t above;              ///< number of heights above the middle
};

/** \brief SIMD inner loops of the noise estimate. They are compiled for each instruction set and
 * chosen at run time. */
namespace kernels {

PatchSums sumPatch(const PatchPoints& points);

/** \brief Computes the coordinates of points along the columns of a matrix. */
void turnPatch(const PatchPoints& points, const Eigen::Matrix3d& axes, PatchPoints& turned);

/** \brief Sums with the first coordinates as heights over the third and second. */
CubicSums sumCubic(const PatchPoints& places);

/** \brief Computes the residuals of heights from a cubic.
 * \param[out] residuals has room for kPadding more \return their sum of squares */
double cubicResiduals(const PatchPoints& places, const double (&terms)[kCubicTerms],
                      double* residuals);

/** \brief Computes heights along a direction. \param[out] heights has room for kPadding more */
void heightsAlong(const PatchPoints& points, const Eigen::Vector3d& direction, double* heights);

/** \brief Adds up the points above a height. \return their number */
std::size_t sumAbove(const PatchPoints& points, const double* heights, double middle,
                     Eigen::Vector3d& sum);

HeightGap gapAbout(const double* heights, std::size_t count, double middle);

}  // namespace kernels

/** \brief The nearest points of a sample, which is one of them. */
struct Patch {
  PatchPoints points;  ///< relative to the sample
  double radius = 0;   ///< distance of the farthest one [local length]
};

/** \brief Eigenvalues, ascending, and eigenvectors of the covariance of points. */
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principalAxes(const PatchPoints& points);

/** \brief Drops the points of another sheet than the sample's, if the gap between the heights of
 * two sheets is wider than the range of either. \return true if it dropped points */
bool keepOwnSheet(const PatchSheetConstants& constants, Patch& patch);

/** \brief Finds the k points of a search that are nearest to a sample. Where the store has sides,
 * points whose normal is opposed to the sample's are left out.
 * \param[in] about as in NeighborSearch::nearestSet() */
void patchAbout(const PointStore& store, NeighborSearch& search, std::size_t sample, std::size_t k,
                Patch& patch, double about = 0);

/** \brief Squared radius of a ball on a surface that probably contains factor times the points of a
 * ball of a given radius. */
inline double probableSquare(double radius, double factor) {
  constexpr double kMargin = 1.4;
  return kMargin * factor * radius * radius;
}

/** \brief A cubic height field over a patch's two main axes, in units of the patch's radius. */
struct PatchCubic {
  PatchPoints places;               ///< coordinates along the normal, the second and the main axis
  AlignedVector<double> residuals;  ///< residuals of the heights; kPadding more than places
  double variance = 0;  ///< residual variance per degree of freedom [squared local length]
};

/** \brief Fits a cubic to a patch by least squares. \return false if there are too few points */
bool fitCubic(const Patch& patch, PatchCubic& cubic);

/** \brief Variance of isotropic noise, from the residual variance of a patch. A patch is a ball
 * around one of its points and cuts large heights off: of the noise s of a plane it leaves the
 * variance s^2 (1 - 2 q - 22 q^2), where q is this variance over R^2. Exact to one per cent of s
 * for radii R >= 2.2 s (docs/noise.md, "White noise"). */
double uncutVariance(double variance, double radius);

/** \brief uncutVariance() of many places along the Morton curve, each with the mean q around it.
 * \param[in,out] variances < 0: unknown */
void restoreCutVariances(const std::vector<double>& radii, const NoiseConstants& constants,
                         int threads, std::vector<double>& variances);

/** \brief Stride of the points that are used of patches of k points. */
inline std::size_t patchStride(std::size_t k, const NoiseConstants& constants) {
  return std::max<std::size_t>(1, k / constants.patch_points);
}

/** \brief Residual variance of a cubic on the patch of k points around a sample, without the points
 * of another sheet. \return squared local length; < 0: there are too few points
 * \param[in] search contains every patchStride(k)-th point \param[out] radius of the patch */
double patchVariance(const PointStore& store, NeighborSearch& search, std::size_t sample,
                     std::size_t k, const NoiseConstants& constants, double& radius);

/** \brief Number of points of the smallest patches: first_neighbors, doubled until most patches are
 * no lines. A patch along one ring of a turning lidar, whose rings are many spacings apart, shows
 * no noise. */
std::size_t smallestPatch(const PointStore& store, const NoiseConstants& constants, int threads);

/** \brief Mean of the values that are not negative, without a share of the largest and of the
 * smallest; 0 if there are none. Sorts the values and drops negative ones. */
double trimmedMean(std::vector<double>& values, double trim);

/** \brief Relative standard error of trimmedMean(), by the winsorized variance of the values (Tukey
 * and McLaughlin 1963); 0 for fewer than two. */
double trimmedMeanError(std::vector<double> values, double trim);

/** \brief The window around a place of several in Morton order: its first place and the one after
 * its last. */
std::pair<std::size_t, std::size_t> windowAround(std::size_t place, std::size_t places);

/** \brief Trimmed means over windows around each of the values, which are in Morton order. */
std::vector<float> windowedMeans(const std::vector<double>& values, const NoiseConstants& constants,
                                 int threads);

/** \brief Whether a variance grows from k to 2 k neighbours by no more than chance allows for white
 * noise. */
inline bool isFlat(double narrow, double wider, const NoiseConstants& constants) {
  return wider <= std::exp2(constants.shared.white_growth) * narrow;
}

/** \brief Whether a variance is no more than the rounding of floats leaves. */
inline bool isRoundingOfFloats(double variance, const PointStore& store) {
  constexpr double kFloatNoise = 1e-7;  // [bulkDiagonal()]
  const double resolved = kFloatNoise * store.bulkDiagonal();
  return variance < resolved * resolved;
}

/** \brief Calls measure(search, sample, s) for evenly strided points; s is the number of the
 * sample.
 * \param[in] stride of the points in the search */
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

/** \brief Figures of patches of k points, one for each place. */
struct PatchScale {
  std::size_t k = 0;
  std::size_t stride = 1;         ///< every stride-th of a patch's points is used
  std::vector<double> variances;  ///< residual variances [squared local length]; < 0: unknown
  std::vector<double> shared;     ///< sharedInPatch(); < 0: unknown
  std::vector<double> radii;      ///< [local length]

  /** \brief Variance at a place times the correlation within cells there. */
  double power(std::size_t place) const;
};

/** \brief Places of a store whose points are thinned step by step. Wide patches are measured on a
 * part of their points, neighbouring places on different parts. Patches of one part overlap and
 * have a common chance error; those of different parts have independent ones. */
class ThinnedPlaces {
 public:
  ThinnedPlaces(const PointStore& store, std::size_t count);

  /** \brief Thins to every stride-th point. O(n). \param[in] stride a power of two, no less than
 * before */
  void thinTo(std::size_t stride, int threads);

  std::size_t size() const { return places_.size(); }
  /** \brief The points at the places, as indices within the part of each place. */
  const std::vector<std::size_t>& places() const { return places_; }

  /** \brief Calls measure(store, search, place, s) for every place s, with the part of the place
   * and the index of its point in it. */
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
  static constexpr std::size_t kOnePartStride = 4;  ///< largest stride with one part, for speed
  static constexpr std::size_t kMostParts = 32;

  const PointStore& storeOf(std::size_t part) const {
    return parts_.empty() ? whole_ : parts_[part];
  }

  const PointStore& whole_;
  /// Place s has the part s modulo their number; empty: the whole store.
  std::vector<PointStore> parts_;
  std::vector<std::size_t> places_;
  std::size_t stride_ = 1;
};

/** \brief Which of the places are measured: every step-th, or those that an earlier look left. */
struct PlaceLook {
  std::size_t step = 1;
  const PatchScale* seen = nullptr;  ///< the same scale, measured at every step-th place

  bool isFirst(std::size_t place) const { return place % step == step / 2; }
};

/** \brief Measures patches of k points. O(places) in addition to thinning.
 * \param[in] narrower a scale of the same places, whose radii speed up the search; null: none
 * \return figures of all places, those of places that nobody looked at unknown */
PatchScale measureScale(ThinnedPlaces& points, std::size_t k, const NoiseConstants& constants,
                        int threads, const PatchScale* narrower = nullptr,
                        const PlaceLook& look = {});

/** \brief Measures patches of k points at evenly strided places of a store. */
PatchScale measureScale(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                        int threads);

/** \brief Noise variance of a scale: trimmed mean, corrected for the heights that patches cut off.
 */
double levelOf(const PatchScale& scale, const NoiseConstants& constants);

/** \brief Number of entries of a noise profile: one for 128 points, 100 to 8192. */
std::size_t profileRuns(const PointStore& store, const NoiseConstants& constants);

/** \brief Number of points that share an error, measured on a scale; 1: white noise. */
double correlationOf(const PatchScale& scale, const NoiseConstants& constants);

}  // namespace pcl_slim::detail
