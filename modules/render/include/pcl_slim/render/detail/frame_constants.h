// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/surface/surface.h"

namespace pcl_slim::detail {

/** \brief A constant of the rules by which rays meet a surface, by its name in shaders and pages.
 */
struct FrameConstant {
  const char* name;
  double value;
};

constexpr double kMaxShrink =
    0.95;  ///< of pass 1: at the very rim a leaf has no weight to blend with
constexpr double kMaxShift = 0.25;       ///< distance of q^ from a leaf's own surface [radii]
constexpr double kMinLeaves = 3.0;       ///< that surround a gap which still belongs to the surface
constexpr double kMaxMeanOffset = 0.25;  ///< of those leaves' middle from the gap [radii]
constexpr double kBehind =
    0.05;  ///< how far behind q^ leaves that the ray misses are weighed [radii]
constexpr double kPeelStep = 0.02;  ///< where the search continues behind an uncovered flap [radii]
constexpr int kMaxLayers = 8;       ///< how often a ray may pass through uncovered flaps
constexpr double kDetailFade = 1.5;   ///< sizes over which surfels fade [levels of detail]
constexpr double kDetailMeets = 0.4;  ///< surfels of a smaller share are not met by rays of pass 1

/** \brief What the shaders of visualization/ and of a page need of them. */
constexpr std::array<FrameConstant, 8> kFrameConstants{{{"kMaxShrink", kMaxShrink},
                                                        {"kMaxShift", kMaxShift},
                                                        {"kMinLeaves", kMinLeaves},
                                                        {"kMaxMeanOffset", kMaxMeanOffset},
                                                        {"kBehind", kBehind},
                                                        {"kPeelStep", kPeelStep},
                                                        {"kDetailFade", kDetailFade},
                                                        {"kDetailMeets", kDetailMeets}}};

/** \brief Share of a ball's radius at which the blending weight has fallen to 1e-3. What is
 * beyond moves a blend by less than that share of what its leaves differ by. */
constexpr float weightReach(WeightKernel kernel) {
  switch (kernel) {
    case WeightKernel::kPower2: return 0.984f;  // 1 - s^2 = .0316
    case WeightKernel::kPower4: return 0.907f;  // .178
    case WeightKernel::kPower7: return 0.792f;  // .373
    default: return 0.854f;                     // 16 e^-2 (1 - s)^4
  }
}

}  // namespace pcl_slim::detail
