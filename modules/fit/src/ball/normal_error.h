// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fit_constants.h"
#include "pcl_slim/cloud/point_store.h"

namespace pcl_slim::detail {

/** \brief The error of normals, and whether they add information to the points' places. */
struct NormalError {
  double radians = 0;         ///< RMS angle to a smooth surface through the neighbours' normals
  double with_heights = 0;    ///< correlation with the tilt that the points' own noise suggests
  double with_neighbors = 0;  ///< correlation between nearest neighbours

  /** \brief Normals measured apart from the points show neither correlation. Those computed from
   * noisy points, or from a mesh over them, follow the points' noise and share it with their
   * neighbours: they would be counted twice. */
  bool independent(const NormalErrorConstants& constants = {}) const
  {
    return radians > 0 && with_heights < constants.with_heights &&
           with_neighbors < constants.with_neighbors;
  }
};

/** \brief Compares normals with cubics on patches of 64 neighbours about 1000 points, evenly
 * strided; all 0 where fewer than 100 patches are usable (docs/theory.md, "Normals as data").
 * O(patches log points); the same for any number of threads. */
NormalError
measureNormalError(const PointStore& store, const NormalErrorConstants& constants, int threads);

}  // namespace pcl_slim::detail
