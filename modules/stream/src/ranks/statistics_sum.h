// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pcl_slim/fit/fit.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Sums what the fits of tiles did. Measured noise and normals stay as they are. */
class StatisticsSum {
 public:
  /** \brief Adds a tile's. O(surfels). */
  void add(const FitStatistics& tile, const SLIMSurface& surface);
  FitStatistics& sum() { return sum_; }
  const FitStatistics& sum() const { return sum_; }

 private:
  FitStatistics sum_;
  double weight_ = 0, square_ = 0;  ///< of the residuals
  bool any_ = false;
};

/** \brief A tile's counts as numbers, to be kept beside its surfels. */
std::vector<double>
packedStatistics(const FitStatistics& tile);

/** \brief The inverse, with leaves_per_level counted on the surfels. */
FitStatistics
unpackedStatistics(const std::vector<double>& numbers, const SLIMSurface& surface);

/** \brief Length of packedStatistics(). */
std::size_t
numPackedStatistics();

}  // namespace pcl_slim::detail
