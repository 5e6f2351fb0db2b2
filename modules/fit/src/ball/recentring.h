// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ball/ball_frame.h"
#include "radius/radius_search.h"

namespace pcl_slim::detail {

/** \brief Moves a ball onto its own fit where noise has thrown its centre off: it would see a
 * lopsided part of the points (docs/theory.md, "Where the default departs from the paper"). It is
 * gathered and framed anew there. \param[in] stride of the blocks gathered \param[in,out] search
 * begun on the ball, and begun anew where it moves */
FramedBall
recentred(const FramedBall& ball, const FitSettings& settings, std::size_t stride,
          BallGatherer& gatherer, RadiusSearch& search);

}  // namespace pcl_slim::detail
