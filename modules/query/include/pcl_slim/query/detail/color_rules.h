// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_slim::detail {

// Which leaves give a place of the surface its colour.
constexpr float kColorGate = 0.25f;  ///< of r: a leaf farther from the place is of another sheet,
constexpr float kOtherSheet =
    1e-6f;  ///< and so is one that faces away: it counts by this where no other does

}  // namespace pcl_slim::detail
