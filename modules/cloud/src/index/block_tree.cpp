// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/cloud/block_tree.h"

#include <algorithm>
#include <limits>

#include "pcl_slim/cloud/detail/block_kernels.h"

namespace pcl_slim {

using namespace detail;

void BlockTree::Level::allocate(std::size_t boxes) {
  const std::size_t padded = (boxes + kFan - 1) / kFan * kFan;
  const float inf = std::numeric_limits<float>::infinity();
  for (auto* column : {&min_x, &min_y, &min_z}) column->assign(padded, inf);
  for (auto* column : {&max_x, &max_y, &max_z}) column->assign(padded, -inf);
  count = boxes;
}

namespace {

float lowest(const AlignedVector<float>& column, std::size_t begin) {
  return *std::min_element(column.begin() + begin, column.begin() + begin + BlockTree::kFan);
}

float highest(const AlignedVector<float>& column, std::size_t begin) {
  return *std::max_element(column.begin() + begin, column.begin() + begin + BlockTree::kFan);
}

/** The common boxes of kFan neighbours each. */
void groupBoxes(const BlockTree::Level& below, BlockTree::Level& level) {
  constexpr std::size_t kFan = BlockTree::kFan;
  level.allocate((below.count + kFan - 1) / kFan);
  for (std::size_t j = 0; j < level.count; ++j) {
    level.min_x[j] = lowest(below.min_x, j * kFan);
    level.min_y[j] = lowest(below.min_y, j * kFan);
    level.min_z[j] = lowest(below.min_z, j * kFan);
    level.max_x[j] = highest(below.max_x, j * kFan);
    level.max_y[j] = highest(below.max_y, j * kFan);
    level.max_z[j] = highest(below.max_z, j * kFan);
  }
}

}  // namespace

BlockTree::BlockTree(Level blocks) {
  levels_.push_back(std::move(blocks));
  while (levels_.size() < 2 || levels_.back().count > kFan) {
    Level level;
    groupBoxes(levels_.back(), level);
    levels_.push_back(std::move(level));
  }
}

std::size_t BlockTree::memoryBytes() const {
  std::size_t bytes = 0;
  for (const Level& level : levels_) bytes += level.min_x.size() * 6 * sizeof(float);
  return bytes;
}

namespace {

/** Depth-first walk down to a level, in ascending order there; hits(level, first child) is a bit
 * mask. */
template <typename Hits>
void walk(const std::vector<BlockTree::Level>& levels, std::size_t depth, std::size_t last,
          std::size_t first, const Hits& hits, std::vector<std::uint32_t>& found) {
  std::uint32_t mask = hits(levels[depth], first);
  while (mask != 0) {
    const auto bit = static_cast<std::size_t>(__builtin_ctz(mask));
    mask &= mask - 1;
    const std::size_t child = first + bit;
    if (depth == last) {
      found.push_back(static_cast<std::uint32_t>(child));
    } else {
      walk(levels, depth - 1, last, child * BlockTree::kFan, hits, found);
    }
  }
}

/** Entries of a level whose boxes meet a box. */
void collectInBox(const std::vector<BlockTree::Level>& levels, std::size_t last, const float min[3],
                  const float max[3], std::vector<std::uint32_t>& found) {
  if (levels.empty()) return;
  walk(
      levels, levels.size() - 1, last, 0,
      [&](const BlockTree::Level& level, std::size_t first) {
        return kernels::boxesInBox(level, first, min, max);
      },
      found);
}

}  // namespace

void BlockTree::blocksInBall(const float center[3], float radius,
                             std::vector<std::uint32_t>& blocks) const {
  if (levels_.empty()) return;
  walk(
      levels_, levels_.size() - 1, 0, 0,
      [&](const Level& level, std::size_t first) {
        return kernels::boxesInBall(level, first, center, radius);
      },
      blocks);
}

void BlockTree::blocksInBox(const float min[3], const float max[3],
                            std::vector<std::uint32_t>& blocks) const {
  collectInBox(levels_, 0, min, max, blocks);
}

void BlockTree::groupsInBox(const float min[3], const float max[3],
                            std::vector<std::uint32_t>& groups) const {
  collectInBox(levels_, 1, min, max, groups);
}

void BlockNeighborhood::collect(const BlockTree& tree, const float min[3], const float max[3]) {
  tree_ = &tree;
  ids_.clear();
  tree.groupsInBox(min, max, ids_);
  groups_.allocate(ids_.size());
  if (ids_.empty()) return;
  const BlockTree::Level& all = tree.levels()[1];
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    groups_.min_x[i] = all.min_x[ids_[i]];
    groups_.min_y[i] = all.min_y[ids_[i]];
    groups_.min_z[i] = all.min_z[ids_[i]];
    groups_.max_x[i] = all.max_x[ids_[i]];
    groups_.max_y[i] = all.max_y[ids_[i]];
    groups_.max_z[i] = all.max_z[ids_[i]];
  }
}

void BlockNeighborhood::blocksInBall(const float center[3], float radius, BlockList& blocks) const {
  blocks.clear();
  if (ids_.empty()) return;
  blocks.resize((ids_.size() + 1) * BlockTree::kFan);
  blocks.resize(kernels::groupedBoxesInBall(groups_, ids_.data(), tree_->levels().front(), center,
                                            radius, blocks.data()));
}

}  // namespace pcl_slim
