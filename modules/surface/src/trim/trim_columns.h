// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Turns a map, side and bits, over in v: the rows of a surfel whose normal is turned. */
void
mirrorTrimMap(std::uint8_t* map);

/** \brief Names what is wrong with a surface's trim maps: offsets, flags or sides. */
Error
checkTrimMaps(const SLIMSurface& surface);

}  // namespace pcl_slim::detail
