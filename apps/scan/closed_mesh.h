// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>

#include "pcl_slim/filters/io/point_file.h"

namespace pcl_slim {

/** \brief Turns the faces of a closed mesh round if they face inwards: if every edge has two faces, which
 * run along it in opposite directions, and the volume they enclose is negative.
 * \param[in] position of a vertex \return whether it did. O(faces log faces). */
bool
turnOutwards(const std::function<std::array<double, 3>(std::uint32_t)>& position, PointFile& mesh);

}  // namespace pcl_slim
