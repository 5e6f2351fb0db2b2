// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

namespace pcl_slim::detail {

// Which leaves count at a place: docs/theory.md, "Guards". A leaf has the radius r and the residual
// e.

constexpr double kErrorGate = 5.0;       ///< [e] a point farther from f = 0 is of another sheet ...
constexpr double kLeastErrorGate = 0.1;  ///< [r] ... unless it is within this
constexpr double kOffsetGate = 0.25;     ///< [r] a root farther along its ray does not count ...
constexpr double kNoiseGate = 0.6;    ///< [r] ... or, where noise explains more, than at most this
constexpr float kSharpCosine = 0.5f;  ///< least cosine of two normals of one side, sharp features
constexpr float kLeastGradient = 1e-6f;  ///< a shorter blended gradient has no direction

constexpr float kColorGate = 0.25f;   ///< [r] a leaf farther from a place does not colour it, ...
constexpr float kOtherSheet = 1e-6f;  ///< ... nor one that faces away: it has this share of weight

/** \brief The largest offset of a root from its point [r]. \param[in] residual the largest residual
 * that counts [r] \param[in] noise its deviation, in the units of the radius */
inline double offsetGate(double residual, double noise, double radius) {
  const double explained = std::min(kErrorGate * noise / radius, kNoiseGate);
  return std::min(residual, std::max(kOffsetGate, explained));
}

}  // namespace pcl_slim::detail
