// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/knn.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief The neighbours of one point after another, for decisions about outliers. */
class Neighborhood {
 public:
  explicit Neighborhood(const PointStore& store) : store_(store), search_(store) {}

  /** \brief Finds the nearest others of a stored point, nearest first.
   * \param[in] left_out one byte a stored point: those not to be taken; null: none.
   * \param[in] among how many neighbours are looked through for them. \return how many were found. */
  std::size_t find(std::size_t point, std::size_t count, const unsigned char* left_out,
                   std::size_t among);

  /** \brief Whether a stored point surely has so many others within a distance: much cheaper than to
   * find them. false where rounding leaves a doubt. */
  bool hasOthersWithin(double distance, std::size_t point, std::size_t count,
                       const unsigned char* left_out = nullptr);

  /** \brief Distance of the n-th other, n from 1 on; infinite where there are fewer. */
  double distance(std::size_t n) const;

  /** \brief Whether the point and its neighbours fill a volume, as those of no surface or line do:
   * least over greatest eigenvalue of their covariance. */
  bool fillsVolume(double least_ratio) const;

  /** \brief Whether most neighbours are a patch that is far denser than the point's surroundings, and the
   * point is outside of it, off its plane or line.
   * \param[in] closeness half of the neighbours have others within the eighth's distance over this.
   * \param[in] spreads least distance from the patch's mean, over its RMS distance from it.
   * \param[in] off least share of it that points away from plane or line. */
  bool standsApart(double closeness, double spreads, double off) const;

  /** \brief Whether the point stands off its neighbours' plane: more than so many times their own RMS
   * distance from it, and a given share of its distance from their mean and from the eighth. */
  bool standsOffPlane(double heights, double share) const;

 private:
  PatchPoints densePatch(double distance) const;

  const PointStore& store_;
  NeighborSearch search_;
  std::vector<std::uint32_t> found_;
  std::vector<std::uint32_t> blocks_;  ///< those of hasOthersWithin(), and what it finds in them
  AlignedVector<float> within_sq_;
  AlignedVector<std::uint32_t> within_;
  std::vector<float> distances_sq_;
  PatchPoints others_;  ///< relative to the point
  std::vector<double> distances_;
};

}  // namespace pcl_slim::detail
