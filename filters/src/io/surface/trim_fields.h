// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief A surfel's trim map brought to 8 x 8 nodes, row by row, lowest bit first; 0 if it is closed. */
std::array<std::uint32_t, 2>
coarseTrimMap(const SLIMSurface& surface, std::size_t i);

/** \brief Gives the open surfels maps of 8 x 8 nodes. \param[in] maps one for each surfel */
void
setCoarseTrimMaps(const std::vector<std::array<std::uint32_t, 2>>& maps, SLIMSurface& surface);

/** \brief Appends the trim maps as they are, as lines "pcl_slim trim_maps BASE64", where 8 x 8 nodes cannot
 * represent them. Lines are shorter than the 511 characters that MeshLab takes. */
void
addTrimComments(const SLIMSurface& surface, std::vector<std::string>& comments);

/** \brief Gives the open surfels of a surface the maps of such lines. Its coarse maps stay where they
 * contradict the lines, as in a file that another program has changed. */
void
takeTrimComments(const std::vector<std::string>& comments, SLIMSurface& surface);

}  // namespace pcl_slim
