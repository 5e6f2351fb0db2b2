// SPDX-License-Identifier: BSD-3-Clause
#include "render/traced_request.h"

#include <sstream>

#include "common/options.h"

namespace pcl_slim {
namespace {

/** \brief Reads AZ,EL[,STRENGTH[,RADIUS]]. */
bool
readLight(const std::string& text, TracedRequest::Light& light)
{
  std::vector<double> values;
  if (!parseNumberList(text, values) || values.size() < 2 || values.size() > 4) return false;
  values.resize(4, 0.0);
  constexpr double kUsual = 0.8;  // strength of the stronger of the default lights
  const bool with_strength = text.find(',') != text.rfind(',');
  light = {values[0], values[1], with_strength ? values[2] : kUsual, values[3]};
  return light.strength >= 0.0 && light.spread >= 0.0 && light.spread <= 45.0;
}

}  // namespace

void
TracedRequest::declare(OptionTable& table)
{
  table.text("lights", &lights_text, "auto|AZ,EL[,STRENGTH[,RADIUS]][:...]",
             "lights of -mode raytraced, degrees to the viewer's right and up; a radius in degrees "
             "makes soft shadows; auto: two");
}

Error
TracedRequest::parse()
{
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

std::vector<RayLight>
TracedRequest::lightsFor(const Camera& camera) const
{
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
