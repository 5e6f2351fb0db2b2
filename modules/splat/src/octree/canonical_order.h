// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "octree/octree_grid.h"
#include "pcl_slim/core/aligned.h"
#include "pcl_slim/splat/octree_cloud.h"

namespace pcl_slim::detail {

/** Orders points that no key tells apart by what they are, and keeps one of those that are equal in
 * place, normal and colour, so that nothing depends on the order in which their owner has them. */
template <typename T>
class CanonicalOrder {
 public:
  CanonicalOrder(const CloudView& cloud, const ColorView& colors,
                 const octree_grid::Reader<T>& read)
      : cloud_(cloud), colors_(colors), read_(read)
  {
  }

  /** keys: ascending; order: the points they are of. Both become those of the points kept. */
  void apply(AlignedVector<std::uint64_t>& keys, AlignedVector<std::uint32_t>& order)
  {
    const auto repeated = std::adjacent_find(keys.begin(), keys.end());
    std::size_t kept = static_cast<std::size_t>(repeated - keys.begin());
    for (std::size_t i = kept; i < keys.size();) {
      std::size_t end = i + 1;
      while (end < keys.size() && keys[end] == keys[i]) ++end;
      const std::uint64_t key = keys[i];
      for (const std::uint32_t point : distinct(order.data() + i, order.data() + end)) {
        keys[kept] = key;
        order[kept++] = point;
      }
      i = end;
    }
    keys.resize(kept);
    order.resize(kept);
  }

 private:
  /** What tells points apart, in the order in which it is compared; the point comes last. */
  struct Entry {
    std::array<T, 3> place;
    std::array<unsigned char, 3 * sizeof(float) + 3> look;  ///< normal and colour
    std::uint32_t point;

    bool operator==(const Entry& other) const { return place == other.place && look == other.look; }
    bool operator<(const Entry& other) const
    {
      if (place != other.place) return place < other.place;
      return look != other.look ? look < other.look : point < other.point;
    }
  };

  const std::vector<std::uint32_t>& distinct(const std::uint32_t* begin, const std::uint32_t* end)
  {
    points_.assign(begin, end);
    if (points_.size() == 1) return points_;
    entries_.clear();
    for (const std::uint32_t point : points_) entries_.push_back(entryOf(point));
    std::sort(entries_.begin(), entries_.end());
    entries_.erase(std::unique(entries_.begin(), entries_.end()), entries_.end());
    points_.clear();
    for (const Entry& entry : entries_) points_.push_back(entry.point);
    return points_;
  }

  Entry entryOf(std::uint32_t point) const
  {
    Entry entry{{}, {}, point};
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
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> points_;
};

}  // namespace pcl_slim::detail
