// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pcl_slim/cloud/detail/noise.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief How the two sides of thin parts are found before a fit (docs/theory.md, "Sides before
 * the cover"). */
struct SideConstants {
  static constexpr std::size_t kMostNeighbors = 36;

  double cell_noise = 1.5;   ///< width of a cell [sqrt(lambda)], if no less than by the spacing
  std::size_t edges = 12;    ///< nearest cells that a cell has edges to, and all on another sheet
  double apart = 4.0;        ///< distance of two sheets' means over their own deviation
  double least_side = 0.15;  ///< share of the points on the smaller of two sheets
  double flatter = 0.4;    ///< excess kurtosis, below minus this, of residuals that are two sheets
  double rod = 0.2;        ///< variance across over that along, below which a patch is a rod ...
  double thick_rod = 0.2;  ///< ... where its lesser variance across is more of the other than this
  double least_thin = 0.07;  ///< share of thin places from which sides are sought ...
  double clean_thin = 0.35;  ///< ... and where there is little noise
  double clean_noise = 0.4;  ///< noise that is little [spacings] ...
  double full_noise = 0.45;  ///< ... and that is not
  /// The same, with places where sheets face one that a patch fits. From here on noise without
  /// sides counts, and both kinds of places add to the doubts.
  double least_facing = 0.4;
  double few_thin = 0.04;  ///< share of places of all kinds from which the parts there get sides
  std::size_t probe_places = 16;    ///< a large cloud is judged by some thin places first, ...
  std::size_t probe_points = 1000;  ///< ... by the points about each, ...
  std::size_t probe_part = 4;  ///< ... where the cloud has more than this many times as many, ...
  double probe_sure = 0.2;     ///< ... and has sides if this share of edges is in sure parts
  /// Where sides are in doubt, points are moved to planes of this many neighbours for a variance of
  /// one squared spacing, ...
  double plane = 10;
  double most_plane = 48;        ///< ... but no more than this, ...
  std::size_t least_plane = 16;  ///< ... or not at all; ...
  double plane_sides = 0.85;     ///< ... of their own side, from this confidence on
  double feet_noise = 0.7;       ///< least share of the points' noise that their feet have
  /// Where sides are in doubt and parts are few spacings thick, leaves follow the points to within
  /// this share of the median gap of two sheets, ...
  double followed = 0.1;
  double near_gap = 4, far_gap = 6;             ///< ... from the lesser gap on [spacings] ...
  double more_doubt = 0.88, less_doubt = 0.93;  ///< ... and from the lesser confidence on
  double outward = 0.95;  ///< agreement of all cells from which their sides orient the surface
  double part = 0.25;     ///< of that share that must come to face apart ...
  double doubt = 0.45;    ///< ... and that may be in doubt, ...
  /// (where none are sure enough, noise is wide and fewer points than this share their errors,
  /// which else make terraces: this much in all)
  double terraces = 3, last_doubt = 0.3;
  double clean_doubt = 0.03;  ///< ... of all agreements at most this where there is little noise
  double much_doubt =
      4;  ///< growth of that part that narrower cells with the same noise do not excuse
  double same_noise =
      0.75;            ///< share of the noise that the cells were cut by, from which it is the same
  double sure = 0.95;  ///< confidence from which narrower cells are not tried
  int noise_passes = 5;       ///< times that cells are cut by the noise that sides show
  double least_noise = 0.05;  ///< noise that sides may show where there was less without [spacings]
  double least_cells = 1.0;   ///< noise below which cells follow the spacing alone [spacings], ...
  double doubtful_cells = 0.8;  ///< ... and below it once more where sides are in doubt
  double clear_beam = 0.2;  ///< cosine from which a point's own beam gives its side, not its cell's
  int passes = 4;           ///< rounds of two-means on heights
  std::size_t settled_points = 32;  ///< nearest points by which a point's sheet is chosen, ...
  int settle_rounds = 30;           ///< ... round by round, at most
  /// Mean squared cosine to the normals of its neighbours below which a point's normal gives way to
  /// ...
  double across = 0.5;
  double common = 0.6;  ///< ... the direction along which more than this share of their squares is
};

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

/** \brief Finds sides of a cloud without normals: normals of cells from the moments of the cells
 * about them, signs by greedy contraction of the graph of cells or, where points have sensors, by
 * these. O(n log n); same result for any number of threads. \param[in] noise RMS distance of points
 * from the surface, local length
 * \param[in] spacing distance of neighbouring points, local length */
PCL_SLIM_EXPORT Sides findSides(const PointStore& store, double noise, double spacing,
                                SideScope scope, const SideConstants& constants, int threads);

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
 * radius however wide they are. It is thin, too, if a cubic fits, but its residuals are flatter
 * than Gaussian ones (excess kurtosis): two sheets within one noise. Where points have sensors, a
 * place seen from either side of its patch is thin, and one seen from about one direction is not.
 * O(places k). */
PCL_SLIM_EXPORT ThinPlaces findThinPlaces(const PointStore& store, const SideConstants& constants,
                                          const NoiseConstants& noise, int threads);

/** \brief Gives points near others that face the other way a side and a normal of their own. A cell
 * gives all of its points one normal, and one side or two at a plane between two sheets; where
 * sheets meet, as at the edge of a blade, many cells have the wrong side, and cells with a bit of
 * another sheet any normal. Points on the sheet of those of their nearest points that face the
 * other way turn, round by round until none is left: sides spread from the cells that have the
 * right one. Then points have the normals of planes of least squares of their neighbours on the
 * sheet. O(n k); same result for any number of threads.
 * \param[in] on_rods stored points whose normals stay, as Sides::on_rods; empty: none
 * \param[in,out] normals of the stored points; 0: no side, left out */
PCL_SLIM_EXPORT void settleSides(const PointStore& store, const std::vector<char>& on_rods,
                                 const SideConstants& constants, int threads,
                                 std::vector<std::array<float, 3>>& normals);

/** \brief Every stored point's foot on the plane of least squares of its k nearest points, itself
 * included: local positions. Where the store has sides, points of the other side are left out. O(n
 * k). */
PCL_SLIM_EXPORT std::vector<std::array<double, 3>> feetOnLocalPlanes(const PointStore& store,
                                                                     std::size_t k, int threads);

}  // namespace pcl_slim::detail
