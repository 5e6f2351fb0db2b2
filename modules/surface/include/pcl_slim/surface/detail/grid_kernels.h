// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "pcl_slim/core/export.h"

namespace pcl_slim::detail {

/** \brief Entries from begin to end of some columns. */
struct ColumnRange {
  std::size_t begin, end;
};

namespace kernels {

/** \brief Finds the entries of x, y, z nearer to a place than a limit, in order.
 * \param[in] x,y,z columns with 16 values to spare behind the last entry.
 * \param[out] entries,distances_sq of those found, with 16 values to spare. \return how many. */
PCL_SLIM_EXPORT std::size_t
entriesWithin(const float* x, const float* y, const float* z, const ColumnRange* ranges,
              std::size_t num_ranges, const float place[3], float limit_sq, std::uint32_t* entries,
              float* distances_sq);

}  // namespace kernels
}  // namespace pcl_slim::detail
