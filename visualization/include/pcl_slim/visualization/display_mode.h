// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pcl_slim/core/export.h"

namespace pcl_slim {

/** \brief What the colours of a surface or of splats show in a window. */
enum class DisplayMode : unsigned char {
  kShaded,      ///< the actor's own colour, lit
  kNormal,      ///< rgb = n / 2 + 1/2, world axes, without light
  kMean,        ///< mean curvature, 1/length, positive on a ball
  kGauss,       ///< Gaussian curvature, 1/length^2
  kMax,         ///< larger principal curvature, 1/length
  kMin,         ///< smaller principal curvature, 1/length
  kLevel,       ///< level of the leaf of the largest weight, one colour each
  kSize,        ///< its radius, small red to large blue, by the logarithm
  kReflection,  ///< stripes of light far away as the surface mirrors them
  kColor,       ///< colours of splats or of a coloured surface, lit
  kError,       ///< root mean square residual of the leaf of the largest weight, dark to light
  kSketch,      ///< white paper for lines (SLIMMapper::setLines)
};

/** \brief "shaded", "normal", "mean", "gauss", "kmax", "kmin", "level", "size",
 * "reflection", "color", "error" or "sketch". */
PCL_SLIM_EXPORT std::string nameOf(DisplayMode mode);

/** \brief The mode of a name, or nothing. */
PCL_SLIM_EXPORT std::optional<DisplayMode> displayModeOf(const std::string& name);

/** \brief Names of all modes, in their order. */
PCL_SLIM_EXPORT std::vector<std::string> displayModeNames();

/** \brief Whether the mode shows a curvature: values of both signs about 0, in 1/length or
 * 1/length^2. */
PCL_SLIM_EXPORT bool showsCurvature(DisplayMode mode);

/** \brief Whether a mode's colours can be given a range: curvatures and residuals. */
PCL_SLIM_EXPORT bool takesRange(DisplayMode mode);

/** \brief Whether colours represent numbers that a scalar bar explains. */
PCL_SLIM_EXPORT bool showsNumbers(DisplayMode mode);

}  // namespace pcl_slim
