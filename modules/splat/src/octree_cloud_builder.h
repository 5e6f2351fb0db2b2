// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include "octree_grid.h"
#include "octree_key.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/splat/octree_cloud.h"
#include "splat_kernels.h"

namespace pcl_slim {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr std::uint32_t kTooMany = 0xffffffffu;
  static constexpr double kSortedPoints = 4.0;  ///< that share a cell of the level keys resolve
  static constexpr double kLargest = 1e150;     ///< squares of such coordinates are still finite

 public:
  /** box: that of the cloud where it is known, else null. */
  OctreeCloudBuilder(const CloudView& cloud, int threads, const octree_grid::Box* box = nullptr)
      : view_(cloud), threads_(threads), known_box_(box)
  {
  }

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
    const octree_grid::Box box = boxOf(read);
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
    const int root_bits = OctreeCloud::kBits - out_.depth_;
    const int spare_bits = (64 - index_bits) / 3 - root_bits;
    if (spare_bits >= 0) {
      out_.index_bits_ = index_bits;
      out_.mask_ = (std::uint64_t{1} << index_bits) - 1;
      out_.sorted_depth_ = std::min({spare_bits, wanted_depth_, out_.depth_});
      sortPacked(read);
    } else {
      sortWide(read);
    }
    return {};
  }

  template <typename T>
  octree_grid::Box boxOf(const octree_grid::Reader<T>& read)
  {
    const std::size_t n = view_.count();
    if (!known_box_ || known_box_->finite < n) {
      return octree_grid::measure(read, n, threads_, first_);
    }
    first_.assign(1, 0);
    while (first_.back() < n) first_.push_back(std::min(n, first_.back() + octree_grid::kSlice));
    return *known_box_;
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
      // What lies below is put in order only where it is divided.
      const int fine = probe.resolutionFor(static_cast<double>(box.finite) / kSortedPoints);
      while (out_.resolution_ << wanted_depth_ < fine && wanted_depth_ < grid.halvings) {
        ++wanted_depth_;
      }
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

  /** Runs body(place, block) for the finite points in blocks; place counts points. */
  template <typename T, typename Body>
  void forEachBlock(const octree_grid::Reader<T>& read, const Body& body) const
  {
    const bool all = first_.back() == view_.count();
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
                                  body(place, block);
                                  place += block.count;
                                }
                              });
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

  /** Key and index of a point in one number. */
  template <typename T>
  void sortPacked(const octree_grid::Reader<T>& read)
  {
    AlignedVector<std::uint64_t>& packed = out_.packed_;
    packed.resize(first_.back());
    const int index_bits = out_.index_bits_;
    forEachBlock(read, [&](std::size_t place, const Block& block) {
      std::uint64_t numbers[Block::kSize];
      splat_kernels::packKeys(block.x, block.y, block.z, block.index, Block::kSize,
                              out_.sorted_depth_, index_bits, numbers);
      std::copy_n(numbers, block.count, packed.data() + place);
    });
    const int root_bit = out_.keyBit(out_.depth_);
    sortByBits(packed, index_bits, root_bit + 3 * (OctreeCloud::kBits - out_.depth_), threads_);
    findRoots([values = packed.data(), root_bit](std::size_t i) { return values[i] >> root_bit; });
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
    });
    sortByKey(keys, order, threads_);
    out_.sorted_depth_ = -1;
    out_.mask_ = ~std::uint64_t{0};
    out_.packed_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) out_.packed_[i] = indices[order[i]];
    findRoots([&](std::size_t i) { return keys[i] >> 3 * out_.depth_; });
  }

  template <typename KeyOf>
  void findRoots(const KeyOf& keyOf)
  {
    const std::size_t n = out_.size();
    std::vector<std::vector<OctreeCloud::Root>> parts(n / octree_grid::kSlice + 1);
    octree_grid::forEachSlice(n, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
      std::uint64_t last = begin > 0 ? keyOf(begin - 1) : ~keyOf(begin);
      auto& roots = parts[s];
      for (std::size_t i = begin; i < end; ++i) {
        constexpr std::size_t kStep = 8;  // numbers in order that end as they began are one root's
        if (i + kStep < end && keyOf(i + kStep) == last) {
          i += kStep;
          continue;
        }
        const std::uint64_t key = keyOf(i);
        if (key == last) continue;
        roots.push_back({key, static_cast<std::uint32_t>(i)});
        last = key;
      }
    });
    out_.roots_.clear();
    for (const auto& part : parts) out_.roots_.insert(out_.roots_.end(), part.begin(), part.end());
    out_.roots_.push_back({~std::uint64_t{0}, static_cast<std::uint32_t>(n)});
  }

  const CloudView& view_;
  int threads_;
  const octree_grid::Box* known_box_;
  int wanted_depth_ = 0;            ///< halvings below roots that keys had better resolve
  std::vector<std::size_t> first_;  ///< finite points before each slice
  OctreeCloud out_;
};

}  // namespace pcl_slim
