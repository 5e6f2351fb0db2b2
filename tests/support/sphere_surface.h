// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <random>

#include "pcl_slim/surface/oct_normal.h"
#include "pcl_slim/surface/surface.h"
#include "support/temporary_folder.h"

namespace pcl_slim_test {

/** Surfels on a sphere of radius .3 L: mixed degrees up to the given one, two levels, snapped
 * normals, centres on a 2^-15 grid and a scale and origin that float represents exactly. */
inline pcl_slim::SLIMSurface sphereSurface(int degree, std::size_t count) {
  using namespace pcl_slim;
  SLIMSurface surface;
  SurfaceInfo& info = surface.info;
  info.degree = degree;
  info.fit_kernel = WeightKernel::kPower2;
  info.oriented = true;
  info.origin = {100.0, -50.5, 3.25};
  info.scale = 4.0;
  info.diagonal = 0.6 * std::sqrt(3.0) + 1e-17;
  info.lambda = 1.0 / 3e8;
  info.penalty = 2.1;
  info.t_mdl = 0.01;
  info.num_points = 123456789012345u;
  surface.resize(count);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto grid = [](double v) { return static_cast<float>(std::round(v * 32768.0) / 32768.0); };
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = snapNormal({normal(random), normal(random), normal(random)});
    surface.cx[i] = grid(0.3 * n[0]);
    surface.cy[i] = grid(0.3 * n[1]);
    surface.cz[i] = grid(0.3 * n[2]);
    surface.nx[i] = n[0];
    surface.ny[i] = n[1];
    surface.nz[i] = n[2];
    surface.radius[i] = static_cast<float>(0.05 + 0.03 * std::abs(normal(random)));
    surface.degree[i] = static_cast<std::uint8_t>(1 + (i % static_cast<std::size_t>(degree)));
    surface.level[i] = static_cast<std::uint8_t>(i % 5 == 0 ? 1 : 2);
    surface.flags[i] = static_cast<std::uint8_t>(i % 5 == 0 ? 0 : i % 7 == 0 ? 3 : 1);
    surface.error[i] = static_cast<float>(1e-4 * std::abs(normal(random)));
    surface.effective_count[i] = static_cast<float>(20.0 + std::abs(normal(random)));
    for (int k = 0; k < numCoefficients(surface.degree[i]); ++k) {
      surface.coefficients[i * static_cast<std::size_t>(surface.stride()) +
                           static_cast<std::size_t>(k)] = static_cast<float>(0.1 * normal(random));
    }
  }
  surface.buildLinks();
  return surface;
}

}  // namespace pcl_slim_test
