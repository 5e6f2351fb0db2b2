// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace pcl_slim {

/** \brief Colours owned by someone else: three consecutive bytes blue, green, red per point, as PCL
 * keeps them; as many points as the CloudView has. */
struct ColorView {
  const void* bgr = nullptr;  ///< address of the first point's blue, or null: no colours
  std::size_t stride = 0;     ///< bytes from one point to the next
};

}  // namespace pcl_slim
