// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "noise/patch_noise.h"

namespace pcl_slim::detail {

/** \brief How much neighbouring residuals of a patch have in common: the sum of products over all pairs
 * of points in a cell, over the sum of squares. The patch's disc is cut into square cells.
 * 1 for white noise; < 0: nothing is known. */
double
sharedInPatch(const PatchCubic& cubic, double cells);

/** \brief tau of errors that are averages over squares: the number of points in a square.
 * \param[in] shared sharedInPatch() of cells \param[in] points of a cell */
double
squareThatShares(double shared, double points);

}  // namespace pcl_slim::detail
