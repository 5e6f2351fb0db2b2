// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/query/detail/projection_kernel.h"

namespace pcl_slim::detail {

/** What a block's sums tell of the blended surface, columns per point; of no use where nothing was added. */
struct BlockPrincipals {
  alignas(64) float length[16];     ///< of the blended gradient
  alignas(64) float normal[3][16];  ///< unit
  alignas(64) float k1[16], k2[16];
  alignas(64) float direction1[3][16], direction2[3][16];
};

namespace kernels {

/** As principalCurvatures() finds them, in single precision and for sixteen points at once. */
void
findPrincipals(const BlockSums& sums, BlockPrincipals& principals);

}  // namespace kernels
}  // namespace pcl_slim::detail
