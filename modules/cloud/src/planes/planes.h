// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/neighbor_planes.h"
#include "pcl_slim/core/aligned.h"

namespace pcl_slim::detail {

/** Points around one block as columns, from the block's origin; the last vector is filled up with
 * points far away. */
struct BlockSurroundings {
  AlignedVector<float> x, y, z;
  std::size_t count = 0;
};

/** Unit normals and surface variations of a block's points. */
struct BlockPlanes {
  alignas(64) std::array<float, PointStore::kBlock> x, y, z, variation;
  std::uint32_t found = 0;  ///< bit i: point i has them
};

/** SIMD inner loops, compiled per instruction set and chosen at run time. None depends on the width
 * of vectors: the same numbers everywhere. */
namespace plane_kernels {

/** The points of some blocks inside a box. */
void gatherSurroundings(const PointStore& store, std::size_t block,
                        const std::vector<std::uint32_t>& blocks, const float low[3],
                        const float high[3], BlockSurroundings& points);

/** The planes of about k neighbours: those in a ball that has as many at the density of a narrower
 * or wider one around the same point. \param[in] chosen bit i: point i is
 * \param[in] reach of the first ball
 * \param[in] most no ball is wider. O(surroundings), for all chosen points together. */
void findPlanes(const PointStore& store, std::size_t block, const BlockSurroundings& points,
                std::uint32_t chosen, float reach, float most, float k, BlockPlanes& planes);

}  // namespace plane_kernels
}  // namespace pcl_slim::detail
