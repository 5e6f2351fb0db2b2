// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

/** Points around one block as columns, from the block's origin; the last vector is filled up with points
 * far away. */
struct BlockSurroundings {
  AlignedVector<float> x, y, z;
  std::size_t count = 0;
};

/** Unit normals of a block's points. */
struct BlockNormals {
  alignas(64) std::array<float, PointStore::kBlock> x, y, z;
  std::uint32_t found = 0;  ///< bit i: point i has one
};

namespace splat_kernels {

/** The points of some blocks inside a box. */
void
gatherSurroundings(const PointStore& store, std::size_t block,
                   const std::vector<std::uint32_t>& blocks, const float low[3],
                   const float high[3], BlockSurroundings& points);

/** The directions of least variance of about k neighbours: those in a ball that has as many at the
 * density of a narrower or wider one around the same point. \param[in] chosen bit i: point i is
 * \param[in] reach of the first ball
 * \param[in] most no ball is wider. O(surroundings), for all chosen points together. */
void
findNormals(const PointStore& store, std::size_t block, const BlockSurroundings& points,
            std::uint32_t chosen, float reach, float most, float k, BlockNormals& normals);

}  // namespace splat_kernels
}  // namespace pcl_slim::detail
