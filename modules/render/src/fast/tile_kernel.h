// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "fast/frame_scene.h"
#include "pcl_slim/render/g_buffer.h"
#include "pcl_slim/render/render_params.h"

namespace pcl_slim::detail::kernels {

/** \brief Draws tile t of a frame: both passes for each block of pixels, and writes every pixel of
 * the tile. Blocks are 4 pixels wide and as high as the vectors allow. */
void
drawTile(const FrameScene& scene, std::size_t t, TileScratch& scratch, GBuffer& buffer,
         RenderStatistics& statistics);

}  // namespace pcl_slim::detail::kernels
