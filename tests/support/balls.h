// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <random>

#include "least_squares/least_squares.h"
#include "scan/ball_kernels.h"

namespace pcl_slim_test {

/** \brief The points of a ball in its frame, and the fit of a degree within radius 1. */
struct TestBall {
  pcl_slim::detail::BallBuffer points;
  pcl_slim::detail::LocalFit fit;
};

/** \brief A disc of heights: a wave along u and noise. The points are in no order, as a thick
 * cloud's are along a Morton curve. With thick, distances count the height too, as in a gathered
 * ball. */
inline TestBall wavyBall(int degree, std::size_t count, double amplitude, double wavelength,
                         double noise, std::uint32_t seed, bool thick = false,
                         pcl_slim::WeightKernel kernel = pcl_slim::WeightKernel::kPower4) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  std::normal_distribution<double> normal;
  TestBall ball;
  pcl_slim::detail::BallBuffer& p = ball.points;
  p.reserve(count);
  while (p.count < count) {
    const double u = place(random), v = place(random);
    if (u * u + v * v >= 1.0) continue;
    const std::size_t i = p.count++;
    p.u[i] = static_cast<float>(u);
    p.v[i] = static_cast<float>(v);
    p.w[i] = static_cast<float>(amplitude * std::sin(2 * M_PI * u / wavelength) +
                                noise * normal(random));
    p.s_sq[i] = p.u[i] * p.u[i] + p.v[i] * p.v[i] + (thick ? p.w[i] * p.w[i] : 0.0f);
  }
  for (std::size_t i = p.count; i < p.count + pcl_slim::detail::BallBuffer::kPadding; ++i) {
    p.u[i] = p.v[i] = p.w[i] = 0.0f;
    p.s_sq[i] = 2.0f;
  }
  ball.fit = pcl_slim::detail::kernels::fitBall(p, degree, 1.0f, kernel, 1.15, true);
  return ball;
}

}  // namespace pcl_slim_test
