// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "octree_grid.h"
#include "octree_key.h"
#include "pcl_slim/cloud/morton_sort.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim {

/** The steps of OctreeCloud::build. */
class OctreeCloudBuilder {
  static constexpr std::uint32_t kTooMany = 0xffffffffu;
  static constexpr double kLargest = 1e150;  ///< squares of such coordinates are still finite
  static constexpr double kSortedPoints =
      8.0;  ///< to share a cell of the depth points are sorted to

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
    const int index_bits = bitsOf(view_.count() - 1);
    const int root_bits = OctreeCloud::kBits - out_.depth_;
    if (3 * root_bits + index_bits <= 64) {
      sorted_depth_ = std::min(sorted_depth_, (64 - index_bits) / 3 - root_bits);
      sortPacked(read, index_bits);
    } else {
      sortWide(read);
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
      const int fine = probe.resolutionFor(static_cast<double>(box.finite) / kSortedPoints);
      while (out_.resolution_ << sorted_depth_ < fine) ++sorted_depth_;
    }
    out_.cell_ = longest / out_.resolution_;
    out_.depth_ = OctreeCloud::kBits - bitsOf(static_cast<std::uint64_t>(out_.resolution_ - 1));
    out_.frame_.origin = box.min;
    out_.frame_.scale = longest > 0.0 ? out_.resolution_ / longest : 0.0;
    out_.frame_.last = std::nextafter(static_cast<float>(out_.resolution_), 0.0f);
  }

  /** Runs body(place, i, position) for the finite points; place counts them. */
  template <typename T, typename Body>
  void forEachFinite(const octree_grid::Reader<T>& read, const Body& body) const
  {
    const bool all = first_.back() == view_.count();
    octree_grid::forEachSlice(view_.count(), threads_,
                              [&](std::size_t s, std::size_t begin, std::size_t end) {
                                std::size_t at = first_[s];
                                for (std::size_t i = begin; i < end; ++i) {
                                  T p[3];
                                  read(i, p);
                                  if (!all && !octree_grid::isFinite(p)) continue;
                                  float position[3];
                                  out_.frame_.position(p, position);
                                  body(at++, i, position);
                                }
                              });
  }

  /** Key and index of a point in one number. */
  template <typename T>
  void sortPacked(const octree_grid::Reader<T>& read, int index_bits)
  {
    AlignedVector<std::uint64_t> packed(first_.back());
    const int depth = std::min(sorted_depth_, out_.depth_);
    const MortonKeys keys(OctreeCloud::kBits - out_.depth_ + depth, depth);
    forEachFinite(read, [&](std::size_t at, std::size_t i, const float position[3]) {
      packed[at] = keys(position) << index_bits | i;
    });
    const int key_bits = 3 * (OctreeCloud::kBits - out_.depth_ + depth);
    sortByBits(packed, index_bits, index_bits + key_bits, threads_);
    const std::uint64_t mask = (std::uint64_t{1} << index_bits) - 1;
    finish(
        packed.size(), [&](std::size_t i) { return packed[i] >> index_bits >> 3 * depth; },
        [&](std::size_t i) { return static_cast<std::uint32_t>(packed[i] & mask); });
  }

  /** Grids so fine that key and index do not fit into one number. */
  template <typename T>
  void sortWide(const octree_grid::Reader<T>& read)
  {
    AlignedVector<std::uint64_t> keys(first_.back());
    order_.resize(first_.back());
    forEachFinite(read, [&](std::size_t at, std::size_t i, const float position[3]) {
      keys[at] = mortonKey(position, out_.depth_);
      order_[at] = static_cast<std::uint32_t>(i);
    });
    sortByKey(keys, order_, threads_);
    finish(
        keys.size(), [&](std::size_t i) { return keys[i] >> 3 * out_.depth_; },
        [&](std::size_t i) { return order_[i]; });
  }

  /** Writes order and roots. */
  template <typename KeyOf, typename OrderOf>
  void finish(std::size_t n, const KeyOf& keyOf, const OrderOf& orderOf)
  {
    out_.order_.resize(n);
    std::vector<std::vector<OctreeCloud::Root>> parts(n / octree_grid::kSlice + 1);
    octree_grid::forEachSlice(n, threads_, [&](std::size_t s, std::size_t begin, std::size_t end) {
      std::uint64_t last = begin > 0 ? keyOf(begin - 1) : ~keyOf(begin);
      for (std::size_t i = begin; i < end; ++i) {
        out_.order_[i] = orderOf(i);
        const std::uint64_t key = keyOf(i);
        if (key != last) parts[s].push_back({key, static_cast<std::uint32_t>(i)});
        last = key;
      }
    });
    out_.roots_.clear();
    for (const auto& part : parts) out_.roots_.insert(out_.roots_.end(), part.begin(), part.end());
    out_.roots_.push_back({~std::uint64_t{0}, static_cast<std::uint32_t>(n)});
  }

  const CloudView& view_;
  int threads_;
  int sorted_depth_ = 0;            ///< halvings below roots that the order resolves
  std::vector<std::size_t> first_;  ///< finite points before each slice
  OctreeCloud out_;
  AlignedVector<std::uint32_t> order_;
};

}  // namespace pcl_slim
