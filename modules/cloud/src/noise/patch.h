// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Eigenvalues>

#include "noise/patch_kernels.h"
#include "pcl_slim/cloud/detail/noise_constants.h"

namespace pcl_slim::detail {

/** \brief Some neighbours of a point. */
struct Patch {
  PatchPoints points;  ///< relative to the sample
  double radius = 0;
};

/** \brief Eigenvalues, ascending, and eigenvectors of points' covariance. */
Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>
principalAxes(const PatchPoints& points);

/** \brief Drops points of another sheet than the sample's: where a gap parts the patch's heights
 * more than either side spreads, keeps the sample's side. \return true if it dropped points. */
bool
keepOwnSheet(const PatchSheetConstants& constants, Patch& patch);

}  // namespace pcl_slim::detail
