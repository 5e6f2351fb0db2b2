// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::detail {

/** \brief Marks some pixels in a row as met by nothing. */
void
clearPixels(GBuffer& buffer, std::size_t begin, std::size_t count);

}  // namespace pcl_slim::detail
