// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/surface/surface.h"
#include "pcl_slim/surface/surfel_color.h"

namespace pcl_slim::detail {

/** \brief Texels of four numbers a surfel of a surface takes on the graphics card: centre and
 * radius; normal and weight; the frame's u axis with the level and, as its fraction, the residual in
 * radii; where its trim map begins and the level of detail's sizes; then the coefficients; then, of a
 * coloured surface, the terms of its colour, red, green and blue of each. */
constexpr int
texelsOfLeaf(int degree, bool colored = false)
{
  return 4 + (numCoefficients(degree) + 3) / 4 + (colored ? (3 * kColorTerms + 3) / 4 : 0);
}

/** \brief A surface as the shaders read it. */
struct LeafTexels {
  /** texelsOfLeaf() texels for each leaf and, behind all leaves, for each internal
   * surfel if they were asked for. The fourth texel of one: the begin of its trim map in 4096 words,
   * what that leaves over times TrimMap::kMostSide plus the map's side less 1, or -1 of a closed one; its own
   * and its parents' DetailSizes. Balls of internal surfels are
   * drawn larger than their radius. */
  std::vector<float> surfels;
  /** Words of TrimTable, row by row; one word at least, as a buffer cannot be empty. */
  std::vector<std::int32_t> trim_words;
  std::size_t leaves = 0, all = 0;  ///< surfels in the texels
};

/** \brief Packs a surface. \param[in] with_internal internal surfels too, which a level of detail
 * needs. O(surfels + links). */
LeafTexels
packLeaves(const SLIMSurface& surface, bool with_internal);

}  // namespace pcl_slim::detail
