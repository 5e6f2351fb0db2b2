// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What a probe finds at sixteen places side by side.
#include "projection/projection.h"

namespace pcl_slim::detail {

/** Which leaves a place's distance is blended from; lengths in radii of a leaf but for the noise.
 */
struct SheetRules {
  WeightKernel kernel = WeightKernel::kPower4;
  bool oriented = false;
  float most_distance = 0;  ///< leaves farther from a place do not count
  float reach_sq = 0;       ///< nor do those whose centre is farther, squared
  float same_sheet = 0;     ///< leaves of one sheet differ by no more than this and the noise
  float softening = 0;      ///< leaves nearer than this and the noise are equally near
  float noise = 0;          ///< local units
  float min_dot = 0;  ///< oriented leaves of one sheet have normals whose cosine is above this
};

/** The nearest leaf of a block's 16 places, then sums over the leaves of its sheet. */
struct BlockSheets {
  alignas(64) float score[16];      ///< of the nearest leaf; 0: there is none
  alignas(64) float distance[16];   ///< to it, signed, local units
  alignas(64) float normal[3][16];  ///< its normal at the foot
  alignas(64) float weight[16], distance_sum[16], normal_sum[3][16];
};

/** Sums over the leaves of a block's 16 places. */
struct BlockColors {
  alignas(64) float weight[16];
  alignas(64) float sum[3][16];  ///< weighted red, green, blue, 0..255
};

/** The blended surface from a block's sums, columns per point; undefined where nothing was added.
 */
struct BlockPrincipals {
  alignas(64) float length[16];     ///< of the blended gradient
  alignas(64) float normal[3][16];  ///< unit
  alignas(64) float k1[16], k2[16];
  alignas(64) float direction1[3][16], direction2[3][16];
};

namespace kernels {

void clearSheets(BlockSheets& sheets);

/** Pass 1: keeps a leaf where it scores more than those before it. */
void findSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
                BlockSheets& sheets);

/** Pass 2: adds a leaf where it belongs to the sheet of the nearest one. */
void addSheets(const BlockPoints& points, const BlockLeaf& leaf, const SheetRules& rules,
               BlockSheets& sheets);

/** Adds a leaf's colour at the places in its ball. It counts in full where its polynomial passes
 * within kColorGate and, if the places have normals, faces as they do; elsewhere by kOtherSheet.
 * \param[in] widths over which textures are averaged, local units; or null */
void addColors(const BlockPoints& points, const BlockLeaf& leaf, const BlendRules& rules,
               const float* widths, BlockColors& colors);

/** Like principalCurvatures(), in single precision and for sixteen points together. */
void findPrincipals(const BlockSums& sums, BlockPrincipals& principals);

}  // namespace kernels
}  // namespace pcl_slim::detail
