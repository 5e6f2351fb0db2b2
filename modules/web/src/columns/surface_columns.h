// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/web/web_surface.h"

namespace pcl_slim::detail {

/** \brief encodeWebSurface() before it is deflated. The surface must pass validate(). */
std::vector<unsigned char>
packColumns(const SLIMSurface& surface, double precision);

/** \brief Inverse of packColumns(). */
Result<WebSurface>
unpackColumns(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim::detail
