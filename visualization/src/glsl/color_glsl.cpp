// SPDX-License-Identifier: BSD-3-Clause
// The pass that blends the colours of leaves.
#include "glsl/glsl.h"

namespace pcl_slim::detail {

/** A leaf's colour as it is stored: terms of the polynomial, red, green and blue of each. */
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

vec3 slimColor(float terms[20], float u, float v, float s2) { return slimPolynomial(terms, u, v); }
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
  vec3 color = slimColor(terms, dot(q, leaf.u), dot(q, leaf.v), s2);
  // Times 256: as half floats, weights of other sheets would be 0.
  gl_FragData[0] = 256.0 * w * vec4(clamp(color / 255.0, 0.0, 1.0), 1.0);
}
)";

}  // namespace pcl_slim::detail
