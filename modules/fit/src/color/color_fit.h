// SPDX-License-Identifier: BSD-3-Clause
// Colours of a surface's surfels from stored points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "color/texture_fit.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief Colours in the order of the store. */
ColorColumns colorsInStoreOrder(const PointStore& store, const CloudView& cloud,
                                const ColorView& colors, int threads);

/** \brief The colours of surfels without any point: grey. */
std::vector<std::uint8_t> greyColors(std::size_t surfels);

/** \brief Gives surfels polynomials and textures of stored points' colours, in place of those they
 * have. \param[in] columns of the store \param[in] keeps for each surfel, whether it keeps its
 * colours, or is grey if the surface has none; empty: none does. */
void fitStoredColors(const PointStore& store, const ColorColumns& columns,
                     const std::vector<char>& keeps, int threads, SLIMSurface& surface);

}  // namespace pcl_slim::detail
