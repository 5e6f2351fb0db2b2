// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/detail/noise_constants.h"
#include "pcl_slim/cloud/detail/side_constants.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Which points get sides. */
enum class SideScope {
  kAll,
  kFacing,  ///< those near another sheet that faces the other way, where near cells agree
};

/** \brief A unit normal of common side for every stored point; 0: it gets none. */
struct Sides {
  std::vector<std::array<float, 3>> normals;
  std::vector<char> on_rods;  ///< 1: a stored point's normal is away from a rod's axis
  std::vector<std::array<float, 3>> outward;  ///< of kFacing, the same for every point ...
  double outward_confidence = 0;              ///< ... and the agreement of all neighbouring cells
  std::size_t cells = 0;                      ///< that share a normal
  double thin = 0;        ///< share of the points that face apart from others behind them
  double gap = HUGE_VAL;  ///< median distance of two such sheets, local length
  double confidence = 0;  ///< agreement of neighbouring cells: 1 if all agree, 0 as chance
  double sure = 1;        ///< share of the places between sheets that are in sure parts
};

/** \brief Finds sides of a cloud without normals: normals of cells from the moments of the cells about
 * them, signs by greedy contraction of the graph of cells or, where points have sensors, by these.
 * O(n log n); same result for any number of threads. \param[in] noise RMS distance of points from the surface, local length
 * \param[in] spacing distance of neighbouring points, local length */
PCL_SLIM_EXPORT Sides
findSides(const PointStore& store, double noise, double spacing, SideScope scope,
          const SideConstants& constants, int threads);

/** \brief Where balls would meet two sides. */
struct ThinPlaces {
  double share = 0;    ///< of the places looked at
  double flat = 0;     ///< of these, where only the residuals' kurtosis shows two sheets
  double facing = 0;   ///< share of the others where a sheet faces one that a patch fits
  double near = 0;     ///< share of those where sheets are near, and far for their noise
  double noise = 0;    ///< RMS residual of cubics at places that are not thin; 0: too few are
  double spacing = 0;  ///< of the points, the median, local length
  std::vector<std::size_t> thin;  ///< stored points at places of any of the three kinds
};

/** \brief Looks at places spread over a cloud. A place is thin if its points form two sheets, or if
 * noise fills its patches until the surface bends away: cubics leave more than a share of the
 * radius however wide they are. It is thin, too, if a cubic fits, but its residuals are flatter than Gaussian ones
 * (excess kurtosis): two sheets within one noise. Where points have sensors, a place seen from either side of its patch is
 * thin, and one seen from about one direction is not. O(places k). */
PCL_SLIM_EXPORT ThinPlaces
findThinPlaces(const PointStore& store, const SideConstants& constants, const NoiseConstants& noise,
               int threads);

}  // namespace pcl_slim::detail
