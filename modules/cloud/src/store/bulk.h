// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

namespace pcl_slim::detail {

/** \brief Where a cloud's points are, but for strays: a cube around their median.
 *
 * Units and precision follow the box of the stored points, so one point a million times as far away as
 * the others would leave them none. Points outside the cube are left out of the store and counted. */
struct Bulk {
  std::array<double, 3> median{};
  double reach = std::numeric_limits<double>::infinity();  ///< half the cube's edge; infinite: all

  bool holds(const std::array<double, 3>& p) const
  {
    return std::abs(p[0] - median[0]) <= reach && std::abs(p[1] - median[1]) <= reach &&
           std::abs(p[2] - median[2]) <= reach;
  }
};

/** \brief The bulk of count points, found from at most 4096 of them, evenly strided. Half the cube's
 * edge is 2^14 times the diagonal of the box between the quartiles of each coordinate: a survey with half
 * of its points on one object a metre wide keeps all others within 16 km.
 * \param[in] point the i-th; those that do not count have coordinates that are not finite. O(1). */
Bulk
findBulk(std::size_t count, const std::function<std::array<double, 3>(std::size_t i)>& point);

}  // namespace pcl_slim::detail
