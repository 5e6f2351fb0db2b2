// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "ball/ball_frame.h"
#include "radius/radius_search.h"

namespace pcl_slim::detail {

/** \brief A surfel as the cover makes it; the columns of SLIMSurface are filled at the end. */
struct SurfelRecord {
  std::array<float, 3> center, normal;
  float radius, error, effective_count;
  std::uint8_t degree, level, flags;
  bool sided;  ///< made of the points on its normal's side alone
  std::array<float, kMaxCoefficients> c;
};

/** \brief The surfel of a ball whose radius is chosen: its polynomial in units of that radius,
 * without what noise adds to it on average (docs/theory.md, "Bias"). */
SurfelRecord
recordOf(const FramedBall& ball, const RadiusChoice& choice, int level,
         const BiasConstants& constants);

}  // namespace pcl_slim::detail
