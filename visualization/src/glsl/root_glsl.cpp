// SPDX-License-Identifier: BSD-3-Clause
// Rays, leaves, and the roots of leaves on rays.
#include "glsl/glsl.h"

namespace pcl_slim::detail {

const char* const kCameraGlsl = R"(
uniform vec3 slimEye;        // where rays begin, local units: a float and what it leaves over
uniform vec3 slimEyeRest;
uniform mat3 slimAxes;       // columns: right, up, forward
uniform vec4 slimScreen;     // height of a pixel at unit depth, width, height, parallel or not
uniform vec2 slimShift;      // of all rays, pixels

// Texels stand in rows from the top.
vec2 slimSlopes()
{
  vec2 pixel = floor(gl_FragCoord.xy) + 0.5 + slimShift - 0.5 * slimScreen.yz;
  return slimScreen.x * vec2(pixel.x, -pixel.y);
}

vec3 slimDirection(vec2 slopes)
{
  return slimScreen.w > 0.0 ? slimAxes[2] : normalize(slimAxes * vec3(slopes, 1.0));
}
)";

const char* const kLeafGlsl = R"(
uniform int slimTexelsOfLeaf;
uniform int slimDegree;
uniform int slimFrontOnly;
flat in int slimLeaf;
flat in vec4 slimBall, slimNormal, slimAxis;  // its first three texels
flat in vec4 slimTerms[4];                    // its coefficients
flat in vec3 slimPart;         // share of the weight, 1 / the cover's radius, scale of the ball
flat in ivec2 slimTrim;        // where the trim map begins and its side; side 0: closed

// Along the ray s counts in radii from where it is nearest to the centre.
struct Leaf {
  float radius, weight, share;   // share: level and, as its fraction, the residual in radii
  vec3 u, v, w;
  float c[16];
  float depth;                   // of the nearest point
  vec3 point;                    // that point relative to the centre, in radii
  float distance2;
};

Leaf slimReadLeaf(vec2 slopes, vec3 direction)
{
  Leaf leaf;
  leaf.radius = slimBall.w;
  leaf.weight = slimNormal.w * slimPart.x;
  leaf.share = slimAxis.w;
  leaf.w = slimNormal.xyz;
  leaf.u = slimAxis.xyz;
  leaf.v = cross(leaf.w, leaf.u);
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) leaf.c[4 * i + k] = slimTerms[i][k];
  }
  vec3 center = (slimBall.xyz - slimEye) - slimEyeRest;
  if (slimScreen.w > 0.0) center -= slimAxes * vec3(slopes, 0.0);
  leaf.depth = dot(center, direction);
  leaf.point = (direction * leaf.depth - center) / leaf.radius;
  leaf.distance2 = dot(leaf.point, leaf.point);
  return leaf;
}

float slimValue(float a[5], float s)
{
  return a[0] + s * (a[1] + s * (a[2] + s * (a[3] + s * a[4])));
}

float slimSlope(float a[5], float s)
{
  return a[1] + s * (2.0 * a[2] + s * (3.0 * a[3] + s * 4.0 * a[4]));
}

// Written out: as a loop, Mesa 22.3 derived a derivative wrongly.
void slimDerive(float a[5], out float d[5])
{
  d[0] = a[1];
  d[1] = 2.0 * a[2];
  d[2] = 3.0 * a[3];
  d[3] = 4.0 * a[4];
  d[4] = 0.0;
}

// f / r along the ray: each form of degree k along p + s d by its polar forms.
void slimAlongRay(Leaf leaf, vec3 direction, out float a[5])
{
  float u = dot(leaf.point, leaf.u), v = dot(leaf.point, leaf.v);
  float p = dot(direction, leaf.u), q = dot(direction, leaf.v);
  a[0] = leaf.c[0] + leaf.c[1] * u + leaf.c[2] * v;
  a[1] = leaf.c[1] * p + leaf.c[2] * q;
  a[2] = a[3] = a[4] = 0.0;
  if (slimDegree >= 2) {
    float gu = 2.0 * leaf.c[3] * u + leaf.c[4] * v, gv = leaf.c[4] * u + 2.0 * leaf.c[5] * v;
    a[0] += 0.5 * (gu * u + gv * v);
    a[1] += gu * p + gv * q;
    a[2] += leaf.c[3] * p * p + leaf.c[4] * p * q + leaf.c[5] * q * q;
  }
  if (slimDegree >= 3) {
    float c0 = leaf.c[6], c1 = leaf.c[7], c2 = leaf.c[8], c3 = leaf.c[9];
    float gu = 3.0 * c0 * u * u + 2.0 * c1 * u * v + c2 * v * v;
    float gv = c1 * u * u + 2.0 * c2 * u * v + 3.0 * c3 * v * v;
    float hu = 3.0 * c0 * p * p + 2.0 * c1 * p * q + c2 * q * q;
    float hv = c1 * p * p + 2.0 * c2 * p * q + 3.0 * c3 * q * q;
    a[0] += (gu * u + gv * v) / 3.0;
    a[1] += gu * p + gv * q;
    a[2] += hu * u + hv * v;
    a[3] += (hu * p + hv * q) / 3.0;
  }
  if (slimDegree >= 4) {
    float c0 = leaf.c[10], c1 = leaf.c[11], c2 = leaf.c[12], c3 = leaf.c[13], c4 = leaf.c[14];
    float gu = 4.0 * c0 * u * u * u + 3.0 * c1 * u * u * v + 2.0 * c2 * u * v * v + c3 * v * v * v;
    float gv = c1 * u * u * u + 2.0 * c2 * u * u * v + 3.0 * c3 * u * v * v + 4.0 * c4 * v * v * v;
    float hu = 4.0 * c0 * p * p * p + 3.0 * c1 * p * p * q + 2.0 * c2 * p * q * q + c3 * q * q * q;
    float hv = c1 * p * p * p + 2.0 * c2 * p * p * q + 3.0 * c3 * p * q * q + 4.0 * c4 * q * q * q;
    float uu = 12.0 * c0 * u * u + 6.0 * c1 * u * v + 2.0 * c2 * v * v;
    float uv = 3.0 * c1 * u * u + 4.0 * c2 * u * v + 3.0 * c3 * v * v;
    float vv = 2.0 * c2 * u * u + 6.0 * c3 * u * v + 12.0 * c4 * v * v;
    a[0] += 0.25 * (gu * u + gv * v);
    a[1] += gu * p + gv * q;
    a[2] += 0.5 * (uu * p * p + 2.0 * uv * p * q + vv * q * q);
    a[3] += hu * u + hv * v;
    a[4] += 0.25 * (hu * p + hv * q);
  }
  a[0] = dot(leaf.point, leaf.w) - a[0];
  a[1] = dot(direction, leaf.w) - a[1];
  for (int i = 2; i < 5; ++i) a[i] = -a[i];
}

// Where there is no root; beyond any ball.
const float kNoRoot = 1e9;

// The root in an interval in which the polynomial is monotone. Newton steps that leave the bracket,
// or shrink it too slowly, are replaced by bisection.
float slimRootBetween(float a[5], float low, float high, float none)
{
  float at_low = slimValue(a, low), at_high = slimValue(a, high);
  if ((at_low > 0.0) == (at_high > 0.0)) return none;
  float x = low + (high - low) * at_low / (at_low - at_high);
  for (int i = 0; i < 24; ++i) {
    float value = slimValue(a, x);
    bool before = (value > 0.0) == (at_low > 0.0);
    low = before ? x : low;
    high = before ? high : x;
    float next = x - value / slimSlope(a, x);
    bool slow = i > 8 && (i & 1) == 0;
    if (!(next >= low && next <= high) || slow) next = 0.5 * (low + high);
    // Nearer than this rounding moves the steps, and the bracket stays wide.
    bool settled = abs(next - x) < 1e-6;
    x = next;
    if (settled) break;
  }
  return x;
}

// Both roots, ascending, of a[0] + a[1] s + a[2] s^2; kNoRoot for those that are missing.
vec2 slimQuadratic(float a[5])
{
  if (a[2] == 0.0) return vec2(a[1] == 0.0 ? kNoRoot : -a[0] / a[1], kNoRoot);
  float d = a[1] * a[1] - 4.0 * a[2] * a[0];
  if (d < 0.0) return vec2(kNoRoot);
  float t = -0.5 * (a[1] + (a[1] < 0.0 ? -sqrt(d) : sqrt(d)));
  float x = t / a[2], y = t == 0.0 ? x : a[0] / t;
  return vec2(min(x, y), max(x, y));
}

// Places between which a cubic is monotone; those that are missing are at the interval's ends.
vec2 slimTurns(float a[5], float low, float high)
{
  float d[5];
  slimDerive(a, d);
  return clamp(slimQuadratic(d), vec2(low), vec2(high));
}

// Roots in an interval, those that are missing at kNoRoot.
vec4 slimRoots(float a[5], float low, float high)
{
  if (slimDegree <= 2) {
    vec2 r = slimQuadratic(a);
    return vec4(r.x >= low && r.x <= high ? r.x : kNoRoot, r.y >= low && r.y <= high ? r.y : kNoRoot,
                kNoRoot, kNoRoot);
  }
  // Most leaves are so flat that the slope keeps its sign all along the chord.
  float h = max(abs(low), abs(high));
  float bend = h * (2.0 * abs(a[2]) + h * (3.0 * abs(a[3]) + h * 4.0 * abs(a[4])));
  if (abs(a[1]) > bend) {
    return vec4(slimRootBetween(a, low, high, kNoRoot), kNoRoot, kNoRoot, kNoRoot);
  }
  if (slimDegree == 3) {
    vec2 k = slimTurns(a, low, high);
    return vec4(slimRootBetween(a, low, k.x, kNoRoot), slimRootBetween(a, k.x, k.y, kNoRoot),
                slimRootBetween(a, k.y, high, kNoRoot), kNoRoot);
  }
  float d[5];
  slimDerive(a, d);
  vec2 k = slimTurns(d, low, high);
  float x = slimRootBetween(d, low, k.x, low), y = slimRootBetween(d, k.x, k.y, k.x),
        z = slimRootBetween(d, k.y, high, high);
  return vec4(slimRootBetween(a, low, x, kNoRoot), slimRootBetween(a, x, y, kNoRoot),
              slimRootBetween(a, y, z, kNoRoot), slimRootBetween(a, z, high, kNoRoot));
}

bool slimFaces(float a[5], float s)
{
  return slimFrontOnly == 0 || slimSlope(a, s) < 0.0;
}
)";

}  // namespace pcl_slim::detail
