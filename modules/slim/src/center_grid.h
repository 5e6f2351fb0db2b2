// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pcl_slim/slim/surface.h"

namespace pcl_slim {

/** \brief Some surfels, sorted by the cell of a grid as wide as the widest query. */
class CenterGrid {
 public:
  CenterGrid(const SLIMSurface& surface, const std::vector<std::uint32_t>& members, float width)
      : surface_(surface), inverse_(1.0 / std::max<double>(width, kNarrowest))
  {
    cells_.reserve(members.size());
    for (const std::uint32_t i : members) {
      cells_.push_back({code(cell(surface.cx[i]), cell(surface.cy[i]), cell(surface.cz[i])), i});
    }
    std::sort(cells_.begin(), cells_.end());
  }

  /** Calls body(member, squared distance) for the members within one cell of a centre. */
  template <typename Body>
  void forEachNear(std::uint32_t center, const Body& body) const
  {
    forEachNear(surface_.cx[center], surface_.cy[center], surface_.cz[center], body);
  }

  /** Likewise for any place. */
  template <typename Body>
  void forEachNear(float px, float py, float pz, const Body& body) const
  {
    const std::int64_t x = cell(px), y = cell(py), z = cell(pz);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        // Cells along z are neighbours in the order of codes: one search serves three.
        auto it =
            std::lower_bound(cells_.begin(), cells_.end(), Entry{code(x + dx, y + dy, z - 1), 0});
        const std::int64_t last = code(x + dx, y + dy, z + 1);
        for (; it != cells_.end() && it->code <= last; ++it) {
          const float ex = surface_.cx[it->member] - px;
          const float ey = surface_.cy[it->member] - py;
          const float ez = surface_.cz[it->member] - pz;
          body(it->member, ex * ex + ey * ey + ez * ez);
        }
      }
    }
  }

 private:
  struct Entry {
    std::int64_t code;
    std::uint32_t member;
    bool operator<(const Entry& other) const
    {
      return code != other.code ? code < other.code : member < other.member;
    }
  };

  // Cells and their neighbours count in 21 bits an axis. What lies outside [-1, 1] shares a rim cell.
  static constexpr double kNarrowest = 0x1p-19;
  static constexpr double kLastCell = 0x1p21 - 4;

  std::int64_t cell(float local) const
  {
    return std::llround(std::clamp((local + 1.0) * inverse_, 0.0, kLastCell)) + 1;
  }
  static std::int64_t code(std::int64_t x, std::int64_t y, std::int64_t z)
  {
    return (x << 42) + (y << 21) + z;
  }

  const SLIMSurface& surface_;
  double inverse_;
  std::vector<Entry> cells_;
};

}  // namespace pcl_slim
