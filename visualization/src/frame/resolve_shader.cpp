// SPDX-License-Identifier: BSD-3-Clause
#include <vtkShaderProgram.h>

#include <algorithm>

#include "frame/frame.h"
#include "frame/light_glsl.h"

namespace pcl_slim::detail {
namespace {

constexpr const char* kVertex = R"(//VTK::System::Dec
//VTK::Picking::Dec
//VTK::PrimID::Dec
uniform vec4 slimRectangle;  // left, bottom, right, top in normalised device coordinates
void main()
{
  gl_Position = vec4((gl_VertexID & 1) == 0 ? slimRectangle.x : slimRectangle.z,
                     (gl_VertexID & 2) == 0 ? slimRectangle.y : slimRectangle.w, 0.0, 1.0);
  //VTK::PrimID::Impl
  //VTK::Picking::Impl
}
)";

constexpr const char* kDeclarations = R"(
uniform sampler2D slimGeometry;
uniform sampler2D slimAttributes;
uniform sampler2D slimColors;
uniform sampler2D slimTable;
uniform sampler2D slimLines;
uniform int slimHasLines;
uniform vec4 slimViewport;      // x, y, width, height in pixels
uniform vec2 slimTexels;        // of the frame, per pixel of the viewport
uniform vec4 slimPlane;         // scale and shift of x, scale and shift of y on the image plane
uniform vec3 slimDepth;         // parallel or not, where rays begin, view length of a model unit
uniform mat4 slimProjection;
uniform mat3 slimRotation;      // model to view
uniform int slimMode;
uniform vec3 slimRange;         // lowest value, 1 / span, and whether by the logarithm
uniform int slimStudio;         // the pictures' light, not the renderer's
uniform int slimIsLit;
uniform vec3 slimActorColor;
uniform float slimHollows;      // strength of their shade
uniform int slimNumCuts;
uniform vec4 slimCuts[6];       // clipping planes in view coordinates

// Which texels a pixel reads, and how much of each: the one around it where every pixel has a
// ray, the nearest of its own where it has several, otherwise those of the four rays around it that
// met one sheet.
ivec2 slimLow, slimHigh;
vec4 slimWeights;
ivec2 slimFirst;  // of a pixel's own texels

// Rays that a pixel has along each axis; 0 or 1: not more than one.
int slimRays() { return int(slimTexels.y + 0.5); }

void slimChooseNearest(vec2 at)
{
  ivec2 last = textureSize(slimGeometry, 0) - 1;
  slimFirst = ivec2(floor(at - 0.5 * slimTexels + 0.25));
  float nearest = 0.0;
  for (int y = 0; y < slimRays(); ++y) {
    for (int x = 0; x < slimRays(); ++x) {
      ivec2 texel = clamp(slimFirst + ivec2(x, y), ivec2(0), last);
      float depth = abs(texelFetch(slimGeometry, texel, 0).w);
      if (depth == 0.0 || (nearest > 0.0 && nearest <= depth)) continue;
      nearest = depth;
      slimLow = slimHigh = texel;
    }
  }
}

vec4 slimFetch(sampler2D source)
{
  if (slimTexels.y > 0.99) return texelFetch(source, slimLow, 0);
  return slimWeights.x * texelFetch(source, slimLow, 0) +
         slimWeights.y * texelFetch(source, ivec2(slimHigh.x, slimLow.y), 0) +
         slimWeights.z * texelFetch(source, ivec2(slimLow.x, slimHigh.y), 0) +
         slimWeights.w * texelFetch(source, slimHigh, 0);
}

// Levels are not blended: that of the ray that counts most.
vec4 slimFetchLargest(sampler2D source)
{
  if (slimTexels.y > 0.99) return texelFetch(source, slimLow, 0);
  float most = max(max(slimWeights.x, slimWeights.y), max(slimWeights.z, slimWeights.w));
  bool right = slimWeights.y == most || slimWeights.w == most;
  bool below = slimWeights.z == most || slimWeights.w == most;
  return texelFetch(source, ivec2(right ? slimHigh.x : slimLow.x, below ? slimHigh.y : slimLow.y), 0);
}

// The silhouette runs where half of the weight has met something, and between two sheets likewise.
void slimChoose(vec2 at)
{
  ivec2 last = textureSize(slimGeometry, 0) - 1;
  slimWeights = vec4(1.0, 0.0, 0.0, 0.0);
  slimLow = slimHigh = clamp(ivec2(floor(at)), ivec2(0), last);
  if (slimRays() > 1) slimChooseNearest(at);
  if (slimTexels.y > 0.99) return;
  vec2 corner = floor(at - 0.5), f = at - 0.5 - corner;
  slimLow = clamp(ivec2(corner), ivec2(0), last);
  slimHigh = clamp(ivec2(corner) + 1, ivec2(0), last);
  vec4 w = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
  vec4 d = abs(vec4(texelFetch(slimGeometry, slimLow, 0).w,
                    texelFetch(slimGeometry, ivec2(slimHigh.x, slimLow.y), 0).w,
                    texelFetch(slimGeometry, ivec2(slimLow.x, slimHigh.y), 0).w,
                    texelFetch(slimGeometry, slimHigh, 0).w));
  vec4 met = w * vec4(greaterThan(d, vec4(0.0)));
  vec4 filled = d + 1e30 * vec4(equal(d, vec4(0.0)));
  float nearest = min(min(filled.x, filled.y), min(filled.z, filled.w));
  vec4 front = met * vec4(lessThan(d, vec4(1.02 * nearest)));
  float all = dot(met, vec4(1.0)), before = dot(front, vec4(1.0));
  if (all < 0.5) {
    slimWeights = vec4(0.0);
  } else {
    slimWeights = before >= 0.5 * all ? front / before : (met - front) / (all - before);
  }
}

// A pixel beside the silhouette that a line covers belongs to the sheet next to it.
vec4 slimBeside()
{
  vec4 hit = vec4(0.0);
  ivec2 last = textureSize(slimGeometry, 0) - 1;
  for (int y = -2; y <= 2; ++y) {
    for (int x = -2; x <= 2; ++x) {
      vec4 near = texelFetch(slimGeometry, clamp(slimLow + ivec2(x, y), ivec2(0), last), 0);
      if (near.w != 0.0 && (hit.w == 0.0 || abs(near.w) < abs(hit.w))) hit = near;
    }
  }
  return hit;
}

// Lines are drawn where every pixel has a ray.
vec4 slimLineAt()
{
  return slimHasLines != 0 ? texelFetch(slimLines, slimLow, 0) : vec4(0.0);
}

float slimValue(vec4 a)
{
  if (slimMode == 2) return 0.5 * (a.x + a.y);
  if (slimMode == 3) return a.x * a.y;
  if (slimMode == 4) return a.x;
  if (slimMode == 5) return a.y;
  if (slimMode == 6) return floor(a.w);
  if (slimMode == 10) return fract(a.w) * a.z;  // a residual in radii
  return a.z;
}

vec2 slimOnPlane(vec2 texel)
{
  vec2 ndc = 2.0 * texel / (slimTexels * slimViewport.zw) - 1.0;
  return slimPlane.xz * vec2(ndc.x, -ndc.y) + slimPlane.yw;
}
)";

// Of the light's functions, in the camera's axes; then what the texels that are chosen show.
constexpr const char* kShading = R"(
vec3 slimPlace(ivec2 at, float depth)
{
  vec2 plane = slimOnPlane(vec2(at) + 0.5);
  float length = depth * slimDepth.z;
  return slimDepth.x > 0.0 ? vec3(plane, slimDepth.y + length) : length * normalize(vec3(plane, 1.0));
}

vec3 slimNumberColor()
{
  bool whole = slimMode == 6 || slimMode == 10;
  float value = slimValue(whole ? slimFetchLargest(slimAttributes) : slimFetch(slimAttributes));
  if (slimRange.z > 0.0) value = log(max(value, 1e-30));
  float x = clamp((value - slimRange.x) * slimRange.y, 0.0, 1.0);
  float n = float(textureSize(slimTable, 0).x);
  // Each level has a texel of its own; all other tables are interpolated.
  float u = slimMode == 6 ? (floor(min(x * n, n - 1.0)) + 0.5) / n : (x * (n - 1.0) + 0.5) / n;
  return texture(slimTable, vec2(u, 0.5)).rgb;
}

// plain: the object's own colour
vec3 slimBaseOf(vec4 hit, vec3 plain)
{
  if (slimMode == 0) return hit.w < 0.0 ? kClayBack : plain;
  if (slimMode == 1) return 0.5 * hit.xyz / length(hit.xyz) + 0.5;
  if (slimMode == 8 || slimMode == 11) return plain;
  if (slimMode != 9) return slimNumberColor();
  vec4 weighted = slimFetch(slimColors);  // by 1, but for those that the graphics card adds up
  return weighted.rgb / max(weighted.a, 1e-30);
}

// Linear light under the pictures' light; normal and ray in the camera's axes.
vec3 slimLightOf(vec4 hit, vec3 base, vec3 normal, vec3 ray)
{
  if (slimMode == 1 || slimIsLit == 0) return slimLinear(base);
  float dim = 1.0;
  if (slimHollows > 0.0) {
    int rays = max(1, slimRays());
    float at_unit_depth = 2.0 * slimPlane.z * float(rays) / (slimTexels.y * slimViewport.w);
    float pixel = at_unit_depth * (slimDepth.x > 0.0 ? 1.0 : abs(hit.w) * slimDepth.z);
    dim -= slimHollows * (1.0 - slimOpen(slimLow, rays, slimPlace(slimLow, abs(hit.w)), normal, pixel));
  }
  return slimLitColor(slimLinear(base), slimMode > 0, normal, ray, dim);
}

// Stripes at four places of a pixel, as a picture has rays: they are fine where the surface bends.
vec3 slimStripesAbout(float phase)
{
  vec2 quarter = 0.25 * vec2(dFdx(phase), dFdy(phase));
  float up = quarter.x + quarter.y, down = quarter.x - quarter.y;
  return 0.25 * (slimStripe(phase + up) + slimStripe(phase - up) + slimStripe(phase + down) +
                 slimStripe(phase - down));
}

// The mean of a pixel's rays, and the share of them that met something.
vec4 slimMeanOfRays()
{
  ivec2 last = textureSize(slimGeometry, 0) - 1;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < slimRays(); ++y) {
    for (int x = 0; x < slimRays(); ++x) {
      slimLow = clamp(slimFirst + ivec2(x, y), ivec2(0), last);
      vec4 hit = slimFetch(slimGeometry);
      if (hit.w == 0.0) continue;
      vec3 normal = normalize(slimRotation * hit.xyz + vec3(0.0, 0.0, 1e-30)) * vec3(1.0, 1.0, -1.0);
      vec3 ray = slimDepth.x > 0.0 ? vec3(0.0, 0.0, 1.0) : normalize(slimPlace(slimLow, 1.0));
      vec3 light = slimMode == 8 ? slimStripe(slimPhase(normal, ray))
                                 : slimLightOf(hit, slimBaseOf(hit, slimActorColor), normal, ray);
      sum += vec4(light, 1.0);
    }
  }
  return vec4(sum.rgb / max(sum.a, 1.0), sum.a / float(slimRays() * slimRays()));
}
)";

constexpr const char* kPosition = R"(
  vec2 slimAt = vec2(gl_FragCoord.x - slimViewport.x,
                     slimViewport.w - (gl_FragCoord.y - slimViewport.y)) * slimTexels;
  slimChoose(slimAt);
  vec4 slimHit = slimFetch(slimGeometry);
  vec4 slimLine = slimLineAt();
  bool slimOff = slimHit.w == 0.0 && slimLine.a >= 0.5;
  if (slimOff) slimHit = slimBeside();
  vec2 slimXY = slimOnPlane(slimRays() > 1 ? vec2(slimLow) + 0.5 : slimAt);
  float slimT = abs(slimHit.w) * slimDepth.z;
  vec3 slimRay = slimDepth.x > 0.0 ? vec3(0.0, 0.0, -1.0) : normalize(vec3(slimXY, -1.0));
  vec4 vertexVC = slimDepth.x > 0.0 ? vec4(slimXY, -slimDepth.y - slimT, 1.0)
                                    : vec4(slimT * slimRay, 1.0);
  vec3 normalVCVSOutput = normalize(slimRotation * slimHit.xyz + vec3(0.0, 0.0, 1e-30));
)";

constexpr const char* kDepth = R"(
  if (slimHit.w == 0.0) discard;
  for (int i = 0; i < slimNumCuts; ++i) {
    if (dot(slimCuts[i], vertexVC) < -1e-5 * slimT) discard;
  }
  vec4 slimClip = slimProjection * vertexVC;
  gl_FragDepth = clamp(0.5 + 0.5 * slimClip.z / slimClip.w, 0.0, 1.0);
)";

// The renderer's lights leave colours that encode something most of their brightness, as the studio's do.
constexpr const char* kColor = R"(//VTK::Color::Impl
  vec3 slimBase = slimBaseOf(slimHit, slimStudio != 0 ? slimActorColor : diffuseColor);
  if (slimMode == 0) diffuseColor = slimHit.w < 0.0 ? kClayBack : diffuseColor;
  if (slimMode > 0) {
    ambientColor = kCodedAmbient * slimBase;
    diffuseColor = kCodedDiffuse * slimBase;
  }
)";

// The pictures' light in place of what VTK's lights have given; normals, stripes and paper have none of either.
constexpr const char* kFinish = R"(
  vec3 slimInCamera = normalVCVSOutput * vec3(1.0, 1.0, -1.0), slimAway = slimRay * vec3(1.0, 1.0, -1.0);
  if (slimMode == 11) {
    gl_FragData[0] = vec4(1.0, 1.0, 1.0, opacity);
  } else if (slimRays() > 1) {
    vec4 mean = slimMeanOfRays();
    gl_FragData[0] = vec4(slimEncoded(mean.rgb), mean.a * opacity);
  } else if (slimMode == 8) {
    gl_FragData[0] = vec4(slimEncoded(slimStripesAbout(slimPhase(slimInCamera, slimAway))), opacity);
  } else if (slimMode == 1) {
    gl_FragData[0] = vec4(slimBase, opacity);
  } else if (slimStudio != 0) {
    gl_FragData[0] = vec4(slimEncoded(slimLightOf(slimHit, slimBase, slimInCamera, slimAway)), opacity);
  }
  if (slimLine.a > 0.0) {
    vec3 below = slimLinear(clamp(gl_FragData[0].rgb, 0.0, 1.0));
    gl_FragData[0].rgb = slimEncoded(mix(below, slimLinear(slimLine.rgb), slimOff ? 1.0 : slimLine.a));
  }
  //VTK::TCoord::Impl
)";

/** \brief Clipping planes in view coordinates: n.x >= d of the model is (R n).y >= s d + (R n).m
 * with y = s R x + m. */
void tellPlanes(const ViewCamera& view, const GLView& seen, const std::vector<HalfSpace>& planes,
                vtkShaderProgram* program) {
  constexpr std::size_t kMostPlanes = 6;  // as in VTK
  float cuts[kMostPlanes][4] = {};
  const std::size_t count = std::min(planes.size(), kMostPlanes);
  for (std::size_t p = 0; p < count; ++p) {
    double offset = view.view_scale * planes[p].offset;
    for (std::size_t i = 0; i < 3; ++i) {
      double n = 0.0;
      for (std::size_t j = 0; j < 3; ++j) n += view.rotation[3 * i + j] * planes[p].normal[j];
      cuts[p][i] = static_cast<float>(n);
      offset += n * seen.model_to_view[4 * i + 3];
    }
    cuts[p][3] = static_cast<float>(-offset);
  }
  program->SetUniformi("slimNumCuts", static_cast<int>(count));
  if (count > 0) program->SetUniform4fv("slimCuts", static_cast<int>(count), cuts);
}

}  // namespace

const char* resolveVertexShader() {
  return kVertex;
}

void insertResolve(std::string& source) {
  vtkShaderProgram::Substitute(source, "//VTK::PositionVC::Dec",
                               lightConstantsGlsl() + kDeclarations + kSrgb + kLight + kShading);
  vtkShaderProgram::Substitute(source, "//VTK::PositionVC::Impl", kPosition);
  vtkShaderProgram::Substitute(source, "//VTK::Depth::Impl", kDepth);
  // VTK's own clipping would need a distance from the vertex shader.
  vtkShaderProgram::Substitute(source, "//VTK::Clip::Dec", "");
  vtkShaderProgram::Substitute(source, "//VTK::Clip::Impl", "");
  vtkShaderProgram::Substitute(source, "//VTK::Normal::Dec", "");
  vtkShaderProgram::Substitute(source, "//VTK::Normal::Impl", "");
  vtkShaderProgram::Substitute(source, "//VTK::Color::Impl", kColor);
  vtkShaderProgram::Substitute(source, "//VTK::TCoord::Impl", kFinish);
}

void tellView(const ViewCamera& view, const GLView& seen, const std::vector<HalfSpace>& planes,
              vtkShaderProgram* program) {
  const auto f = [](double value) { return static_cast<float>(value); };
  const float texels[2] = {f(view.texels_x), f(view.texels_y)};
  const float plane[4] = {f(view.x_scale), f(view.x_shift), f(view.y_scale), f(view.y_shift)};
  const float depth[3] = {view.parallel ? 1.0f : 0.0f, f(view.start), f(view.view_scale)};
  program->SetUniform2f("slimTexels", texels);
  program->SetUniform4f("slimPlane", plane);
  program->SetUniform3f("slimDepth", depth);
  program->SetUniformi("cameraParallel", view.parallel ? 1 : 0);
  // OpenGL takes columns first.
  float columns3[9], columns4[16];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) columns3[3 * j + i] = f(view.rotation[3 * i + j]);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) columns4[4 * j + i] = f(seen.projection[4 * i + j]);
  }
  program->SetUniformMatrix3x3("slimRotation", columns3);
  program->SetUniformMatrix4x4("slimProjection", columns4);
  tellPlanes(view, seen, planes, program);
}

}  // namespace pcl_slim::detail
