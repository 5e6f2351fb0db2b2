// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "pcl_slim/fit/fit.h"
#include "support/lab/scenes.h"

namespace pcl_slim::measure {

/** \brief RMS errors of projected points against the exact surface.
 *
 * Position counts every stored point, one that no surfel supports at the place it kept; normals
 * and curvature count supported points away from an open border's outermost 2 %. */
struct Accuracy {
  double position = 0, worst = 0;  ///< scene units
  double normal = 0;               ///< degrees, regardless of sign
  double curvature = 0;            ///< RMS error of mean curvature / RMS mean curvature
};

/** \brief A fit and projection of one scene, measured. */
struct Outcome {
  Accuracy accuracy;
  FitStatistics fit;
  double sigma = 0;  ///< the noise level the fit found, as a share of the clean diagonal
  std::uint64_t unsupported = 0;  ///< points no surfel supports
};

/** \brief What fits a surface to a store: fitSurface(), or one of other constants. */
using Fitter =
    std::function<Error(const PointStore&, const FitParams&, SLIMSurface&, FitStatistics*)>;

/** \brief Fits a scene and projects its points.
 * \param[in] float_input round the coordinates to float first, as a file of floats does.
 * \param[in] fitter the fit that is measured; empty: fitSurface(). */
Result<Outcome> measureAccuracy(Shape shape, const Scene& scene, const FitParams& params,
                                bool normals, bool float_input, const Fitter& fitter = {});

}  // namespace pcl_slim::measure
