// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/render/image.h"

namespace pcl_slim::detail {

/** \brief Whether this build reads and writes PNG: true in png.cpp, false in png_none.cpp. */
bool hasPng();

}  // namespace pcl_slim::detail
