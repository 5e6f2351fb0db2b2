// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

/** \brief Where a cloud's points are, but for strays: a cube around their median.
 *
 * Units and precision follow the box of the stored points, so one point a million times as far away as
 * the others would leave them none. Points outside the cube are left out of the store and counted. */
struct Bulk {
  std::array<double, 3> median{};
  double between = std::numeric_limits<double>::infinity();  ///< diagonal of the box of quartiles
  double reach = std::numeric_limits<double>::infinity();  ///< half the cube's edge; infinite: all

  bool holds(const std::array<double, 3>& p) const
  {
    return std::abs(p[0] - median[0]) <= reach && std::abs(p[1] - median[1]) <= reach &&
           std::abs(p[2] - median[2]) <= reach;
  }
};

/** \brief The bulk of a cloud, found from at most 4096 of its places: those whose hashes are least,
 * so that neither the points' order nor their repetition changes anything. Half the cube's edge is 2^14
 * times the diagonal of the box between the quartiles of each coordinate: a survey with half of its
 * places on one object a metre wide keeps all others within 16 km. O(points), a few nanoseconds each. */
Bulk
findBulk(const CloudView& cloud, const CloudReader& reader, int threads);

}  // namespace pcl_slim::detail
