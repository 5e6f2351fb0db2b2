// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pcl_slim/core/error.h"
#include "pcl_slim/core/export.h"
#include "pcl_slim/render/camera.h"
#include "pcl_slim/render/color_map.h"
#include "pcl_slim/render/image.h"

namespace pcl_slim {

/** \brief How signed distances from a reference are coloured. */
struct PCL_SLIM_EXPORT DeviationScale {
  double range = 1.0;  ///< size of the deviation that has the darkest colour [world units], > 0
  double level = 0.0;  ///< typical level of detection, which the legend shows [world units], >= 0
  std::string unit;    ///< of length, up to eight letters such as mm or µm, or none

  /** \brief Names the first value out of range. */
  Error validate() const;
};

/** \brief A scale whose darkest colours are at the 95 % quantile of the deviations' sizes, rounded
 * up to 1, 1.5, 2, 3, 5 or 7 times a power of ten, and at least twice the level of detection; 1
 * where all of these are 0. O(n).
 * \param[in] deviations those that are coloured, any sign; values that are not finite do not count
 * \param[in] level typical level of detection [world units] */
PCL_SLIM_EXPORT DeviationScale deviationScaleOf(const std::vector<double>& deviations, double level,
                                                const std::string& unit = "");

/** \brief The colour of a significant deviation: blue below the reference, red above it, darker
 * with the deviation's size. Even the smallest has a colour that no grey resembles. */
PCL_SLIM_EXPORT Color deviationColor(const DeviationScale& scale, double deviation);

/** \brief Light grey: the deviation is below its level of detection. */
PCL_SLIM_EXPORT Color insignificantColor();

/** \brief Dark grey: the reference has no counterpart there. */
PCL_SLIM_EXPORT Color noCounterpartColor();

/** \brief "±4.1·10⁻⁵ (median)": the typical level of detection as legends show it; UTF-8. */
PCL_SLIM_EXPORT std::string levelText(const DeviationScale& scale);

/** \brief A colour as three bytes. */
PCL_SLIM_EXPORT std::array<std::uint8_t, 3> bytesOf(const Color& color);

/** \brief Share of a picture's width that its legend takes up at the right; 0 where there is no
 * room for one. */
PCL_SLIM_EXPORT double deviationLegendShare(const ImageSize& size);

/** \brief Draws the legend into the right margin of a picture: the colours with their numbers and
 * unit, grey between minus and plus the typical level of detection, the two greys, and the level as
 * a number. Draws nothing where there is no room. O(pixels of the margin). */
PCL_SLIM_EXPORT void addDeviationLegend(const DeviationScale& scale, Image& image);

}  // namespace pcl_slim
