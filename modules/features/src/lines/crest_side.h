// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/features/crest_lines.h"

namespace pcl_slim::detail {

/** The curvature whose maxima make lines of one type, everything written as for ridges. */
struct CrestSide {
  double k, other;
  std::array<float, 3> t;
  double e;  ///< dk/dt
};

/** \param[in] turned whether the normal must be taken the other way round: ridges are ravines then. */
inline CrestSide
crestSide(const PrincipalFrame& frame, CrestType type, bool turned)
{
  if ((type == CrestType::kRidge) != turned) {
    return {frame.k1, frame.k2, frame.direction1, frame.extremality1};
  }
  return {-static_cast<double>(frame.k2), -static_cast<double>(frame.k1), frame.direction2,
          -static_cast<double>(frame.extremality2)};
}

}  // namespace pcl_slim::detail
