// SPDX-License-Identifier: BSD-3-Clause
// The pass that blends the colours of leaves: their polynomials, and their textures where a surface
// has some.
#include "glsl/glsl.h"

namespace pcl_slim::detail {

/** A leaf's colour as it is stored: terms of the polynomial, red, green and blue of each; then
 * where its texture is. */
const char* const kColors = R"(
uniform int slimColorAt;      // texel of a leaf at which its colour begins

void slimReadColor(out float terms[20])
{
  for (int i = 0; i < 5; ++i) {
    vec4 four = slimTexel(slimLeaf * slimTexelsOfLeaf + slimColorAt + i);
    for (int k = 0; k < 4; ++k) terms[4 * i + k] = four[k];
  }
}

// 0..255 is the range of colours.
vec3 slimPolynomial(float terms[20], float u, float v)
{
  float powers[6] = float[6](1.0, u, v, u * u, u * v, v * v);
  vec3 color = vec3(0.0);
  for (int i = 0; i < 6; ++i) color += powers[i] * vec3(terms[3 * i], terms[3 * i + 1], terms[3 * i + 2]);
  return color;
}
)";

const char* const kPlainColors = R"(
float slimColorWeight(float s2) { return slimWeight(s2); }

vec3 slimColor(float terms[20], float u, float v, float s2, float width) { return slimPolynomial(terms, u, v); }
)";

const char* const kTextureColors = R"(
// The squared distance from the centre in radii of the surfel, whose ball may be larger.
float slimOwn2(float s2) { return slimPart.z * slimPart.z * s2; }

float slimColorWeight(float s2)
{
  float inner = max(1.0 - slimOwn2(s2) / (kTextureReach * kTextureReach), 0.0);
  float square = inner * inner, fourth = square * square;
  return fourth * fourth + kTextureOuterWeight * slimWeight(s2);
}

// Bilinear between the middles of texels. where: the number of the first one.
vec3 slimTextureColor(int where, int side, float u, float v)
{
  vec2 at = 0.5 * float(side) * (vec2(u, v) / kTextureReach + 1.0) - 0.5;
  at = clamp(at, 0.0, float(side - 1));
  ivec2 low = min(ivec2(at), max(side - 2, 0));
  vec2 part = at - vec2(low);
  int next = min(side - 1, 1), below = where + low.y * side + low.x, above = below + next * side;
  return mix(mix(slimTextureTexel(below), slimTextureTexel(below + next), part.x),
             mix(slimTextureTexel(above), slimTextureTexel(above + next), part.x), part.y);
}

// The mean over a square, which a pixel shows that is wider than texels. width: in radii.
vec3 slimMeanColor(int where, int side, float u, float v, float width)
{
  float texels = 0.5 * float(side) * width / kTextureReach;
  int taps = texels < 1.5 ? 1 : min(int(texels + 0.5), 4);
  if (taps == 1) return slimTextureColor(where, side, u, v);
  float step = width / float(taps), first = 0.5 * (step - width);
  vec3 sum = vec3(0.0);
  for (int k = 0; k < taps * taps; ++k) {
    sum += slimTextureColor(where, side, u + first + step * float(k % taps), v + first + step * float(k / taps));
  }
  return sum / float(taps * taps);
}

vec3 slimColor(float terms[20], float u, float v, float s2, float width)
{
  int rest = int(terms[19]), side = rest % 256;
  if (side == 0 || slimOwn2(s2) >= kTextureReach * kTextureReach) return slimPolynomial(terms, u, v);
  return slimMeanColor(65536 * int(terms[18]) + rest / 256, side, slimPart.z * u, slimPart.z * v, slimPart.z * width);
}
)";

const char* const kColorPass = R"(
uniform sampler2D slimShown;  // normal and depth of the blend
uniform float slimScale;
uniform int slimOriented;
void main()
{
  vec4 shown = texelFetch(slimShown, ivec2(gl_FragCoord.xy), 0);
  if (shown.w == 0.0) discard;
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes);
  Leaf leaf = slimReadLeaf(slopes, direction);
  float s = (abs(shown.w) / slimScale - leaf.depth) / leaf.radius, s2 = leaf.distance2 + s * s;
  float w = leaf.weight * slimColorWeight(s2);
  if (!(w > 0.0)) discard;
  float a[5];
  slimAlongRay(leaf, direction, a);
  bool faces = slimOriented == 0 || dot(leaf.w, shown.xyz) * shown.w > 0.0;
  if (abs(slimValue(a, s)) > kColorGate || !faces) w *= kOtherSheet;
  float terms[20];
  slimReadColor(terms);
  vec3 q = leaf.point + s * direction;
  float pixel = slimScreen.x * (slimScreen.w > 0.0 ? 1.0 : abs(shown.w) / slimScale);
  vec3 color = slimColor(terms, dot(q, leaf.u), dot(q, leaf.v), s2, pixel / leaf.radius);
  // Times 256: as half floats, weights of other sheets would be 0.
  gl_FragData[0] = 256.0 * w * vec4(clamp(color / 255.0, 0.0, 1.0), 1.0);
}
)";

}  // namespace pcl_slim::detail
