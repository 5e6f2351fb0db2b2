// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/order_statistics.h"
#include "pcl_slim/core/parallel.h"

namespace pcl_slim::detail {

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

/** \brief Places of a store, among points thinned step by step: wide patches are measured on a part of
 * their points, those of neighbouring places on different parts. What one part shows by chance, as
 * many patches contain the same points, others do not. */
class ThinnedPlaces {
 public:
  ThinnedPlaces(const PointStore& store, std::size_t count);

  /** \brief Thins to every stride-th point; a power of two, no less than before. O(n). */
  void thinTo(std::size_t stride, int threads);

  std::size_t size() const { return places_.size(); }
  /** \brief The places' points, each a number within the part of its place. */
  const std::vector<std::size_t>& places() const { return places_; }

  /** \brief Calls measure(store, search, place, s) at every place s: its stored point, and the points that
   * are left around it. */
  template <typename Measure>
  void forEach(int threads, const Measure& measure) const
  {
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

  const PointStore& storeOf(std::size_t part) const
  {
    return parts_.empty() ? whole_ : parts_[part];
  }

  const PointStore& whole_;
  std::vector<PointStore> parts_;  ///< of place s the part s modulo their number; none: the whole
  std::vector<std::size_t> places_;
  std::size_t stride_ = 1;
};

/** \brief Measures patches of k points. O(places) in addition to thinning. \param[in] narrower a scale of the
 * same places, whose radii speed this one up */
PatchScale
measureScale(ThinnedPlaces& points, std::size_t k, const NoiseConstants& constants, int threads,
             const PatchScale* narrower = nullptr);

/** \brief The same at evenly strided places of a store. */
PatchScale
measureScale(const PointStore& store, std::size_t k, const NoiseConstants& constants, int threads);

/** \brief Mean variance of a scale without its largest and smallest, with what patches' ends cut off. */
double
levelOf(const PatchScale& scale, const NoiseConstants& constants);

/** \brief Number of points that share their errors, by a scale. 1: none do. */
double
correlationOf(const PatchScale& scale, const NoiseConstants& constants);

}  // namespace pcl_slim::detail
