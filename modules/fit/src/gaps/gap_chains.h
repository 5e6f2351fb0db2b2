// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "gaps/gap_grid.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief The gaps of one leaf, apart from the grid they were found on. */
struct LeafGaps {
  /** A place of the leaf's plane, in its radii. */
  struct Place {
    float u, v;
    std::uint16_t gap;
  };
  /** Cells of a gap side by side in a row. */
  struct Run {
    std::int16_t y, first, last;
    std::uint16_t gap;
  };

  std::uint32_t surfel = 0;
  std::uint16_t count = 0;
  float cells_per_unit = 0.0f, half = 0.0f;  ///< cell = half + cells_per_unit * place
  std::vector<Run> runs;                     ///< row by row
  std::vector<Place> ends;           ///< of each gap, the four outermost middles of its empty discs
  std::vector<std::uint32_t> chain;  ///< by gap: the chain it belongs to
  std::vector<std::uint8_t> real;    ///< by gap: whether it is a border or a hole of the data

  /** \brief The gap at a place; -1: none. */
  int gapAt(double u, double v) const;
  bool hasReal() const;
  /** \brief Whether a gap has a cell nearer to the centre than a distance [radii]. */
  bool reachesIn(std::uint32_t gap, double distance) const;
};

/** \brief Copies the gaps last found on a grid, none of them real. */
LeafGaps
leafGapsOf(const GapGrid& grid, std::uint32_t surfel);

/** \brief Numbers the chains: gaps of overlapping leaves that share a place, and so on.
 * \param[in,out] leaves in ascending order of surfels. O(n log n) for n leaves alike in size. The same
 * for any number of threads. \return how many there are */
std::size_t
joinChains(const SLIMSurface& surface, int threads, std::vector<LeafGaps>& leaves);

}  // namespace pcl_slim::detail
