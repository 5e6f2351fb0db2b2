// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "pcl_slim/query/detail/projection_kernel.h"

namespace pcl_slim::detail {

/** \brief Weighted means of a block's points, in plain loops; of no use where nothing was added. */
struct BlockMeans {
  static constexpr double kLeastGradient = 1e-6;  ///< shorter blended gradients tell no direction

  double offset[16], gradient[3][16], length[16];
  float unit[3][16];

  explicit BlockMeans(const BlockSums& sums)
  {
    constexpr int N = 16;
    double weight[N];
    for (int i = 0; i < N; ++i) {
      const double own = sums.weight[i];
      weight[i] = own > 0 ? own : 1.0;
    }
    for (int i = 0; i < N; ++i) offset[i] = sums.offset[i] / weight[i];
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < N; ++i) gradient[a][i] = sums.gradient[a][i] / weight[i];
    }
    for (int i = 0; i < N; ++i) {
      length[i] = std::sqrt(gradient[0][i] * gradient[0][i] + gradient[1][i] * gradient[1][i] +
                            gradient[2][i] * gradient[2][i]);
    }
    for (int a = 0; a < 3; ++a) {
      for (int i = 0; i < N; ++i) {
        const double divisor = length[i] > kLeastGradient ? length[i] : 1.0;
        unit[a][i] = static_cast<float>(gradient[a][i] / divisor);
      }
    }
  }
};

}  // namespace pcl_slim::detail
