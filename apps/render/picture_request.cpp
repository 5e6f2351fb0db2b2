// SPDX-License-Identifier: BSD-3-Clause
#include "render/picture_request.h"

#include <vector>

#include "common/options.h"

namespace pcl_slim {

void
PictureRequest::declareColors(OptionTable& table)
{
  table.choice(
      "mode", &mode,
      {"auto", "shaded", "normal", "mean", "gauss", "kmax", "kmin", "level", "size", "error",
       "reflection", "color", "raytraced", "crest", "contours", "sketch"},
      "what the colours show; auto: splats, and surfaces in a page, in their colours if they have "
      "any; others shaded");
  table.text(
      "range", &range_text, "auto|X|LO,HI",
      "values that the colours span, -X to X for curvatures and 0 to X for errors; auto: the "
      "picture's without outliers");
  table.choice("map", &map, {"auto", "diverging", "perceptual"}, "colours of numbers");
  table.toggle("bar", &bar, "draw the colours with their numbers and unit into the picture");
  table.text("unit", &unit, "NAME", "unit of length that -bar names, such as mm");
  table.choice("lighting", &lighting, {"auto", "0", "1"},
               "light on the colours; auto: all but -mode color");
}

void
PictureRequest::declareFinish(OptionTable& table)
{
  table.number("ao", &occlusion, 0.0, 1.0, "strength of the shade in hollows");
  table.toggle("white", &white, "white background");
  table.integer("aa", &supersampling, 1, 8, "N x N rays a pixel");
}

Error
PictureRequest::parse()
{
  if (range_text == "auto") return {};
  std::vector<double> values;
  const bool read = parseNumberList(range_text, values);
  if (read && values.size() == 1 && values[0] > 0.0 && mode != "size") {
    range = {mode == "error" ? 0.0 : -values[0], values[0]};
    return {};
  }
  if (read && values.size() == 2 && values[0] < values[1]) {
    range = {values[0], values[1]};
    return {};
  }
  return {ErrorCode::kBadArgument,
          "-range takes auto, a number above 0 (but for -mode size) or two numbers, the lower one "
          "first, such as -2,5, not '" +
              range_text + "'"};
}

ShadingParams
PictureRequest::shadingFor(bool has_colors, int threads) const
{
  ShadingParams params;
  const std::string automatic = has_colors ? "color" : "shaded";
  params.mode = *shadingModeOf(mode == "auto" || isTraced() ? automatic : mode);
  params.lighting = lighting == "auto" ? params.mode != ShadingMode::kColor : lighting == "1";
  params.range = range;
  params.map = map == "diverging"    ? ColorMap::kDiverging
               : map == "perceptual" ? ColorMap::kPerceptual
                                     : ColorMap::kAuto;
  params.color_bar = bar;
  params.unit = unit;
  params.ambient_occlusion = occlusion;
  params.gradient_background = !white;
  params.supersampling = supersampling;
  params.threads = threads;
  return params;
}

}  // namespace pcl_slim
