// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/cloud/block_tree.h"
#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/core/export.h"

/** \brief SIMD inner loops of modules/cloud, compiled per instruction set and chosen at run time.
 */
namespace pcl_slim::detail::kernels {

/** \brief Which of the 16 boxes from first on meet a ball; bit i is that of box first + i. */
PCL_SLIM_EXPORT std::uint32_t boxesInBall(const BlockTree::Level& boxes, std::size_t first,
                                          const float center[3], float radius);

/** \brief The boxes that meet a ball, sought through groups of kFan neighbours.
 * \param[in] groups common boxes of some groups; \param[in] ids their numbers: group g has the
 * boxes from g kFan on. \param[out] found numbers of boxes, in order of the groups, with kFan
 * entries to spare. \return how many. */
PCL_SLIM_EXPORT std::size_t groupedBoxesInBall(const BlockTree::Level& groups,
                                               const std::uint32_t* ids,
                                               const BlockTree::Level& boxes, const float center[3],
                                               float radius, std::uint32_t* found);

/** \brief Which of the 16 boxes from first on meet an axis-aligned box. */
PCL_SLIM_EXPORT std::uint32_t boxesInBox(const BlockTree::Level& boxes, std::size_t first,
                                         const float min[3], const float max[3]);

/** \brief The points of some blocks within a squared distance of a centre, in order of the blocks.
 * \param[out] distances_sq,points found, with kBlock values to spare. \return how many. */
PCL_SLIM_EXPORT std::size_t pointsUpTo(const PointStore& store, const std::uint32_t* blocks,
                                       std::size_t num_blocks, const double center[3],
                                       float limit_sq, float* distances_sq, std::uint32_t* points);

/** \brief The k-th smallest of n > 0 values, none of them negative; k from 1 to n. O(n) for values
 * whose spread is about even: counts in SIMD up to limits that their rank suggests. */
PCL_SLIM_EXPORT float kthSmallest(const float* values, std::size_t n, std::size_t k);

/** \brief The points whose values are at most a limit, in order. \param[out] found with kBlock
 * entries to spare. \return how many. */
PCL_SLIM_EXPORT std::size_t valuesUpTo(const float* values, const std::uint32_t* points,
                                       std::size_t n, float limit, std::uint32_t* found);

/** \brief Which points of a block may have fewer others within a squared distance than required;
 * bit i is that of the block's point i. The block and the two on either side of it are searched, so
 * some of them have as many. */
PCL_SLIM_EXPORT std::uint32_t sparsePoints(const PointStore& store, std::size_t block,
                                           float limit_sq, std::size_t others);

constexpr std::size_t kMortonBatch = 64;

/** \brief Morton codes (morton.h) of a batch of positions, converted to local units. The
 * batch and codes start on a cache line. */
PCL_SLIM_EXPORT void mortonCodes(const double (&positions)[3][kMortonBatch], const double origin[3],
                                 double inverse_scale, std::uint64_t* codes);

/** \brief Name of the instruction set in use, for reports. */
PCL_SLIM_EXPORT const char* instructionSet();

}  // namespace pcl_slim::detail::kernels
