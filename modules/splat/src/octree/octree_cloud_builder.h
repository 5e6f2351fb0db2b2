// SPDX-License-Identifier: BSD-3-Clause
// Step 1 of docs/color_octree_splat_sampler.md: the grid over the cloud, and its points in the
// order of cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "octree/area_probe.h"
#include "octree/canonical_order.h"
#include "octree/key_order.h"
#include "octree/octree_grid.h"
#include "octree/point_blocks.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite
  static constexpr double kWidest = 1e38;    ///< positions are floats relative to the box's corner
  static constexpr double kNarrowest = 1e-32;  ///< a millionth of it is a normal float

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
    const bool one_place = !(box.longest() > 0.0);
    std::optional<AreaProbe> area;
    if (!one_place && grid.resolution == 0) {
      area.emplace(blocksIn(AreaProbe::frameOver(box), read));
    }
    const int first = resolutionOf(grid, area, box.finite);
    chooseGrid(box, first);
    sort(read);
    // Repeated points are known by now: the grid is that of the others.
    const int resolution = resolutionOf(grid, area, out_.order_.size());
    if (resolution != first) {
      chooseGrid(box, resolution);
      sort(read);
    }
    out_.num_duplicates_ = box.finite - out_.order_.size();
    findRoots();
    return {};
  }

  template <typename T>
  PointBlocks<T> blocksIn(const OctreeFrame& frame, const octree_grid::Reader<T>& read) const
  {
    return {read, view_.count(), frame, first_, threads_};
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
    if (box.longest() > 0.0 && box.longest() < kNarrowest) {
      return badInput(
          "the points span less than 1e-32, which splats, being floats, cannot tell: scale the "
          "cloud");
    }
    return {};
  }

  static int bitsOf(std::uint64_t value)
  {
    int bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
  }

  /** For so many different points; without an area for a grid that is given or has one cell. */
  static int resolutionOf(const RootGrid& grid, const std::optional<AreaProbe>& area,
                          std::size_t points)
  {
    if (!area) return std::clamp(grid.resolution, 1, RootGrid::kMaxResolution);
    if (!(grid.points_per_root > 0)) return area->resolutionFor(grid.occupied);
    return area->resolutionFor(static_cast<double>(points) / grid.points_per_root);
  }

  void chooseGrid(const octree_grid::Box& box, int resolution)
  {
    const double longest = box.longest();
    out_.resolution_ = longest > 0.0 ? resolution : 1;
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits - bitsOf(static_cast<std::uint64_t>(out_.resolution_ - 1));
    out_.frame_.origin = box.min;
    out_.frame_.scale = longest > 0.0 ? out_.resolution_ / longest : 0.0;
    out_.frame_.last = std::nextafter(static_cast<float>(out_.resolution_), 0.0f);
  }

  template <typename T>
  void sort(const octree_grid::Reader<T>& read)
  {
    const PointBlocks<T> blocks = blocksIn(out_.frame_, read);
    KeyOrder<T>(blocks, out_.depth_, threads_)
        .run(CanonicalOrder<T>(view_, colors_, read, blocks, out_.depth_), out_.keys_, out_.order_);
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
