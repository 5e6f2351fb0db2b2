// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "camera/camera_rays.h"
#include "pcl_slim/render/render_params.h"

namespace pcl_slim::detail {

/** \brief A half space as a view's rays meet it: points of depth value D on the ray through (x, y) of
 * the plane z = 1 (anywhere, if parallel) lie in it where by_x x + by_y y + rest + gain D >= 0. */
struct FrameCut {
  double by_x, by_y, rest, gain;
};

/** \brief Half spaces of local coordinates as a view's rays meet them. */
std::vector<FrameCut>
frameCuts(const FrameView& view, const std::vector<HalfSpace>& cuts);

}  // namespace pcl_slim::detail
