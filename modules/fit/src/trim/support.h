// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "trim/trim.h"

namespace pcl_slim::detail {

/** \brief How far from its points a surfel's surface exists. */
struct SupportConstants {
  double opens = 5;  ///< [spacings] a surfel is open if its surface is farther from its points: ...
  double kept = 3;   ///< [spacings] ... what is farther than this then does not exist
  double noises = 3;            ///< [RMS errors of a point] added to both
  double looked_at = 0.9;       ///< [r] places beyond do not open a surfel: its weight is next to 0
  double filled = 1.0 / 3.0;    ///< of the disc: points that fill less have the spacing about them
  std::size_t few_points = 64;  ///< of more points the area is measured well enough by sectors
  int most_cells = 9;  ///< of 4 x 4 about the disc: points in more fill a third of it, surely
  std::size_t near_points = 8;    ///< neighbours of a point that show the spacing about it ...
  std::size_t looked_about = 16;  ///< ... of about this number of points
};

inline constexpr SupportConstants kSupport;

/** \brief A surfel's polynomial; lengths in its radii. */
struct SupportedSurface {
  int degree;
  const float* c;
  double spacing;  ///< of its points
  double noise;    ///< RMS error of a point
};

/** \brief Whether a surfel's surface leaves its points, in space: a place of its plane may have
 * points next to it that its steep polynomial passes far above. One per thread: it keeps its
 * memory. */
class SupportTest {
 public:
  /** \brief Mean spacing of points in the unit disc, as spacingOf() of all points, or that of the
   * points about each point where few points fill less than a third of the disc. O(points). */
  double spacingOf(SheetPoints& points);

  /** \brief Whether a place of the surface in the unit ball is farther from every point than a
   * surfel without a map allows. O(points). */
  bool standsOff(const SheetPoints& points, const SupportedSurface& surface);

  /** \brief Clears the bits of a map of side x side nodes at which the surface is in the ball but
   * away from its points. O(points + nodes). */
  void cutMap(const SheetPoints& points, const SupportedSurface& surface, int side,
              std::uint8_t* bits);

 private:
  void sortPoints(const SheetPoints& points, double reach);
  bool isSupported(const SheetPoints& points, double u, double v, double w) const;
  int cellAt(double coordinate) const;
  static double spacingAbout(const SheetPoints& points, std::size_t point);

  double reach_ = 0;                                  ///< of a point; also the width of a cell
  int side_ = 0;                                      ///< cells
  std::vector<std::uint32_t> begin_, sorted_, next_;  ///< points of each cell of the plane
  std::vector<double> spacings_;
};

}  // namespace pcl_slim::detail
