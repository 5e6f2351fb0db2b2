// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "camera/camera_rays.h"
#include "index/leaf_index.h"

namespace pcl_slim::detail::kernels {

/** \brief What is seen of one cluster's surfels. Errs on the visible side.
 * \param[out] visibility by surfel
 * \param[out] shares of the weight, above 0 of every visible one; room for whole vectors */
void
cullLeaves(const LeafIndex& index, std::uint32_t begin, std::uint32_t end, const FrameView& view,
           const VisibilityRules& rules, Visibility* visibility, float* shares);

}  // namespace pcl_slim::detail::kernels
