// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "noise/patch.h"
#include "pcl_slim/cloud/detail/noise.h"

namespace pcl_slim::detail {

/** \brief Noise as estimated from a curve. */
struct CurveNoise {
  double variance = 0, correlation = 1;
  std::size_t scale = 0;  ///< index of the first scale that shows most of it
};

/** \brief The scales of a cloud, and the noise estimated from them. */
struct NoiseCurve {
  std::vector<PatchScale> scales;  ///< two at least
  CurveNoise noise;
  std::vector<CurveNoise> halves;  ///< estimates from random halves of the places
};

/** \brief The part of a curve's noise that counts. Chance explains the rest. */
struct CurveShare {
  double part = 0;                       ///< part of log(variance / white variance) that counts
  double variance = 0, correlation = 1;  ///< figures of the noise that counts
};

/** \brief Squared errors of the logarithms of the figures that count. */
struct LogErrors {
  double variance = 0, correlation = 0;
};

/** \brief The kernel q of (N4): falls smoothly from 1 at 0 to 0 beyond a width. */
inline double fallOff(double x, double width) {
  const double ratio = std::max(0.0, x) / width;
  return std::exp(-ratio * ratio * ratio * ratio);
}

/** \brief The part of an estimate that counts: correlation and growth of the variance count by ramps.
 * \param[in] white variance of the smallest patches */
CurveShare shareOf(const CurveNoise& curve, double white, const SharedNoiseConstants& constants);

/** \brief The scatter of the estimates from halves about the estimate from all places. */
LogErrors errorsOf(const NoiseCurve& curve, double white, const SharedNoiseConstants& constants);

/** \brief Measures the curve of a cloud: at a third of the places first, which are enough where every
 * half of them shows white noise; at more of them where random halves differ too much.
 * \param[in] k number of points of the smallest patches \param[in] white their variance */
NoiseCurve measureCurve(const PointStore& store, std::size_t k, double white,
                        const NoiseConstants& given, int threads);

}  // namespace pcl_slim::detail
