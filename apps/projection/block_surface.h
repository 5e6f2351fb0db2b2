// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/program.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/surface/slim_blocks.h"

namespace pcl_slim {

/** \brief A surface in blocks, of which only those about some points are read: it need not fit into
 * memory. */
class BlockSurface {
 public:
  using Blocks = std::vector<bool>;
  /** \brief Some of a cloud's points, and the blocks whose balls may contain them. */
  struct Part {
    std::vector<std::int32_t> rows;  ///< ascending; empty: all points
    Blocks blocks;
  };

  /** \brief Opens a file. \return whether it is one of blocks; other files are loaded whole. */
  bool open(const std::string& path);
  bool isOpen() const { return !boxes_.empty(); }
  std::size_t count() const { return boxes_.size(); }
  /** \brief A part without points and blocks. */
  Part none() const { return {{}, Blocks(boxes_.size())}; }
  /** \brief Most bytes that blocks in memory may take. */
  void setMostBytes(double bytes) { most_bytes_ = bytes; }

  /** \brief All points, and the blocks whose balls may contain some. O(points * blocks). */
  Part partOf(const CloudView& cloud) const;

  /** \brief Divides points along the Morton curve, so that the blocks of each part fit into memory:
   * into one part where possible. O(points * blocks), points log points where they are divided. */
  std::vector<Part> partsOf(const CloudView& cloud) const;

  /** \brief The surfels of a part's blocks. \return an error where memory is too small for them. */
  Result<SLIMSurface> load(const Part& part);

  /** \brief Prints and reports how many of the blocks were read. */
  void reportBlocks(Console& console, Report& report) const;

 private:
  template <typename Rows>
  void addBlocks(const CloudView& cloud, const Rows& rows, Blocks& blocks) const;
  double bytesOf(const Blocks& blocks) const;

  std::string path_;
  SlimBlockReader reader_;
  std::vector<WorldBox> boxes_;
  double most_bytes_ = 0;
};

}  // namespace pcl_slim
