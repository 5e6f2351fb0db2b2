// SPDX-License-Identifier: BSD-3-Clause
// The light of pictures (modules/render/src/shading) as shaders of windows and pages have it.
#include "frame/light_glsl.h"

#include "pcl_slim/render/detail/light.h"

namespace pcl_slim::detail {

const char* const kSrgb = R"(
vec3 slimLinear(vec3 s)
{
  return mix(s / 12.92, pow((s + 0.055) / 1.055, vec3(2.4)), greaterThan(s, vec3(0.04045)));
}

vec3 slimEncoded(vec3 light)
{
  vec3 s = clamp(light, 0.0, 1.0);
  return mix(12.92 * s, 1.055 * pow(s, vec3(1.0 / 2.4)) - 0.055, greaterThan(s, vec3(0.0031308)));
}

)";

const char* const kLight = R"(
// Everything in the camera's axes, right, up, forward, and in linear light. Coded: the colour encodes something.
vec3 slimLitColor(vec3 base, bool coded, vec3 normal, vec3 ray, float dim)
{
  vec3 key = normalize(kKeyLight);
  float lit = max(0.0, dot(normal, key));
  float diffuse = kAmbientLight + kSkyLight * (0.5 + 0.5 * normal.y) +
                  kHeadLight * max(0.0, -dot(normal, ray)) + kKeyStrength * lit;
  if (coded) return base * (kCodedAmbient + kCodedDiffuse * min(1.0, diffuse)) * dim;
  float half_way = max(0.0, dot(normal, normalize(key - ray)));
  float shine = lit > 0.0 ? kShine * pow(half_way, kShinePower) : 0.0;
  return min(vec3(1.0), (base * diffuse + shine) * dim);
}

// Stripes of light along the vertical, far away all around the viewer, as the surface mirrors them.
float slimPhase(vec3 normal, vec3 ray)
{
  return kStripes * asin(clamp(reflect(ray, normal).x, -1.0, 1.0));
}

vec3 slimStripe(float phase)
{
  float share = clamp(0.5 + sin(phase) / kStripeEdge, 0.0, 1.0);
  return slimLinear(mix(kStripeDark, vec3(kStripeLight), share));
}

// Where a ray of a frame has got to at a depth along it, in the camera's axes.
vec3 slimPlace(ivec2 at, float depth);

// How open the half space over a pixel is: neighbours on a spiral. rays: of a pixel along each axis; pixel:
// its length at that depth.
float slimOpen(ivec2 at, int rays, vec3 place, vec3 normal, float pixel)
{
  ivec2 size = textureSize(slimGeometry, 0), own = at / rays;
  float pixels = max(2.0, kHollowReach * float(min(size.x, size.y) / rays)), reach = pixels * pixel;
  int pattern = (own.y & 3) * 4 + (own.x & 3);
  float turn = 6.28318531 * float((pattern * 7) % 16) / 16.0, hidden = 0.0;
  for (int i = 0; i < int(kHollowSamples); ++i) {
    float r = max(1.0, pixels * sqrt((float(i) + 0.5) / kHollowSamples));
    float angle = turn + kGoldenAngle * float(i);
    ivec2 to = at + rays * ivec2(round(r * vec2(cos(angle), sin(angle))));
    if (to.x < 0 || to.y < 0 || to.x >= size.x || to.y >= size.y) continue;
    float depth = texelFetch(slimGeometry, to, 0).w;
    if (depth == 0.0) continue;
    vec3 d = slimPlace(to, abs(depth)) - place;
    float square = dot(d, d);
    if (square <= 0.0) continue;
    float rise = max(0.0, dot(d, normal) / sqrt(square) - kHollowRise);
    hidden += rise * max(0.0, 1.0 - square / (4.0 * reach * reach));
  }
  return max(0.0, 1.0 - kHollowStrength * hidden / kHollowSamples);
}
)";
std::string lightConstantsGlsl() {
  std::string text;
  for (const LightConstant& c : kLightConstants) {
    const std::string type = c.count > 1 ? "vec3" : "float";
    std::string values = std::to_string(c.value[0]);
    for (int k = 1; k < c.count; ++k) {
      values += ", " + std::to_string(c.value[static_cast<std::size_t>(k)]);
    }
    text += "const " + type + " " + c.name + " = " + type + "(" + values + ");\n";
  }
  return text;
}

}  // namespace pcl_slim::detail
