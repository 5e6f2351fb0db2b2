// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ball/ball_gather.h"

namespace pcl_slim::detail {

/** \brief A gathered ball in the frame of its normal n_c: its points are frame coordinates in units
 * of the site's radius. */
struct FramedBall {
  BallSite site;
  std::array<float, 3> normal{};  ///< n_c, as a surfel stores it
  BallBuffer* points = nullptr;

  LocalFrame frame() const { return LocalFrame({normal[0], normal[1], normal[2]}); }
};

/** \brief Frames a ball by the mean normal of its points, or where none are given by the direction
 * of their least weighted spread. */
FramedBall
framed(const GatheredBall& ball, const FitSettings& settings);

/** \brief Turns a ball that has lost points to the direction of least spread of those that it kept.
 */
FramedBall
reframed(const FramedBall& ball);

}  // namespace pcl_slim::detail
