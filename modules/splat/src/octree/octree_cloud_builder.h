// SPDX-License-Identifier: BSD-3-Clause
// Step 1 of docs/color_octree_splat_sampler.md: the grid over the cloud, and its points in the
// order of cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "octree/octree_grid.h"
#include "octree/octree_key.h"
#include "octree/point_blocks.h"
#include "octree/run_placement.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "points/point_runs.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite

 public:
  OctreeCloudBuilder(const CloudView& cloud, int threads) : view_(cloud), threads_(threads) {}

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
    if (longest > 0.0) {
      const octree_grid::AreaProbe probe(read, view_.count(), box);
      out_.resolution_ = grid.resolution > 0 ? std::min(grid.resolution, RootGrid::kMaxResolution)
                                             : probe.resolutionFor(grid.occupied);
      join_ = probe.isCoherent();
      const int fine = probe.resolutionFor(static_cast<double>(box.finite) / grid.per_key);
      while (out_.resolution_ << wanted_depth_ < fine) ++wanted_depth_;
    }
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits - bitsOf(static_cast<std::uint64_t>(out_.resolution_ - 1));
    out_.frame_.origin = box.min;
    out_.frame_.scale = longest > 0.0 ? out_.resolution_ / longest : 0.0;
    out_.frame_.last = std::nextafter(static_cast<float>(out_.resolution_), 0.0f);
  }

  /** Sorts as many bits of the keys as fit into one number with the index, up to those wanted. */
  template <typename T>
  void sort(const PointBlocks<T>& blocks)
  {
    const int index_bits = std::max(1, bitsOf(view_.count() - 1));
    const int root_bits = 3 * (OctreeCloud::kBits - out_.depth_);
    const int spare_bits = 64 - index_bits - root_bits;
    out_.index_bits_ = index_bits;
    if (spare_bits < 0) return sortWide(blocks);
    out_.sorted_depth_ = std::min({spare_bits / 3, wanted_depth_, out_.depth_});
    const bool join = join_ && out_.sorted_depth_ == 0 && spare_bits >= RunFormat::kCountBits;
    sortPacked(blocks, {index_bits, join ? RunFormat::kCountBits : 0}, root_bits);
  }

  /** Runs of points in one number each. */
  template <typename T>
  void sortPacked(const PointBlocks<T>& blocks, RunFormat format, int root_bits)
  {
    AlignedVector<std::uint64_t> runs(first_.back());
    const auto ends = blocks.forEach([&](std::size_t place, const PointBlock& block) {
      std::uint64_t points[PointBlock::kSize];
      splat_kernels::packKeys(block.x, block.y, block.z, block.index, PointBlock::kSize,
                              out_.sorted_depth_, format.index_bits, format.count_bits, points);
      return format.join(points, block.count, runs.data() + place);
    });
    std::vector<Stretch> filled(ends.size());
    for (std::size_t s = 0; s < ends.size(); ++s) filled[s] = {first_[s], ends[s]};
    const int root_bit = format.keyBit() + 3 * out_.sorted_depth_;
    sortByBits(runs, filled, format.keyBit(), root_bit + root_bits, threads_);
    placePoints(runs.size(), [&](std::size_t i) {
      return PointRun{runs[i] >> root_bit, format.first(runs[i]), format.count(runs[i])};
    });
    if (out_.sorted_depth_ > 0) out_.keys_ = std::move(runs);
  }

  /** Grids so fine that key and index do not fit into one number. */
  template <typename T>
  void sortWide(const PointBlocks<T>& blocks)
  {
    AlignedVector<std::uint64_t> keys(first_.back());
    AlignedVector<std::uint32_t> indices(first_.back()), order;
    blocks.forEach([&](std::size_t place, const PointBlock& block) {
      for (std::size_t k = 0; k < block.count; ++k) {
        keys[place + k] = mortonKey({block.x[k], block.y[k], block.z[k]}, out_.depth_);
        indices[place + k] = block.index[k];
      }
      return block.count;
    });
    sortByKey(keys, order, threads_);
    placePoints(keys.size(), [&](std::size_t i) {
      return PointRun{keys[i] >> 3 * out_.depth_, indices[order[i]], 1};
    });
  }

  template <typename RunOf>
  void placePoints(std::size_t runs, const RunOf& runOf)
  {
    const bool joined = runs < first_.back();
    RunPlacement<RunOf>(runs, joined, runOf, threads_).write(out_.order_, out_.roots_);
  }

  const CloudView& view_;
  int threads_;
  int wanted_depth_ = 0;            ///< halvings below roots that keys had better resolve
  bool join_ = false;               ///< whether points of one root follow each other
  std::vector<std::size_t> first_;  ///< finite points before each slice
  OctreeCloud out_;
};

}  // namespace pcl_slim::detail
