// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "octree/point_blocks.h"
#include "pcl_slim/cloud/cloud_view.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** Orders points that the leading bits of keys do not tell apart by their whole keys and then by what
 * they are, and keeps one of those that are equal in place, normal and colour, so that nothing depends
 * on the order in which their owner has them. One per thread: it keeps its scratch memory. */
template <typename T>
class CanonicalOrder {
 public:
  CanonicalOrder(const CloudView& cloud, const ColorView& colors,
                 const octree_grid::Reader<T>& read, const PointBlocks<T>& blocks, int depth)
      : cloud_(cloud), colors_(colors), read_(read), blocks_(blocks), depth_(depth)
  {
  }

  /** Brings n points and their keys into that order, those kept to the front. \return how many */
  std::size_t arrange(std::uint64_t* keys, std::uint32_t* points, std::size_t n)
  {
    entries_.clear();
    for (std::size_t first = 0; first < n; first += PointBlock::kSize) {
      addEntries(points + first, std::min(PointBlock::kSize, n - first));
    }
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      keys[i] = entries_[i].key;
      points[i] = entries_[i].point;
    }
    return entries_.size();
  }

 private:
  /** What tells points apart, in the order in which it is compared; the point comes last. */
  struct Entry {
    std::uint64_t key;
    std::array<T, 3> place;
    std::array<unsigned char, 3 * sizeof(float) + 3> look;  ///< normal and colour
    std::uint32_t point;

    bool operator==(const Entry& other) const { return place == other.place && look == other.look; }
    bool operator<(const Entry& other) const
    {
      if (key != other.key) return key < other.key;
      if (place != other.place) return place < other.place;
      return look != other.look ? look < other.look : point < other.point;
    }
  };

  void addEntries(const std::uint32_t* points, std::size_t n)
  {
    std::uint64_t keys[PointBlock::kSize];
    blocks_.fillListed(points, n, block_);
    splat_kernels::mortonKeys(block_.x, block_.y, block_.z, n, depth_, keys);
    for (std::size_t k = 0; k < n; ++k) entries_.push_back(entryOf(keys[k], points[k]));
  }

  Entry entryOf(std::uint64_t key, std::uint32_t point) const
  {
    Entry entry{key, {}, {}, point};
    read_(point, entry.place.data());
    const std::size_t input = cloud_.inputIndex(point);
    if (cloud_.normal != nullptr) {
      std::memcpy(entry.look.data(),
                  static_cast<const unsigned char*>(cloud_.normal) + input * cloud_.normal_stride,
                  3 * sizeof(float));
    }
    if (colors_.bgr != nullptr) {
      std::memcpy(entry.look.data() + 3 * sizeof(float),
                  static_cast<const unsigned char*>(colors_.bgr) + input * colors_.stride, 3);
    }
    return entry;
  }

  const CloudView& cloud_;
  const ColorView& colors_;
  const octree_grid::Reader<T>& read_;
  const PointBlocks<T>& blocks_;
  int depth_;
  PointBlock block_;
  std::vector<Entry> entries_;
};

}  // namespace pcl_slim::detail
