// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::test {

/** \brief A surface as a page has it: no links, but the sizes that a level of detail uses. */
struct WebSurface {
  SLIMSurface surface;  ///< leaves first, then internal surfels, each along a Morton curve
  std::vector<float> own, parent;  ///< detail::DetailSizes
};

/** \brief Inverse of encodeWebSurface(), as the viewer does it. Truncated, damaged or foreign bytes
 * give an error. */
Result<WebSurface> decodeWebSurface(const std::vector<unsigned char>& bytes);

}  // namespace pcl_slim::test
