// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "pcl_slim/cloud/detail/cloud_reader.h"
#include "store/bulk.h"

namespace pcl_slim::detail {

/** \brief Counts of points; the box is that of those that count. */
struct CloudSummary {
  std::array<double, 3> min{kNone, kNone, kNone}, max{-kNone, -kNone, -kNone};
  std::size_t finite = 0, near = 0, with_normal = 0;

  void add(const CloudSummary& other);

 private:
  static constexpr double kNone = std::numeric_limits<double>::infinity();
};

/** \brief Counts a cloud's points. \param[in] need_normal points without a normal do not count. */
CloudSummary
summarizeAll(const CloudView& cloud, const CloudReader& reader, const Bulk& bulk, bool need_normal,
             int threads);

}  // namespace pcl_slim::detail
