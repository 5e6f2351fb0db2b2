// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "pcl_slim/visualization/display_mode.h"

class vtkLookupTable;
class vtkScalarsToColors;

namespace pcl_slim::detail {

/** \brief Fills a table with a mode's colours over a range of values: diverging for curvatures,
 * the logarithm's for sizes, one colour a level. Modes without numbers leave it as it is. */
void fillColorTable(DisplayMode mode, const std::array<double, 2>& range, vtkLookupTable& table);

/** \brief How a shader comes from a value to a texel of a table's texture. */
struct ColorScale {
  double low = 0.0, high = 1.0;  ///< values of the first and last texel
  bool logarithm = false;
  int texels = 256;
  /** Lowest (logarithm of a) value, 1 / span from the first texel's edge or middle to the last's,
   * and 1 where logarithms are meant. */
  std::array<float, 3> shader{};

  ColorScale(DisplayMode mode, vtkScalarsToColors* table);
};

}  // namespace pcl_slim::detail
