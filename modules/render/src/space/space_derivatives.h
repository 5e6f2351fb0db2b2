// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pcl_slim/query/partition_of_unity.h"
#include "pcl_slim/render/g_buffer.h"

namespace pcl_slim::detail {

/** \brief Puts the partition of unity's derivatives (eq. 8, right) at a frame's positions in place
 * of the blended ones: normals, and gradients, Hessians and curvatures where the buffer has them.
 * The buffer must have positions. O(covered pixels * leaves near each). */
void
differentiateInSpace(const PartitionOfUnity& unity, int threads, GBuffer& buffer);

}  // namespace pcl_slim::detail
