// SPDX-License-Identifier: BSD-3-Clause
#include "ball/recentring.h"

#include <cmath>

namespace pcl_slim::detail {

FramedBall
recentred(const FramedBall& ball, const FitSettings& settings, std::size_t stride,
          BallGatherer& gatherer, RadiusSearch& search)
{
  const BallConstants& constants = settings.constants.ball;
  const Trial& right = search.right();
  const double offset = right.fit.c[0];  // of the radius
  if (!right.supported || std::abs(offset) < constants.off_center ||
      std::abs(offset) > constants.largest_shift) {
    return ball;
  }
  BallSite site = ball.site;
  std::array<double, 3> moved;
  for (std::size_t a = 0; a < 3; ++a)
    moved[a] = site.center[a] + offset * site.radius * ball.normal[a];
  site.center = onCenterGrid(moved, settings.center_grid);
  const FramedBall result = framed(gatherer.gather(site, stride), settings);
  search.begin(*result.points, site.radius, 1.0);
  return result;
}

}  // namespace pcl_slim::detail
