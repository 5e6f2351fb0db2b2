// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/query/detail/projection_kernel.h"

namespace pcl_slim::detail {

/** Sums over the leaves of a block's 16 places. */
struct BlockColors {
  alignas(64) float weight[16];
  alignas(64) float sum[3][16];  ///< weighted red, green, blue, 0..255
};

namespace kernels {

/** Adds a leaf's colour at the places in its ball. It counts in full where its polynomial passes within
 * kColorGate and, if the places have normals, faces as they do; elsewhere by kOtherSheet. */
void
addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
          BlockColors& colors);

}  // namespace kernels
}  // namespace pcl_slim::detail
