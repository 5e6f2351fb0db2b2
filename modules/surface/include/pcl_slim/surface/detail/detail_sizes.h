// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "pcl_slim/core/export.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief How large a surfel may be seen before its descendants show what it leaves out, half a
 * length in local units, as a ball's radius is half of its diameter.
 *
 * The size of a surfel is that of its ball or of its error, whichever is smaller: a smooth part
 * replaces its descendants however large it is, unless a border runs through it, which leaves alone
 * know. Errors count kErrors fold, as a level of detail is named in pixels and a bump much lower
 * than a pixel still changes a picture's shades. How far a surfel reaches beyond its children
 * counts kOverhangs fold: where points end inside its ball, at the side of a horn, its polynomial
 * continues, and its error does not show it. No surfel is smaller than a descendant, so that where
 * it replaces one it replaces all.
 */
struct PCL_SLIM_EXPORT DetailSizes {
  static constexpr float kErrors = 16.0f;  ///< errors of lod / kErrors are let pass
  static constexpr float kOverhangs = 4.0f;
  static constexpr float kNoParent = 1e18f;
  static constexpr float kCovers = 0.95f;  ///< of an internal surfel's radius, where rays meet it

  std::vector<float> own;  ///< 0 of a leaf: it replaces nothing
  std::vector<float>
      parent;  ///< the smallest of the parents whose balls contain it; kNoParent of none

  /** \brief O(surfels + links). Without links no surfel has a parent. */
  explicit DetailSizes(const SLIMSurface& surface);
};

}  // namespace pcl_slim::detail
