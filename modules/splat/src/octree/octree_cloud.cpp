// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/splat/octree_cloud.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "octree/key_order.h"
#include "octree/point_blocks.h"

namespace pcl_slim {

using namespace detail;

namespace {

/** Resolutions that give about as many occupied cells as wanted: a surface's count grows with the
 * square of the resolution, and a coarse grid gives the factor. Neither the order of the points nor
 * how often one is given changes it. */
class AreaProbe {
 public:
  static OctreeFrame frameOver(const FiniteBox& box) {
    return {box.min, kCells / box.longest(), std::nextafter(static_cast<float>(kCells), 0.0f)};
  }

  /** blocks: in the cells of frameOver(). */
  template <typename T>
  explicit AreaProbe(const PointBlocks<T>& blocks) {
    std::vector<std::atomic<std::uint64_t>> seen((std::size_t{1} << 3 * kBits) / 64);
    blocks.forEach([&](std::size_t, const PointBlock& block) {
      for (std::size_t k = 0; k < block.count; ++k) {
        const auto at = [](float c) { return static_cast<std::uint32_t>(c); };
        const std::uint32_t cell =
            (at(block.x[k]) << kBits | at(block.y[k])) << kBits | at(block.z[k]);
        const std::uint64_t bit = std::uint64_t{1} << cell % 64;
        std::atomic<std::uint64_t>& word = seen[cell / 64];
        // Most cells are known already: threads seldom write.
        if ((word.load(std::memory_order_relaxed) & bit) == 0) {
          word.fetch_or(bit, std::memory_order_relaxed);
        }
      }
    });
    for (const auto& word : seen) {
      for (std::uint64_t bits = word; bits != 0; bits &= bits - 1) ++occupied_;
    }
  }

  int resolutionFor(double wanted) const {
    const double ratio = std::max(wanted, 1.0) / std::max(occupied_, 1.0);
    return static_cast<int>(std::clamp(std::round(kCells * std::sqrt(ratio)), 1.0, 65536.0));
  }

 private:
  static constexpr int kBits = 6;  ///< the grid has 64 cells an axis
  static constexpr double kCells = 1 << kBits;
  double occupied_ = 0;
};

}  // namespace

namespace detail {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite
  static constexpr double kWidest = 1e38;    ///< positions are floats relative to the box's corner
  static constexpr double kNarrowest = 1e-32;  ///< a millionth of it is a normal float

 public:
  OctreeCloudBuilder(const CloudView& cloud, const ColorView& colors, int threads)
      : view_(cloud), colors_(colors), threads_(threads) {}

  Result<OctreeCloud> run(const RootGrid& grid) {
    if (Error error = view_.validate()) return error;
    Error error = view_.scalar == CloudView::Scalar::kDouble ? runAs(readerOf<double>(view_), grid)
                                                             : runAs(readerOf<float>(view_), grid);
    if (error) return error;
    return std::move(out_);
  }

 private:
  template <typename T>
  Error runAs(const Reader<T>& read, const RootGrid& grid) {
    const FiniteBox box = measure(read, view_.count(), threads_, first_);
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
    if (const int finer = finerResolution(grid)) {
      chooseGrid(box, finer);
      sort(read);
    }
    out_.num_duplicates_ = box.finite - out_.order_.size();
    findRoots();
    return {};
  }

  template <typename T>
  PointBlocks<T> blocksIn(const OctreeFrame& frame, const Reader<T>& read) const {
    return {read, view_.count(), frame, first_, threads_};
  }

  static Error checkBox(const FiniteBox& box) {
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

  static int bitsOf(std::uint64_t value) {
    int bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
  }

  /** For a number of different points; without an area for a grid that is given or has one cell. */
  static int resolutionOf(const RootGrid& grid, const std::optional<AreaProbe>& area,
                          std::size_t points) {
    if (!area) return std::clamp(grid.resolution, 1, RootGrid::kMaxResolution);
    if (!(grid.points_per_root > 0)) return area->resolutionFor(grid.occupied);
    return area->resolutionFor(static_cast<double>(points) / grid.points_per_root);
  }

  /** Occupied cells of a grid 2^halvings times as fine. */
  double countCells(int halvings) const {
    const int shift = 3 * (out_.depth_ - halvings);
    double count = 1;
    for (std::size_t i = 1; i < out_.keys_.size(); ++i)
      count += (out_.keys_[i] ^ out_.keys_[i - 1]) >> shift != 0;
    return count;
  }

  /** A resolution for as many occupied cells as wanted where there are far fewer, because some points are
   * so far away that all others are in one cell of the probe; else 0. */
  int finerResolution(const RootGrid& grid) const {
    constexpr double kFew = 0.5;  // on surfaces and in volumes the probe is nearer to the count
    if (grid.resolution > 0 || !(out_.cell_ > 0)) return 0;
    const double wanted = grid.points_per_root > 0
                              ? static_cast<double>(out_.order_.size()) / grid.points_per_root
                              : grid.occupied;
    if (countCells(0) >= kFew * wanted) return 0;
    int halvings = 1;
    while (halvings < out_.depth_ && countCells(halvings) < wanted) ++halvings;
    const double factor = std::sqrt(wanted / countCells(halvings));
    const double resolution = std::ldexp(out_.resolution_ * factor, halvings);
    return static_cast<int>(
        std::clamp(std::round(resolution), 1.0, double{RootGrid::kMaxResolution}));
  }

  void chooseGrid(const FiniteBox& box, int resolution) {
    const double longest = box.longest();
    out_.resolution_ = longest > 0.0 ? resolution : 1;
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits - bitsOf(static_cast<std::uint64_t>(out_.resolution_ - 1));
    out_.frame_.origin = box.min;
    out_.frame_.scale = longest > 0.0 ? out_.resolution_ / longest : 0.0;
    out_.frame_.last = std::nextafter(static_cast<float>(out_.resolution_), 0.0f);
  }

  template <typename T>
  void sort(const Reader<T>& read) {
    const PointBlocks<T> blocks = blocksIn(out_.frame_, read);
    KeyOrder<T>(blocks, out_.depth_, threads_)
        .run(CanonicalOrder<T>(view_, colors_, read, blocks, out_.depth_), out_.keys_, out_.order_);
  }

  void findRoots() {
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

}  // namespace detail

Result<OctreeCloud> OctreeCloud::build(const CloudView& cloud, const RootGrid& grid, int threads,
                                       const ColorView& colors) {
  return OctreeCloudBuilder(cloud, colors, resolveThreads(threads)).run(grid);
}

double OctreeCloud::edge(int shift) const {
  return std::ldexp(1.0, shift - depth_);
}

std::array<double, 3> OctreeCloud::center(const std::array<float, 3>& position, int shift) const {
  const double width = edge(shift);
  std::array<double, 3> c;
  for (std::size_t a = 0; a < 3; ++a) c[a] = (std::floor(position[a] / width) + 0.5) * width;
  return c;
}

std::size_t OctreeCloud::rootOf(std::size_t point) const {
  const auto after = std::upper_bound(roots_.begin(), roots_.end() - 1, point,
                                      [](std::size_t p, const Root& r) { return p < r.begin; });
  return static_cast<std::size_t>(after - roots_.begin()) - 1;
}

std::size_t OctreeCloud::countCells(int growth) const {
  std::size_t count = 1;
  for (std::size_t r = 1; r < numRoots(); ++r) {
    count += (roots_[r].key ^ roots_[r - 1].key) >> 3 * growth != 0;
  }
  return count;
}

}  // namespace pcl_slim
