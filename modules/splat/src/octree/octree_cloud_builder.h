// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include "octree/octree_grid.h"
#include "octree/octree_key.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "points/point_runs.h"
#include "points/splat_kernels.h"

namespace pcl_slim::detail {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr std::uint32_t kTooMany = 0xffffffffu;
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite

 public:
  OctreeCloudBuilder(const CloudView& cloud, int threads) : view_(cloud), threads_(threads) {}

  Result<OctreeCloud> run(const RootGrid& grid)
  {
    if (Error error = checkInput()) return error;
    Error error = view_.scalar == CloudView::Scalar::kDouble
                      ? runAs(octree_grid::readerOf<double>(view_), grid)
                      : runAs(octree_grid::readerOf<float>(view_), grid);
    if (error) return error;
    return std::move(out_);
  }

 private:
  Error checkInput() const
  {
    const std::size_t n = view_.count();
    if (n == 0 || view_.xyz == nullptr) {
      return {ErrorCode::kBadInput, "the cloud has no points: give one that has"};
    }
    if (n >= kTooMany) {
      return {ErrorCode::kBadInput, "the cloud has more than 2^32 - 2 points: split it"};
    }
    for (std::size_t i = 0; view_.indices != nullptr && i < n; ++i) {
      if (view_.indices[i] < 0 || static_cast<std::size_t>(view_.indices[i]) >= view_.size) {
        return {ErrorCode::kBadArgument, "index " + std::to_string(view_.indices[i]) +
                                             " lies outside the cloud of " +
                                             std::to_string(view_.size) + " points"};
      }
    }
    return {};
  }

  template <typename T>
  Error runAs(const octree_grid::Reader<T>& read, const RootGrid& grid)
  {
    const octree_grid::Box box = octree_grid::measure(read, view_.count(), threads_, first_);
    if (box.finite == 0) {
      return {ErrorCode::kBadInput,
              "every point of the cloud is NaN or infinite: nothing to work on"};
    }
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::max(std::abs(box.min[a]), std::abs(box.max[a])) > kLargest) {
        return {ErrorCode::kBadInput, "some coordinates are beyond 1e150: remove those points"};
      }
    }
    out_.num_non_finite_ = view_.count() - box.finite;
    chooseGrid(read, box, grid);
    const int index_bits = std::max(1, bitsOf(view_.count() - 1));
    const int root_bits = 3 * (OctreeCloud::kBits - out_.depth_);
    const int spare_bits = 64 - index_bits - root_bits;
    out_.index_bits_ = index_bits;
    if (spare_bits < 0) {
      sortWide(read);
      return {};
    }
    out_.sorted_depth_ = std::min({spare_bits / 3, wanted_depth_, out_.depth_});
    const bool join = join_ && out_.sorted_depth_ == 0 && spare_bits >= RunFormat::kCountBits;
    sortPacked(read, {index_bits, join ? RunFormat::kCountBits : 0}, root_bits);
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

  /** Positions of some finite points, and their indices. */
  struct Block {
    static constexpr std::size_t kSize = 256;

    alignas(64) float x[kSize] = {}, y[kSize] = {}, z[kSize] = {};
    alignas(64) std::uint32_t index[kSize] = {};
    std::size_t count = 0;
  };

  /** Runs body(place, block) for the finite points in blocks. body returns how many places it filled;
   * each slice of points has as many as points, from first_ on. \return where those filled end. */
  template <typename T, typename Body>
  std::vector<std::size_t> forEachBlock(const octree_grid::Reader<T>& read, const Body& body) const
  {
    const bool all = first_.back() == view_.count();
    std::vector<std::size_t> ends(first_.size() - 1);
    octree_grid::forEachSlice(view_.count(), threads_,
                              [&](std::size_t s, std::size_t begin, std::size_t end) {
                                std::size_t place = first_[s];
                                Block block;
                                for (; begin < end; begin += Block::kSize) {
                                  const std::size_t last = std::min(end, begin + Block::kSize);
                                  if (all && last - begin == Block::kSize && last < view_.count() &&
                                      fillWhole(read, begin, block)) {
                                    block.count = Block::kSize;
                                  } else if (all) {
                                    fill<true>(read, begin, last, block);
                                  } else {
                                    fill<false>(read, begin, last, block);
                                  }
                                  place += body(place, block);
                                }
                                ends[s] = place;
                              });
    return ends;
  }

  /** fill() for a block of finite points with others behind it, four at a time. \return false where
   * their layout does not allow that. */
  template <typename T>
  bool fillWhole(const octree_grid::Reader<T>& read, std::size_t begin, Block& block) const
  {
    if (!std::is_same_v<T, float> || read.indices || read.stride < 4 * sizeof(float)) return false;
    std::iota(block.index, block.index + Block::kSize, static_cast<std::uint32_t>(begin));
    splat_kernels::gatherVectors(read.base, read.stride, block.index, Block::kSize, block.x,
                                 block.y, block.z);
    splat_kernels::toCells(out_.frame_, block.x, block.y, block.z, Block::kSize);
    return true;
  }

  template <bool kAllFinite, typename T>
  void fill(const octree_grid::Reader<T>& read, std::size_t begin, std::size_t end,
            Block& block) const
  {
    std::size_t k = 0;
    for (std::size_t i = begin; i < end; ++i) {
      T p[3];
      read(i, p);
      if (!kAllFinite && !octree_grid::isFinite(p)) continue;
      float q[3] = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
      if constexpr (std::is_same_v<T, double>) out_.frame_.position(p, q);
      block.x[k] = q[0], block.y[k] = q[1], block.z[k] = q[2];
      block.index[k++] = static_cast<std::uint32_t>(i);
    }
    block.count = k;
    if constexpr (std::is_same_v<T, float>) {
      splat_kernels::toCells(out_.frame_, block.x, block.y, block.z, Block::kSize);
    }
  }

  /** Runs of points in numbers. */
  template <typename T>
  void sortPacked(const octree_grid::Reader<T>& read, RunFormat format, int root_bits)
  {
    AlignedVector<std::uint64_t> runs(first_.back());
    const auto ends = forEachBlock(read, [&](std::size_t place, const Block& block) {
      std::uint64_t points[Block::kSize];
      splat_kernels::packKeys(block.x, block.y, block.z, block.index, Block::kSize,
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
  void sortWide(const octree_grid::Reader<T>& read)
  {
    AlignedVector<std::uint64_t> keys(first_.back());
    AlignedVector<std::uint32_t> indices(first_.back()), order;
    forEachBlock(read, [&](std::size_t place, const Block& block) {
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

  /** Lists points and roots; runOf(i): the i-th run in the order of roots. */
  template <typename RunOf>
  void placePoints(std::size_t runs, const RunOf& runOf)
  {
    const bool joined = runs < first_.back();
    std::vector<std::size_t> places((runs + octree_grid::kSlice - 1) / octree_grid::kSlice + 1, 0);
    octree_grid::forEachSlice(runs, threads_,
                              [&](std::size_t s, std::size_t begin, std::size_t end) {
                                std::size_t points = joined ? 0 : end - begin;
                                for (std::size_t i = begin; i < end && joined; ++i)
                                  points += runOf(i).count;
                                places[s + 1] = points;
                              });
    std::partial_sum(places.begin(), places.end(), places.begin());
    out_.order_.resize(places.back());
    std::vector<std::vector<OctreeCloud::Root>> parts(places.size() - 1);
    octree_grid::forEachSlice(
        runs, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
          std::vector<OctreeCloud::Root> roots;
          std::uint32_t* place = out_.order_.data() + places[s];
          std::uint32_t* const last_place = out_.order_.data() + places[s + 1];
          std::uint64_t last = begin > 0 ? runOf(begin - 1).root : ~runOf(begin).root;
          for (std::size_t i = begin; i < end; ++i) {
            const PointRun run = runOf(i);
            if (run.root != last) {
              const auto at = static_cast<std::uint32_t>(place - out_.order_.data());
              roots.push_back({run.root, at});
              last = run.root;
            }
            if (joined) {
              place = run.list(place, last_place);
            } else {
              *place++ = run.first;
            }
          }
          parts[s] = std::move(roots);
        });
    out_.roots_.clear();
    for (const auto& part : parts) out_.roots_.insert(out_.roots_.end(), part.begin(), part.end());
    out_.roots_.push_back({~std::uint64_t{0}, static_cast<std::uint32_t>(out_.size())});
  }

  const CloudView& view_;
  int threads_;
  int wanted_depth_ = 0;            ///< halvings below roots that keys had better resolve
  bool join_ = false;               ///< whether points of one root follow each other
  std::vector<std::size_t> first_;  ///< finite points before each slice
  OctreeCloud out_;
};

}  // namespace pcl_slim::detail
