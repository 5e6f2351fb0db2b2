// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_slim/visualization/display_mode.h"

#include <array>

namespace pcl_slim {
namespace {

constexpr std::array<const char*, 12> kNames{"shaded",     "normal", "mean",  "gauss",
                                             "kmax",       "kmin",   "level", "size",
                                             "reflection", "color",  "error", "sketch"};

}  // namespace

std::string
nameOf(DisplayMode mode)
{
  return kNames[static_cast<std::size_t>(mode)];
}

std::optional<DisplayMode>
displayModeOf(const std::string& name)
{
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<DisplayMode>(i);
  }
  return std::nullopt;
}

std::vector<std::string>
displayModeNames()
{
  return {kNames.begin(), kNames.end()};
}

bool
showsCurvature(DisplayMode mode)
{
  return mode == DisplayMode::kMean || mode == DisplayMode::kGauss || mode == DisplayMode::kMax ||
         mode == DisplayMode::kMin;
}

bool
takesRange(DisplayMode mode)
{
  return showsCurvature(mode) || mode == DisplayMode::kError;
}

bool
showsNumbers(DisplayMode mode)
{
  return takesRange(mode) || mode == DisplayMode::kLevel || mode == DisplayMode::kSize;
}

}  // namespace pcl_slim
