// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** Where points come from. */
struct OctreeSource {
  const CloudView& cloud;
  const ColorView& colors;
  const LabTable& table;
};

/** A stretch of a cloud's points along its curve, brought together in memory as columns; points are
 * named by their places in the whole cloud. Windows of two threads share no cache line. */
class alignas(64) PointWindow {
 public:
  enum Column { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kL, kA, kB, kNumColumns };

  /** Fetches the points [begin, end): positions in root cells from the grid's low corner; normals
   * of unit length, or zero where a point has none; CIELAB, or zero where the cloud has none. */
  void load(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
            std::size_t end);
  /** The same with up to reach points more on either side. */
  void loadAround(const OctreeCloud& cloud, const OctreeSource& source, std::size_t begin,
                  std::size_t end, std::size_t reach);

  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }

  /** One column from the i-th point of the cloud on. */
  const float* column(int c, std::size_t i) const
  {
    return columns_[static_cast<std::size_t>(c)].data() + (i - begin_);
  }
  /** Three columns of one point. */
  std::array<float, 3> vector(Column first, std::size_t i) const
  {
    return {*column(first, i), *column(first + 1, i), *column(first + 2, i)};
  }
  std::array<float, 3> position(std::size_t i) const { return vector(kX, i); }
  std::array<float, 3> normal(std::size_t i) const { return vector(kNormalX, i); }
  std::array<float, 3> lab(std::size_t i) const { return vector(kL, i); }
  /** The i of CloudView::inputIndex(i). */
  std::uint32_t order(std::size_t i) const { return order_[i - begin_]; }

 private:
  /** Fills order_. \return places in the caller's arrays. */
  const std::uint32_t* fetchOrder(const OctreeCloud& cloud, const OctreeSource& source);

  std::array<AlignedVector<float>, kNumColumns> columns_;
  AlignedVector<std::uint32_t> order_, inputs_;  ///< inputs: places in the caller's arrays
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace pcl_slim::detail
