// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ball/nearby_blocks.h"
#include "ball/surfel_record.h"
#include "fit_settings.h"

namespace pcl_slim::detail {

/** \brief Adds a leaf to the coverage of the points it serves (docs/theory.md, "Cover").
 * \param[in,out] nearby blocks, of a region that holds the leaf's ball \param[in,out] coverage of
 * each stored point */
void
addCoverage(const PointStore& store, const FitSettings& settings, const SurfelRecord& surfel,
            NearbyBlocks& nearby, float* coverage);

/** \brief Sets the bits of value in the marks of the points of an internal ball. */
void
markBall(const PointStore& store, const FitSettings& settings, const SurfelRecord& surfel,
         std::uint8_t value, NearbyBlocks& nearby, std::uint8_t* marks);

/** \brief Sets the bits of value in the marks of those points about a stored point that have none of
 * them and are not covered. \return how many those are. */
std::uint32_t
markUncovered(const PointStore& store, const FitSettings& settings, std::uint32_t point,
              double reach, std::uint8_t value, NearbyBlocks& nearby, const float* coverage,
              std::uint8_t* marks);

}  // namespace pcl_slim::detail
