// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/render/shading.h"

namespace pcl_slim::detail {

/** \brief The number that a mode shows at a covered pixel, in world units. */
double
valueAt(const GBuffer& buffer, std::size_t pixel, ShadingMode mode, double scale);

/** \brief The colour of a value. */
Color
colorOf(const ShadingParams& params, const ShadingRange& range, double value);

/** \brief The level at a share of a range of levels. */
std::uint32_t
levelAtShare(const ShadingRange& range, double share);

/** \brief The colour of a share of the range, 0 its lower end. */
Color
colorAtShare(const ShadingParams& params, const ShadingRange& range, double share);

/** \brief Whether a picture has a shade in its hollows. */
bool
wantsAmbientOcclusion(const ShadingParams& params);

}  // namespace pcl_slim::detail
