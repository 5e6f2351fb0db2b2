// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "pcl_slim/cloud/point_store.h"
#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief For every block of points the leaves whose ball meets it, ascending, as places in a list
 * of leaves: block b has leaves[begin[b]] up to, but not including, leaves[begin[b + 1]]. */
struct BlockLists {
  std::vector<std::uint32_t> begin, leaves;
};

/** \brief Lists the leaves of all blocks. O(leaves log blocks), plus what is listed; the same for
 * any number of threads. */
BlockLists
listLeaves(const PointStore& store, const SLIMSurface& surface,
           const std::vector<std::uint32_t>& leaves, int threads);

}  // namespace pcl_slim::detail
