// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "octree_grid.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

/** A copy of a cloud in the order of coarse cells.
 *
 * Points in random order are brought together from all over memory. Where they are more than caches
 * and their page tables hold, a copy made by reading them once in their own order and writing each
 * behind others of its cell costs less than that. */
class StagedCloud {
 public:
  StagedCloud() = default;
  StagedCloud(const StagedCloud&) = delete;  ///< views name the copy's memory
  StagedCloud& operator=(const StagedCloud&) = delete;
  StagedCloud(StagedCloud&&) = default;
  StagedCloud& operator=(StagedCloud&&) = default;

  /** The copy, or nothing where it would not pay: few points, points already near those before
   * them, chosen indices, or nothing to order. 32 bytes a point (48 of doubles) and 2 while it is
   * made. The same copy for any number of threads. */
  static std::optional<StagedCloud> of(const CloudView& cloud, const ColorView& colors,
                                       int threads);

  CloudView view() const { return view_; }
  ColorView colors() const { return colors_; }
  const octree_grid::Box& box() const { return box_; }
  /** Where the i-th point of the copy came from. */
  std::uint32_t input(std::size_t i) const;

 private:
  template <typename T>
  struct Record;
  template <typename T>
  class Writer;

  template <typename T>
  static std::optional<StagedCloud> copyOf(const CloudView& cloud, const ColorView& colors,
                                           int threads);

  AlignedVector<unsigned char> records_;
  std::size_t index_offset_ = 0;
  CloudView view_;
  ColorView colors_;
  octree_grid::Box box_;
};

}  // namespace pcl_slim
