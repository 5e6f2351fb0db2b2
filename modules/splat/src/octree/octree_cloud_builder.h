// SPDX-License-Identifier: BSD-3-Clause
// Step 1 of docs/color_octree_splat_sampler.md: the grid over the cloud, and its points in the
// order of cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree/area_probe.h"
#include "octree/canonical_order.h"
#include "octree/octree_grid.h"
#include "octree/point_blocks.h"
#include "octree/point_sample.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/core/parallel.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite
  static constexpr double kWidest = 1e38;    ///< splats are told in floats from the box's corner

 public:
  OctreeCloudBuilder(const CloudView& cloud, const ColorView& colors, int threads)
      : view_(cloud), colors_(colors), threads_(threads)
  {
  }

  Result<OctreeCloud> run(const RootGrid& grid)
  {
    if (Error error = view_.validate()) return error;
    Error error = view_.scalar == CloudView::Scalar::kDouble
                      ? runAs(octree_grid::readerOf<double>(view_), grid)
                      : runAs(octree_grid::readerOf<float>(view_), grid);
    if (error) return error;
    return std::move(out_);
  }

 private:
  template <typename T>
  Error runAs(const octree_grid::Reader<T>& read, const RootGrid& grid)
  {
    const octree_grid::Box box = octree_grid::measure(read, view_.count(), threads_, first_);
    if (Error error = checkBox(box)) return error;
    out_.num_non_finite_ = view_.count() - box.finite;
    chooseGrid(read, box, grid);
    sort(PointBlocks<T>(read, view_.count(), out_.frame_, first_, threads_));
    CanonicalOrder<T>(view_, colors_, read).apply(out_.keys_, out_.order_);
    out_.num_duplicates_ = box.finite - out_.order_.size();
    findRoots();
    return {};
  }

  static Error checkBox(const octree_grid::Box& box)
  {
    if (box.finite == 0) return CloudView::nothingFinite();
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::max(std::abs(box.min[a]), std::abs(box.max[a])) > kLargest) {
        return badInput("some coordinates are beyond 1e150: remove those points");
      }
    }
    if (box.longest() > kWidest) {
      return badInput(
          "the points span more than 1e38, which splats, being floats, cannot tell: "
          "scale the cloud, or remove the farthest points");
    }
    return {};
  }

  static int bitsOf(std::uint64_t value)
  {
    int bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
  }

  template <typename T>
  void chooseGrid(const octree_grid::Reader<T>& read, const octree_grid::Box& box,
                  const RootGrid& grid)
  {
    const double longest = box.longest();
    out_.resolution_ = 1;
    if (longest > 0.0) out_.resolution_ = resolutionOf(read, box, grid);
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits - bitsOf(static_cast<std::uint64_t>(out_.resolution_ - 1));
    out_.frame_.origin = box.min;
    out_.frame_.scale = longest > 0.0 ? out_.resolution_ / longest : 0.0;
    out_.frame_.last = std::nextafter(static_cast<float>(out_.resolution_), 0.0f);
  }

  template <typename T>
  int resolutionOf(const octree_grid::Reader<T>& read, const octree_grid::Box& box,
                   const RootGrid& grid) const
  {
    if (grid.resolution > 0) return std::min(grid.resolution, RootGrid::kMaxResolution);
    const PlaceSample sample(read, view_.count(), box.finite, threads_);
    const double wanted =
        grid.points_per_root > 0 ? sample.distinct() / grid.points_per_root : grid.occupied;
    return AreaProbe(read, sample, box).resolutionFor(wanted);
  }

  /** Sorts all points by their keys, those of one key in their owner's order. */
  template <typename T>
  void sort(const PointBlocks<T>& blocks)
  {
    AlignedVector<std::uint32_t> points(first_.back());
    out_.keys_.resize(first_.back());
    blocks.forEach([&](std::size_t place, const PointBlock& block) {
      std::uint64_t keys[PointBlock::kSize];
      splat_kernels::mortonKeys(block.x, block.y, block.z, PointBlock::kSize, out_.depth_, keys);
      std::copy_n(keys, block.count, out_.keys_.data() + place);
      std::copy_n(block.index, block.count, points.data() + place);
    });
    sortByKey(out_.keys_, out_.order_, threads_);
    parallelFor(points.size(), threads_, octree_grid::kSlice,
                [&](std::size_t i, int) { out_.order_[i] = points[out_.order_[i]]; });
  }

  void findRoots()
  {
    const std::size_t n = out_.keys_.size();
    const int below = 3 * out_.depth_;
    out_.roots_.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint64_t root = out_.keys_[i] >> below;
      if (i > 0 && root == out_.roots_.back().key) continue;
      out_.roots_.push_back({root, static_cast<std::uint32_t>(i)});
    }
    out_.roots_.push_back({~std::uint64_t{0}, static_cast<std::uint32_t>(n)});
  }

  const CloudView& view_;
  ColorView colors_;
  int threads_;
  std::vector<std::size_t> first_;  ///< finite points before each slice
  OctreeCloud out_;
};

}  // namespace pcl_slim::detail
