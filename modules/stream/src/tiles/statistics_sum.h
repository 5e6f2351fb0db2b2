// SPDX-License-Identifier: BSD-3-Clause
#pragma once

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

}  // namespace pcl_slim::detail
