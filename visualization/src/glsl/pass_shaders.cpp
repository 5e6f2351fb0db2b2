// SPDX-License-Identifier: BSD-3-Clause
#include "glsl/glsl.h"

#include <string>

#include "pcl_slim/leaf/detail/gates.h"
#include "pcl_slim/render/detail/frame_constants.h"
#include "pcl_slim/surface/surfel_texture.h"

namespace pcl_slim::detail {
namespace {

constexpr const char* kLeafVertex = R"(
uniform int slimDegree;

// Bounds of a sphere's outline on the plane at unit depth, along one axis.
vec2 slimOutline(float x, float z, float radius)
{
  float d = z * z - radius * radius;
  if (z <= 0.0 || d <= 1e-6 * z * z) return vec2(-1e6, 1e6);
  float half_width = radius * sqrt(max(0.0, x * x + d));
  return vec2(x * z - half_width, x * z + half_width) / d;
}

// Bound of the slope all over the ball.
float slimSteepest()
{
  vec4 a = slimTerms[0], b = slimTerms[1], c = abs(slimTerms[2]), d = abs(slimTerms[3]);
  float slope = length(a.yz);
  if (slimDegree >= 2) slope += abs(a.w + b.y) + length(vec2(a.w - b.y, b.x));
  if (slimDegree >= 3) slope += 3.0 * (abs(b.z) + abs(b.w) + c.x + c.y);
  if (slimDegree >= 4) slope += 4.0 * (c.z + c.w + d.x + d.y + d.z);
  return slope;
}

void main()
{
  slimPass(gl_InstanceID);
  vec4 ball = slimBall, more = slimTexel(gl_InstanceID * slimTexelsOfLeaf + 3);
  vec3 from_eye = (ball.xyz - slimEye) - slimEyeRest, center = from_eye * slimAxes;
  slimTrim = slimTrimOf(more);
  slimPart = slimPartOf(more, center.z);
  float radius = 1.001 * slimReach * ball.w;
  vec2 x = vec2(center.x - radius, center.x + radius);
  vec2 y = vec2(center.y - radius, center.y + radius);
  if (slimScreen.w == 0.0) {
    x = slimOutline(center.x, center.z, radius);
    y = slimOutline(center.y, center.z, radius);
  }
  vec2 slope = vec2((gl_VertexID & 1) == 0 ? x.x : x.y, (gl_VertexID & 2) == 0 ? y.x : y.y);
  vec2 ndc = 2.0 * (vec2(slope.x, -slope.y) / slimScreen.x - slimShift) / slimScreen.yz;
  bool hidden = center.z < -radius || slimPart.x <= 0.0 ||
                slimTurnedAway(from_eye, slimNormal.xyz, ball.w, slimSteepest());
  gl_Position = hidden ? vec4(2.0, 2.0, 0.0, 1.0) : vec4(clamp(ndc, -2.0, 2.0), 0.0, 1.0);
}
)";

// Behind all leaves, which are drawn in the middle of the range of depths.
constexpr const char* kFrameVertex = R"(
void main()
{
  gl_Position = vec4((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0,
                     1.0, 1.0);
}
)";

/** The constants of the CPU's renderer. */
std::string constants() {
  std::string text;
  for (const FrameConstant& c : kFrameConstants) {
    text += "const float " + std::string(c.name) + " = " + std::to_string(c.value) + ";\n";
  }
  return text + "const float kColorGate = " + std::to_string(kColorGate) +
         ";\nconst float kOtherSheet = " + std::to_string(kOtherSheet) +
         ";\nconst float kTextureReach = " + std::to_string(SurfelTexture::kReach) +
         ";\nconst float kTextureOuterWeight = " + std::to_string(SurfelTexture::kOuterWeight) +
         ";\n";
}

/** How shaders read a surface here. */
constexpr const char* kTexels = R"(
uniform samplerBuffer slimLeaves;
vec4 slimTexel(int at) { return texelFetch(slimLeaves, at); }
)";
constexpr const char* kTrimTexels = R"(
uniform isamplerBuffer slimTrims;
int slimTrimWord(int at) { return texelFetch(slimTrims, at).x; }
)";
constexpr const char* kTextureTexels = R"(
uniform samplerBuffer slimTextures;
vec3 slimTextureTexel(int at) { return 255.0 * texelFetch(slimTextures, at).rgb; }
)";

const std::string kHead = "//VTK::System::Dec\n" + constants();
const std::string kOutput = "//VTK::Output::Dec\n";

std::string ofLeaves(const std::string& shared, const char* body) {
  return kHead + kOutput + kTexels + kCameraGlsl + kLeafGlsl + shared + body;
}

}  // namespace

std::string leafVertexShader() {
  // slimSlopes() reads a fragment's place, which a vertex has not.
  std::string camera = kCameraGlsl;
  camera.erase(camera.find("// Texels stand"));
  return kHead + kTexels + camera + kSurfel + kLeafVertex;
}

std::string frameVertexShader() {
  return kHead + kFrameVertex;
}

std::string firstPassShader() {
  return ofLeaves(std::string(kTrimTexels) + kTrims, kFirstPass);
}

std::string blendPassShader() {
  return ofLeaves(std::string(kBlended) + kTrimTexels + kTrims, kBlendPass);
}

std::string leafPassShader() {
  return ofLeaves(kBlended, kLeafPass);
}

std::string colorPassShader(bool textured) {
  const std::string colors = std::string(kBlended) + kColors;
  return ofLeaves(textured ? colors + kTextureTexels + kTextureColors : colors + kPlainColors,
                  kColorPass);
}

std::string resultShader() {
  return kHead + kOutput + kSums + kResult;
}

std::string peelShader() {
  return kHead + kOutput + kSums + kPeel;
}

}  // namespace pcl_slim::detail
