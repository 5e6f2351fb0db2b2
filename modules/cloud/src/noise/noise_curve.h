// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "noise/patch_scale.h"

namespace pcl_slim::detail {

/** \brief The noise of a cloud as its scales show it. */
struct CurveNoise {
  double variance = 0, correlation = 1;
  std::size_t scale = 0;  ///< that shows most of it
};

/** \brief The scales of a cloud, and the noise that they show. */
struct NoiseCurve {
  std::vector<PatchScale> scales;  ///< two at least
  CurveNoise noise;
  std::vector<CurveNoise> halves;  ///< by random halves of the places: their scatter is its error
};

/** \brief What counts of the noise that a curve shows: none where chance explains what wider patches show. */
struct CurveShare {
  double part = 0;  ///< of the logarithm of its variance over white noise's ...
  double variance = 0, correlation = 1;  ///< ... and the figures with that part
};

CurveShare
shareOf(const CurveNoise& curve, double white, const SharedNoiseConstants& constants);

/** \brief Squared errors of the logarithms of the figures that count. */
struct LogErrors {
  double variance = 0, correlation = 0;
};

/** \brief The scatter of a curve's halves. */
LogErrors
errorsOf(const NoiseCurve& curve, double white, const SharedNoiseConstants& constants);

/** \brief Measures scales, from the smallest patches on, until no wider one can show noise, and weighs
 * what each shows by the chance that it is a plateau (docs/theory.md, "Noise that neighbours share").
 * \param[in] white variance by the smallest patches */
NoiseCurve
measureCurve(const PointStore& store, std::size_t k, double white, const NoiseConstants& constants,
             int threads);

/** \brief The noise of a rounded coordinate, whose errors change sign from one terrace to the next, so
 * that wide cells share nothing. Where detail follows directly, patches of half the width show it.
 * \param[in] k points of patches that show all of it \param[out] scales those measured */
CurveNoise
measureRounding(const PointStore& store, std::size_t k, const NoiseConstants& constants,
                int threads, std::vector<PatchScale>& scales);

}  // namespace pcl_slim::detail
