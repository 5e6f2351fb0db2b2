// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "columns/web_columns.h"
#include "columns/web_header.h"
#include "pcl_slim/cloud/morton.h"

namespace pcl_slim::detail {

/** \brief Places on a grid of 16 bits an axis over their box. */
class CenterCells {
 public:
  using Axes = std::array<const std::vector<float>*, 3>;

  explicit CenterCells(const Axes& axes) : axes_(axes)
  {
    double extent = 0.0;
    for (std::size_t k = 0; k < 3 && !axes[k]->empty(); ++k) {
      const auto [least, most] = std::minmax_element(axes[k]->begin(), axes[k]->end());
      corner[k] = static_cast<double>(*least);
      extent = std::max(extent, static_cast<double>(*most) - corner[k]);
    }
    if (extent > 0.0) step = extent / kCenterSteps;
  }

  std::uint32_t cell(std::size_t k, std::size_t i) const
  {
    return static_cast<std::uint32_t>(std::lround(((*axes_[k])[i] - corner[k]) / step));
  }

  /** \brief The place of the cell in the grid, in local units. */
  double rounded(std::size_t k, std::size_t i) const { return corner[k] + cell(k, i) * step; }

  /** \brief All places along a Morton curve, those of the first kind before the others.
   * \param[in] isFirst bool(std::uint32_t) */
  template <typename IsFirst>
  std::vector<std::uint32_t> order(const IsFirst& isFirst) const
  {
    std::vector<std::uint32_t> order;
    std::vector<std::uint64_t> keys;
    for (std::uint32_t i = 0; i < axes_[0]->size(); ++i) {
      order.push_back(i);
      keys.push_back(spreadBits(cell(0, i)) << 2 | spreadBits(cell(1, i)) << 1 |
                     spreadBits(cell(2, i)));
    }
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (isFirst(a) != isFirst(b)) return isFirst(a);
      return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
    });
    return order;
  }

  /** \brief Writes steps from place to place. */
  void write(const std::vector<std::uint32_t>& order, PlaneWriter& out) const
  {
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint32_t last = 0;
      std::vector<std::uint32_t> steps;
      for (const std::uint32_t i : order) {
        steps.push_back((cell(k, i) - last) & 0xffffu);
        last = cell(k, i);
      }
      out.put(steps, 2);
    }
  }

  double corner[3] = {0.0, 0.0, 0.0}, step = 1.0;

 private:
  Axes axes_;
};

}  // namespace pcl_slim::detail
