// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/display_mode.h"

#include <vtkLookupTable.h>

#include <array>
#include <cmath>

#include "color/color_scale.h"
#include "pcl_slim/render/color_map.h"

namespace pcl_slim {
namespace {

constexpr std::array<const char*, 12> kNames{"shaded",     "normal", "mean",  "gauss",
                                             "kmax",       "kmin",   "level", "size",
                                             "reflection", "color",  "error", "sketch"};

}  // namespace

std::string nameOf(DisplayMode mode) {
  return kNames[static_cast<std::size_t>(mode)];
}

std::optional<DisplayMode> displayModeOf(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<DisplayMode>(i);
  }
  return std::nullopt;
}

std::vector<std::string> displayModeNames() {
  return {kNames.begin(), kNames.end()};
}

bool showsCurvature(DisplayMode mode) {
  return mode == DisplayMode::kMean || mode == DisplayMode::kGauss || mode == DisplayMode::kMax ||
         mode == DisplayMode::kMin;
}

bool takesRange(DisplayMode mode) {
  return showsCurvature(mode) || mode == DisplayMode::kError;
}

bool showsNumbers(DisplayMode mode) {
  return takesRange(mode) || mode == DisplayMode::kLevel || mode == DisplayMode::kSize;
}

}  // namespace pcl_slim

namespace pcl_slim::detail {

constexpr double kAlike = 1e-3;  ///< share of a size that their table then reaches to both sides

void fillColorTable(DisplayMode mode, const std::array<double, 2>& range, vtkLookupTable& table) {
  if (!showsNumbers(mode)) return;
  const bool levels = mode == DisplayMode::kLevel;
  const int first = static_cast<int>(std::lround(range[0]));
  const int count = levels ? static_cast<int>(std::lround(range[1])) - first + 1 : 256;
  table.SetNumberOfTableValues(count);
  table.SetScaleToLinear();
  // Sizes that are all alike have the colour of the middle.
  const bool alike = mode == DisplayMode::kSize && !(range[0] < range[1]);
  const double aside = alike ? kAlike * range[0] : 0.0;
  // A level's colour fills the table from half a level below it to half a level above.
  const double half = levels ? 0.5 : 0.0;
  table.SetTableRange(range[0] - half - aside, range[1] + half + aside);
  // Last, as a table by the logarithm refuses the signed range it may have had before.
  if (mode == DisplayMode::kSize) table.SetScaleToLog10();
  for (int i = 0; i < count; ++i) {
    const double x = count > 1 ? i / (count - 1.0) : 0.5;
    const Color color = levels ? categoryColor(static_cast<std::uint32_t>(first + i))
                        : mode == DisplayMode::kSize  ? sizeColor(x)
                        : mode == DisplayMode::kError ? perceptualColor(x)
                                                      : divergingColor(2.0 * x - 1.0);
    table.SetTableValue(i, color[0], color[1], color[2]);
  }
}

ColorScale::ColorScale(DisplayMode mode, vtkScalarsToColors* table) {
  const double* range = table->GetRange();
  const bool levels = mode == DisplayMode::kLevel;
  const double half = levels ? 0.5 : 0.0;
  low = range[0] + half;
  high = range[1] - half;
  logarithm = mode == DisplayMode::kSize;
  if (levels) texels = std::max(1, static_cast<int>(std::lround(range[1] - range[0])));
  const double first = logarithm ? std::log(low) : range[0];
  const double last = logarithm ? std::log(high) : range[1];
  shader = {static_cast<float>(first),
            static_cast<float>(last > first ? 1.0 / (last - first) : 0.0), logarithm ? 1.0f : 0.0f};
}

}  // namespace pcl_slim::detail
