// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** Places with a number each, found by distance. Cells are looked up by place and never listed, so that
 * the order of the hash table cannot reach a result. */
class PlaceGrid {
 public:
  explicit PlaceGrid(double width) : inverse_(1.0 / width) {}

  void clear()
  {
    first_.clear();
    entries_.clear();
  }

  void add(const Vector3& place, std::int64_t number)
  {
    auto& first = first_.try_emplace(key(cell(place[0]), cell(place[1]), cell(place[2])), kNone)
                      .first->second;
    entries_.push_back({place, number, first});
    first = static_cast<std::uint32_t>(entries_.size() - 1);
  }

  /** The place nearest to another that lies within a distance and that accept(number) agrees to; ties
   * go to the one added first. \return its number, or -1. */
  template <typename Accept>
  std::int64_t nearest(const Vector3& place, double distance, const Accept& accept) const
  {
    if (entries_.empty()) return -1;
    double least_sq = distance * distance;
    std::uint32_t found = kNone;
    std::int64_t low[3], high[3];
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = cell(place[a] - distance);
      high[a] = cell(place[a] + distance);
    }
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto it = first_.find(key(x, y, z));
          if (it == first_.end()) continue;
          for (std::uint32_t at = it->second; at != kNone; at = entries_[at].next) {
            const Vector3 off = subtract(entries_[at].place, place);
            const double d_sq = dot(off, off);
            const bool nearer = d_sq < least_sq || (d_sq == least_sq && at < found);
            if (nearer && accept(entries_[at].number)) {
              least_sq = d_sq;
              found = at;
            }
          }
        }
      }
    }
    return found == kNone ? -1 : entries_[found].number;
  }

  bool anyWithin(const Vector3& place, double distance) const
  {
    return nearest(place, distance, [](std::int64_t) { return true; }) >= 0;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  struct Entry {
    Vector3 place;
    std::int64_t number;
    std::uint32_t next;
  };

  std::int64_t cell(double v) const { return static_cast<std::int64_t>(std::floor(v * inverse_)); }
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z)
  {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
    return (static_cast<std::uint64_t>(x) & kMask) << 42 |
           (static_cast<std::uint64_t>(y) & kMask) << 21 | (static_cast<std::uint64_t>(z) & kMask);
  }

  double inverse_;
  std::unordered_map<std::uint64_t, std::uint32_t> first_;
  std::vector<Entry> entries_;
};

}  // namespace pcl_slim::detail
