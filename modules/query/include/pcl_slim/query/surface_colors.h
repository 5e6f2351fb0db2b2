// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/core/vector3.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim {

/** \brief Colours of a coloured surface at places on it: red, green and blue.
 *
 * Each is the mean of the leaves' colours, with the weights that blend the surface. \param[in] positions
 * world coordinates; places of one neighbourhood should follow one another \param[in] normals unit, one
 * for each \return one colour for each, white where the place is in no leaf's ball; none if the surface has
 * no colours. O(surfels log surfels + leaves near the places); the same for any number of threads. */
PCL_SLIM_EXPORT std::vector<std::array<std::uint8_t, 3>>
surfaceColors(const SLIMSurface& surface, const std::vector<Vector3>& positions,
              const std::vector<std::array<float, 3>>& normals, int threads = 0);

}  // namespace pcl_slim
