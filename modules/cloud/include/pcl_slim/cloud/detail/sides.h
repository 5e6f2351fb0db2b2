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

/** \brief Cells, and the two sheets of cells or of a patch (docs/sides.md, "Sides before the
 * cover").
 *
 * The confidence of sides is the share of the agreement of neighbouring cells that they satisfy;
 * doubt is the rest. Two sheets face apart if each is behind the other. */
struct SideConstants {
  static constexpr std::size_t kMostNeighbors = 36;  ///< largest number of cells that give a normal

  double cell_noise = 1.5;          ///< width of a cell [sqrt(lambda)]
  std::size_t edge_neighbors = 12;  ///< nearest cells that a cell has edges to
  int passes = 4;                   ///< iterations of two-means on heights
  /// Least distance of the means of two sheets [standard deviation within the sheets].
  double sheet_distance = 4.0;
  double least_side = 0.15;  ///< least share of the points on the smaller of two sheets
  /// Residuals of a cubic are those of two sheets if their excess kurtosis is below minus this, by
  /// more than chance.
  double two_sheet_kurtosis = 0.4;
  double rod = 0.2;  ///< largest variance of a rod across its axis [variance along it]
  /// Least ratio of a rod's two variances across its axis. That of a strip is less.
  double round_rod = 0.2;
  /// Least cosine of a point's beam and its cell's normal from which the beam decides the side.
  double clear_beam = 0.2;
};

/** \brief Which points get sides. */
enum class SideScope {
  kAll,
  kFacing,  ///< points near another sheet that faces apart, in parts whose cells agree
};

/** \brief Unit normals of consistent sign for the stored points. */
struct Sides {
  std::vector<std::array<float, 3>> normals;  ///< 0: the point gets no side
  std::vector<char> on_rods;                  ///< 1: the point's normal is radial to a rod's axis
  std::vector<std::array<float, 3>> outward;  ///< for kFacing: the sides of all points
  double outward_confidence = 0;              ///< confidence of outward
  std::size_t cells = 0;                      ///< number of cells, whose points share a normal
  double thin = 0;        ///< share of the points in front of others that face apart
  double gap = HUGE_VAL;  ///< median distance of two such sheets [local length]
  double confidence = 0;  ///< agreement of neighbouring cells; 1: all agree, 0: by chance
  double sure = 1;        ///< share of the edges between sheets in parts with certain sides
};

/** \brief Finds sides of a cloud without normals. Normals of cells are those of the moments of the
 * cells around. Signs are found by greedy contraction of the graph of cells or, where points have
 * sensors, by these. O(n log n); the number of threads does not change the result.
 * \param[in] noise RMS distance of the points from the surface [local length]
 * \param[in] spacing distance of neighbouring points [local length] */
PCL_SLIM_EXPORT Sides findSides(const PointStore& store, double noise, double spacing,
                                SideScope scope, const SideConstants& constants, int threads);

/** \brief Places of a cloud where a ball would contain two sides. */
struct ThinPlaces {
  double share = 0;    ///< share of the places that are thin
  double flat = 0;     ///< share of the places that are thin by their residuals' kurtosis alone
  double facing = 0;   ///< share of other places where two sheets face each other
  double noise = 0;    ///< RMS residual of cubics at places with one side; 0: none has
  double spacing = 0;  ///< median distance of neighbouring points [local length]
  std::vector<std::size_t> thin;  ///< stored points at places of both kinds
};

/** \brief Examines places spread over a cloud for two sides. A place is thin if
 *
 * 1. its points form two sheets or a rod;
 * 2. noise fills its patches: cubics leave more than a share of the radius at every width;
 * 3. a cubic fits, but its residuals are flatter than Gaussian ones (excess kurtosis), as those of
 *    two sheets within one noise are;
 * 4. its points were seen from either side of its patch.
 *
 * A place that was seen from about one direction has one side. O(places k). */
PCL_SLIM_EXPORT ThinPlaces findThinPlaces(const PointStore& store, const SideConstants& constants,
                                          const NoiseConstants& noise, int threads);

/** \brief Corrects the sides and normals of points near points that face the other way.
 *
 * All points of a cell have one normal, and one sign or two on either side of a plane. Where sheets
 * meet, as at the edge of a blade, many cells have the wrong sign, and cells with some points of
 * another sheet have arbitrary normals.
 *
 * 1. A point turns if it is on the sheet of those of its nearest points that face the other way.
 *    Rounds follow until no point turns, so that right sides spread.
 * 2. Then each point gets the normal of the least-squares plane of its neighbours on its sheet.
 *
 * O(n k); the number of threads does not change the result.
 * \param[in] on_rods stored points whose normals do not change, as Sides::on_rods; empty: none
 * \param[in,out] normals of the stored points; points of normal 0 have no side and do not count */
PCL_SLIM_EXPORT void settleSides(const PointStore& store, const std::vector<char>& on_rods,
                                 int threads, std::vector<std::array<float, 3>>& normals);

/** \brief Projects every stored point onto the least-squares plane of its k nearest points, itself
 * included. Where the store has sides, points of the other side are left out.
 * \return local positions. O(n k). */
PCL_SLIM_EXPORT std::vector<std::array<double, 3>> feetOnLocalPlanes(const PointStore& store,
                                                                     std::size_t k, int threads);

}  // namespace pcl_slim::detail
