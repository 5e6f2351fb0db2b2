// SPDX-License-Identifier: BSD-3-Clause
// What a fit learns of a cloud before it covers it: its noise, the error of its normals, its sides.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "fit_constants.h"
#include "fit_plan.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/error.h"

namespace pcl_slim::detail {

/** \brief A cloud's errors as given by the user or measured: lambda, the noise profile, the normal
 * bound and what normals weigh as data. \return an error where normals are to be data and there are
 * none. */
Result<CloudMeasures> measureCloud(const PointStore& store, const FitParams& params,
                                   const FitConstants& constants, int threads,
                                   FitStatistics& stats);

/** \brief Whether normals are measured apart from the points (docs/theory.md, "Normals as data").
 */
struct NormalErrorConstants {
  std::size_t samples = 1000;       ///< patches looked at
  std::size_t least_patches = 100;  ///< patches that a result takes
  std::size_t neighbors = 64;     ///< points of a patch: wider than most estimates of normals reach
  std::size_t least_points = 48;  ///< points of a patch on the sample's own side
  std::size_t tilt_points = 9;    ///< the sample and its nearest, for the tilt of heights
  std::size_t pairs = 4;          ///< nearest neighbours that the sample is paired with
  float own_side = 0.3f;          ///< least cosine with the sample's normal
  double least_cosine = 0.1;      ///< least cosine that a slope is read from
  double trim = 0.1;              ///< share of patches left out at either end of the mean
  double with_heights = 0.15;     ///< correlation with the points' tilt from which it repeats them
  double with_neighbors = 0.03;   ///< correlation with neighbours from which they repeat them
};

/** \brief The error of normals, and whether they add information to the points' places. */
struct NormalError {
  double radians = 0;         ///< RMS angle to a smooth surface through the neighbours' normals
  double with_heights = 0;    ///< correlation with the tilt that the points' own noise suggests
  double with_neighbors = 0;  ///< correlation between nearest neighbours

  /** \brief Normals measured apart from the points show neither correlation. Those computed from
   * noisy points, or from a mesh over them, follow the points' noise and share it with their
   * neighbours: they would be counted twice. */
  bool independent(const NormalErrorConstants& constants = {}) const {
    return radians > 0 && with_heights < constants.with_heights &&
           with_neighbors < constants.with_neighbors;
  }
};

/** \brief Compares normals with cubics on patches of 64 neighbours about 1000 points, evenly
 * strided; all 0 where fewer than 100 patches are usable (docs/theory.md, "Normals as data").
 * O(patches log points); the same for any number of threads. */
NormalError measureNormalError(const PointStore& store, const NormalErrorConstants& constants,
                               int threads);

/** \brief A store that a fit may give sides: the caller's own, or a copy where that is const. */
class SidedStore {
 public:
  explicit SidedStore(PointStore& store) : store_(&store), own_(&store) { store.clearSides(); }
  explicit SidedStore(const PointStore& store) : store_(&store) {
    if (!store.hasSides() || store.hasNormals()) return;
    own().clearSides();
  }

  const PointStore& store() const { return *store_; }
  /** \brief Whether the sides are set in the caller's store itself, not in a copy. */
  bool isKept() const { return own_ != nullptr && !copy_; }
  void setSides(const std::vector<std::array<float, 3>>& normals) { own().setSides(normals); }
  /** \brief Sets sides for the cover, in whose place endCover() sets those for orientation and trim
   * maps. */
  void setSidesForCover(const std::vector<std::array<float, 3>>& normals,
                        std::vector<std::array<float, 3>> after) {
    own().setSides(normals);
    after_cover_ = std::move(after);
  }
  void endCover() {
    own().setSides(after_cover_);
    after_cover_.clear();
  }
  void moveTo(const std::vector<std::array<double, 3>>& positions, int threads) {
    own().moveTo(positions, threads);
  }
  void clearSides() {
    if (store_->hasSides() && !store_->hasNormals()) own().clearSides();
  }

 private:
  PointStore& own() {
    if (own_ == nullptr) {
      copy_ = *store_;
      store_ = own_ = &*copy_;
    }
    return *own_;
  }

  const PointStore* store_;
  PointStore* own_ = nullptr;
  std::optional<PointStore> copy_;
  std::vector<std::array<float, 3>> after_cover_;
};

/** \brief Gives the points of a cloud without normals sides where balls would meet both sides of
 * thin parts, and measures the cloud anew with them (docs/theory.md, "Sides before the cover"). The
 * store and the measures stay as they are elsewhere.
 * \param[in,out] measures those made without sides */
Error giveSides(const FitConstants& constants, const FitParams& params, SidedStore& sided,
                CloudMeasures& measures, FitStatistics& stats);

}  // namespace pcl_slim::detail
