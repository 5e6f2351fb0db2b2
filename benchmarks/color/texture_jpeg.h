// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim::measure {

/** \brief Bytes of a surface's textures as one JPEG picture without chroma subsampling, of the lowest
 * quality whose error is at most the given one; nothing where the build has no libjpeg.
 * \param[in] rms of the channels, 0..255 */
std::optional<std::size_t> jpegBytes(const SLIMSurface& surface, double rms);

}  // namespace pcl_slim::measure
