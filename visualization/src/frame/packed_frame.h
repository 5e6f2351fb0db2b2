// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::detail {

/** \brief A G-buffer as the resolve shader reads it; rows from the top. Both back ends make it. */
struct PackedFrame {
  /** Normal in the model's axes; depth along the ray in the model's units, below 0 where the
   * surface is seen from behind, 0 where nothing is met. Four numbers a pixel. */
  std::vector<float> geometry;
  /** k_max and k_min (1/length), radius (length), levelAndResidual(). Four numbers a pixel. */
  std::vector<float> attributes;
  /** Red, green, blue, 255; empty where no colours were asked for. Four bytes a pixel. */
  std::vector<std::uint8_t> colors;
};

/** \brief A level and, as its fraction, a residual as a share of the radius, so that both fit into
 * one number. */
float
levelAndResidual(int level, float residual, float radius);

/** \brief Packs a G-buffer. \param[in] scale world units per unit of the buffer. O(pixels). */
void
packFrame(const GBuffer& buffer, double scale, int threads, PackedFrame& frame);

}  // namespace pcl_slim::detail
