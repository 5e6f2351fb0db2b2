// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "pcl_slim/cloud/store_frame.h"
#include "pcl_slim/core/error.h"
#include "pcl_slim/core/vector3.h"

namespace pcl_slim::detail {

constexpr std::size_t kSlice = 1 << 15;  ///< points a thread takes at a time
constexpr float kBlockGrid = 0x1p22f;    ///< block origins are multiples of its inverse
constexpr double kFarOrigin = 256.0;     ///< beyond this many L, world floats cannot be exact

/** \brief Where a cloud's points are, but for strays: a cube around their median.
 *
 * Units and precision follow the box of the stored points, so one point a million times as far away
 * as the others would leave them none. Points outside the cube are left out of the store and
 * counted. */
struct Bulk {
  std::array<double, 3> median{};
  double between = std::numeric_limits<double>::infinity();  ///< diagonal of the box of quartiles
  double reach = std::numeric_limits<double>::infinity();  ///< half the cube's edge; infinite: all

  bool holds(const std::array<double, 3>& p) const {
    return std::abs(p[0] - median[0]) <= reach && std::abs(p[1] - median[1]) <= reach &&
           std::abs(p[2] - median[2]) <= reach;
  }
};

/** \brief The bulk of a cloud, found from at most 4096 of its places: those whose hashes are least,
 * so that neither the points' order nor their repetition changes anything. Half the cube's edge is
 * 2^14 times the diagonal of the box between the quartiles of each coordinate: a survey with half
 * of its places on one object a metre wide keeps all others within 16 km. O(points), a few
 * nanoseconds each. */
Bulk findBulk(const CloudView& cloud, const CloudReader& reader, int threads);

/** \brief Counts of points; the box is that of those that count. */
struct CloudSummary {
  std::array<double, 3> min{kNone, kNone, kNone}, max{-kNone, -kNone, -kNone};
  std::size_t finite = 0, near = 0, with_normal = 0;

  void add(const CloudSummary& other);

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
};

/** \brief Counts a cloud's points. \param[in] need_normal points without a normal do not count. */
CloudSummary summarizeAll(const CloudView& cloud, const CloudReader& reader, const Bulk& bulk,
                          bool need_normal, int threads);

/** \brief Sets origin, scale, diagonals and the grid of centres from the box of the points that
 * count.
 * \param[in] least_span world length that the units span at least, 0: none. \return an error where
 * doubles cannot represent the units. */
Error setUnits(const std::array<double, 3>& low, const std::array<double, 3>& high,
               const Bulk& bulk, double least_span, StoreFrame& frame);

}  // namespace pcl_slim::detail
