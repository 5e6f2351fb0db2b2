// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Appends the trim maps as they are, as lines "pcl_slim trim_maps BASE64", where 8 x 8
 * nodes cannot represent them. Lines are shorter than the 511 characters that MeshLab takes. */
void addTrimComments(const SLIMSurface& surface, std::vector<std::string>& comments);

/** \brief Gives the open surfels of a surface the maps of such lines. Its coarse maps stay where
 * they contradict the lines, as in a file that another program has changed. */
void takeTrimComments(const std::vector<std::string>& comments, SLIMSurface& surface);

}  // namespace pcl_slim
