// SPDX-License-Identifier: BSD-3-Clause
#include "render/picture_request.h"

#include <sstream>
#include <vector>

namespace pcl_slim {

void PictureRequest::declareColors(OptionTable& table) {
  table.choice(
      "mode", &mode,
      {"auto", "shaded", "normal", "mean", "gauss", "kmax", "kmin", "level", "size", "error",
       "reflection", "color", "uncertainty", "raytraced", "crest", "contours", "sketch"},
      "what the colours show; uncertainty: the standard error of the position; auto: the model in "
      "its colours if it has any, others shaded");
  table.text("range", &range_text, "auto|X|LO,HI",
             "values that the colours span, -X to X for curvatures and 0 to X for residuals and "
             "standard errors; auto: the "
             "picture's without outliers");
  table.choice("map", &map, {"auto", "diverging", "perceptual"}, "colours of numbers");
  table.toggle("bar", &bar, "draw the colours with their numbers and unit into the picture");
  table.text("unit", &unit, "NAME", "unit of length that -bar names, such as mm, µm or ft");
  table.toggle("lighting", &lighting, "light on the colours");
}

void PictureRequest::declareFinish(OptionTable& table) {
  table.number("ao", &occlusion, 0.0, 1.0, "strength of the shade in hollows");
  table.toggle("white", &white, "white background");
  table.integer("aa", &supersampling, 1, 8, "N x N rays a pixel");
}

Error PictureRequest::parse() {
  if (range_text == "auto") return {};
  std::vector<double> values;
  const bool read = parseNumberList(range_text, values);
  if (read && values.size() == 1 && values[0] > 0.0 && mode != "size") {
    range = {mode == "error" || isUncertainty() ? 0.0 : -values[0], values[0]};
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

ShadingParams PictureRequest::shadingFor(bool has_colors, int threads) const {
  ShadingParams params;
  const std::string automatic = has_colors ? "color" : "shaded";
  params.mode = *shadingModeOf(mode == "auto" || isTraced() ? automatic : mode);
  params.lighting = lighting;
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

namespace {

/** \brief Reads AZ,EL[,STRENGTH[,RADIUS]]. */
bool readLight(const std::string& text, TracedRequest::Light& light) {
  std::vector<double> values;
  if (!parseNumberList(text, values) || values.size() < 2 || values.size() > 4) return false;
  values.resize(4, 0.0);
  constexpr double kUsual = 0.8;  // strength of the stronger of the default lights
  const bool with_strength = text.find(',') != text.rfind(',');
  light = {values[0], values[1], with_strength ? values[2] : kUsual, values[3]};
  return light.strength >= 0.0 && light.spread >= 0.0 && light.spread <= 45.0;
}

}  // namespace

void TracedRequest::declare(OptionTable& table) {
  table.text("lights", &lights_text, "auto|AZ,EL[,STRENGTH[,RADIUS]][:...]",
             "lights of -mode raytraced, degrees to the viewer's right and up; a radius in degrees "
             "makes soft shadows; auto: two");
}

Error TracedRequest::parse() {
  if (lights_text == "auto") return {};
  std::istringstream all(lights_text);
  bool good = !lights_text.empty() && lights_text.back() != ':';
  for (std::string one; good && std::getline(all, one, ':');) {
    good = readLight(one, lights.emplace_back()) && lights.size() <= 32;
  }
  if (good) return {};
  return {ErrorCode::kBadArgument,
          "-lights takes auto or up to 32 lights AZ,EL[,STRENGTH[,RADIUS]] with colons between, "
          "strengths of 0 or more and radii of 0 to 45, such as -45,40,0.8,1.5:50,20,0.3, not '" +
              lights_text + "'"};
}

std::vector<RayLight> TracedRequest::lightsFor(const Camera& camera) const {
  if (lights.empty()) return defaultLights(camera);
  std::vector<RayLight> all;
  for (const Light& light : lights) {
    RayLight& one = all.emplace_back();
    one.towards = lightDirection(camera, light.azimuth, light.elevation);
    one.color.fill(static_cast<float>(light.strength));
    one.spread = light.spread;
  }
  return all;
}

}  // namespace pcl_slim
