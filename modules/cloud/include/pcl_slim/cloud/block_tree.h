// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pcl_slim/core/aligned.h"
#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief Bounding-volume hierarchy over blocks of points in Morton order, 16 children a node.
 *
 * Implicit: node j of a level has children 16 j ... 16 j + 15 of the level below, whose boxes
 * are contiguous, so that one SIMD comparison tests all of a node's children. Level 0 has
 * the blocks' own boxes. Unused boxes are empty (min > max) and never hit.
 */
class PCL_SLIM_EXPORT BlockTree {
 public:
  static constexpr std::size_t kFan = 16;

  /** \brief Boxes of one level, as columns padded to a multiple of kFan. */
  struct Level {
    AlignedVector<float> min_x, min_y, min_z, max_x, max_y, max_z;
    std::size_t count = 0;

    void allocate(std::size_t boxes);
  };

  BlockTree() = default;
  /** \brief Builds the upper levels over the blocks' boxes, one at least. O(blocks). */
  explicit BlockTree(Level blocks);

  std::size_t numBlocks() const { return levels_.empty() ? 0 : levels_.front().count; }
  const std::vector<Level>& levels() const { return levels_; }
  std::size_t memoryBytes() const;

  /** \brief Appends, in ascending order, the blocks whose box meets the ball.
   * \param[in] center local coordinates; \param[in] radius local length. */
  void blocksInBall(const float center[3], float radius, std::vector<std::uint32_t>& blocks) const;

  /** \brief Appends, in ascending order, the blocks whose box meets an axis-aligned box. */
  void blocksInBox(const float min[3], const float max[3],
                   std::vector<std::uint32_t>& blocks) const;

  /** \brief Appends, in ascending order, the groups of kFan blocks whose common box meets an
   * axis-aligned box: entries of levels()[1]. */
  void groupsInBox(const float min[3], const float max[3],
                   std::vector<std::uint32_t>& groups) const;

 private:
  std::vector<Level> levels_;
};

/** \brief Numbers of blocks, ascending. */
using BlockList = AlignedVector<std::uint32_t>;

/** \brief The groups of blocks around one region, copied side by side: cheap queries for the many
 * balls inside it. */
class PCL_SLIM_EXPORT BlockNeighborhood {
 public:
  /** \brief Collects the groups whose box meets an axis-aligned box; the tree must outlive this. */
  void collect(const BlockTree& tree, const float min[3], const float max[3]);

  /** \brief Replaces blocks by those, ascending, whose box meets a ball inside the region. */
  void blocksInBall(const float center[3], float radius, BlockList& blocks) const;

 private:
  const BlockTree* tree_ = nullptr;
  std::vector<std::uint32_t> ids_;
  BlockTree::Level groups_;
};

}  // namespace pcl_slim
