// SPDX-License-Identifier: BSD-3-Clause
// The passes that find first hits, blend the leaves around them and look behind what they do not
// cover.
#include "glsl/glsl.h"

namespace pcl_slim::detail {

/** What a surfel counts for, and where its trim map is. */
const char* const kSurfel = R"(
uniform int slimTexelsOfLeaf;
uniform float slimReach;     // share of a leaf's radius that counts
uniform int slimFirstPass;
uniform int slimFrontOnly;
uniform int slimMostSide;    // nodes a side of a trim map at most
uniform float slimCoverRadius;
uniform float slimDetail;    // radius on the plane at unit depth of the level of detail; 0: none
flat out int slimLeaf;
flat out vec4 slimBall, slimNormal, slimAxis;
flat out vec4 slimTerms[4];
flat out vec3 slimPart;
flat out ivec2 slimTrim;

// Passes a surfel on to its fragments, which would read the same texels once each.
void slimPass(int leaf)
{
  int at = leaf * slimTexelsOfLeaf;
  slimLeaf = leaf;
  slimBall = slimTexel(at);
  slimNormal = slimTexel(at + 1);
  slimAxis = slimTexel(at + 2);
  for (int i = 0; i < 4; ++i) slimTerms[i] = i + 4 < slimTexelsOfLeaf ? slimTexel(at + 4 + i) : vec4(0.0);
}

// How far surfels of a radius stand for their descendants: from the level of detail to half more
// they fade.
float slimCoarse(float radius, float z)
{
  float size = radius / max(slimDetail * (slimScreen.w > 0.0 ? 1.0 : z), 1e-30);
  return smoothstep(0.0, 1.0, (kDetailFade - size) / (kDetailFade - 1.0));
}

// What leaves and internal surfels count for; internal ones cover what they hold, and their balls
// are packed larger than their radii.
vec3 slimPartOf(vec4 more, float z)
{
  vec3 part = vec3(1.0, 1.0 / slimCoverRadius, 1.0);
  if (slimDetail <= 0.0) return part;
  part.x = slimCoarse(more.z, z) * (1.0 - slimCoarse(more.w, z));
  if (slimFirstPass != 0 && part.x < kDetailMeets) part.x = 0.0;
  if (more.z > 0.0) part.yz = vec2(0.0, kMaxShrink / min(slimCoverRadius, kMaxShrink));
  return part;
}

// Whether all gradients in a ball point away from all rays through it: the angle between normal and
// ray is less than what the cones of gradients and of rays leave of a right angle.
bool slimTurnedAway(vec3 center, vec3 w, float radius, float steep)
{
  if (slimFrontOnly == 0) return false;
  float away = length(center);
  if (slimScreen.w == 0.0 && away <= radius) return false;
  float spread = slimScreen.w > 0.0 ? 0.0 : asin(radius / away);
  float facing = slimScreen.w > 0.0 ? dot(slimAxes[2], w) : dot(center, w) / away;
  return acos(clamp(facing, -1.0, 1.0)) + spread < atan(1.0, steep) - 1e-3;
}

ivec2 slimTrimOf(vec4 more)
{
  int rest = int(more.y);
  return rest < 0 ? ivec2(0) : ivec2(4096 * int(more.x) + rest / slimMostSide, rest % slimMostSide + 1);
}
)";

/** The lookup in trim maps. */
const char* const kTrims = R"(
uniform int slimTrimmed;

// Weights of the node nearest to a coordinate and of its neighbours.
vec3 slimSpline(float coordinate, int last, out int node)
{
  float x = clamp(0.5 * (coordinate + 1.0), 0.0, 1.0) * float(last);
  node = int(x + 0.5);
  float d = x - float(node);
  return vec3(0.5 * (0.5 - d) * (0.5 - d), 0.75 - d * d, 0.5 * (0.5 + d) * (0.5 + d));
}

// How far outside of its data a leaf is: 0 inside, 1 outside, 1/2 on the border. A word holds the
// nodes below, on and above a row in columns 8 q - 1 ... 8 q + 8, a bit each, set outside.
float slimOutside(float u, float v)
{
  if (slimTrimmed == 0 || slimTrim.y == 0) return 0.0;
  int column, row;
  vec3 x = slimSpline(u, slimTrim.y - 1, column), y = slimSpline(v, slimTrim.y - 1, row);
  int word = slimTrimWord(slimTrim.x + row * ((slimTrim.y + 7) / 8) + column / 8);
  int code = (word >> (3 * (column & 7))) & 511;
  float sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    ivec3 set = (ivec3(code) >> (ivec3(3 * i) + ivec3(0, 1, 2))) & 1;
    sum += x[i] * dot(y, vec3(set));
  }
  return sum;
}
)";

const char* const kFirstPass = R"(
uniform sampler2D slimNearest;   // rays begin here; below 0 where they are done
uniform float slimReach;

// Whether the leaf's own trim map has data on the ray.
bool slimHasData(Leaf leaf, vec3 direction, float s)
{
  vec3 q = slimPart.z * (leaf.point + s * direction);
  return slimOutside(dot(q, leaf.u), dot(q, leaf.v)) <= 0.5;
}

void main()
{
  float nearest = texelFetch(slimNearest, ivec2(gl_FragCoord.xy), 0).x;
  if (nearest < 0.0) discard;
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes);
  Leaf leaf = slimReadLeaf(slopes, direction);
  float rest = slimReach * slimReach - leaf.distance2;
  if (!(rest > 0.0)) discard;
  float high = sqrt(rest), low = max(-high, (nearest - leaf.depth) / leaf.radius);
  if (!(low <= high)) discard;
  float a[5];
  slimAlongRay(leaf, direction, a);
  vec4 roots = slimRoots(a, low, high);
  float first = kNoRoot;
  for (int i = 0; i < 4; ++i) {
    float s = roots[i];
    if (s < first && slimFaces(a, s) && slimHasData(leaf, direction, s)) first = s;
  }
  if (first == kNoRoot) discard;
  gl_FragData[0] = vec4(leaf.depth + first * leaf.radius);
}
)";

/** What pass 2 and the choice of the largest weight have in common. */
const char* const kBlended = R"(
uniform sampler2D slimFirst;
uniform float slimReach;
uniform float slimNear;
uniform int slimKernel;

float slimWeight(float s2)
{
  if (!(s2 < 1.0)) return 0.0;
  float q = 1.0 - s2;
  if (slimKernel == 2) return q * q;
  if (slimKernel == 4) return q * q * q * q;
  if (slimKernel == 7) return q * q * q * q * q * q * q;
  if (s2 < 0.25) return exp(-8.0 * s2);
  float d = 1.0 - sqrt(s2);
  return 16.0 * exp(-2.0) * d * d * d * d;
}

// Whether a leaf may count at the first intersection.
bool slimReaches(Leaf leaf, float s_hat)
{
  return leaf.distance2 < slimReach * slimReach && leaf.distance2 + s_hat * s_hat < 1.0;
}

// A leaf's root nearest to the first intersection, which it reaches, and its weight there; 0 where
// it does not count.
float slimBlendedRoot(Leaf leaf, float a[5], float s_hat, out float s)
{
  float hat2 = leaf.distance2 + s_hat * s_hat;
  s = kNoRoot;
  if (!(abs(slimValue(a, s_hat)) < kMaxShift)) return 0.0;
  float high = sqrt(max(0.0, 1.0 - leaf.distance2));
  float low = max(-high, (slimNear - leaf.depth) / leaf.radius);
  if (!(low <= high)) return 0.0;
  vec4 roots = slimRoots(a, low, high);
  for (int i = 0; i < 4; ++i) {
    if (abs(roots[i] - s_hat) < abs(s - s_hat) && slimFaces(a, roots[i])) s = roots[i];
  }
  if (s == kNoRoot) return 0.0;
  return leaf.weight * slimWeight(max(hat2, leaf.distance2 + s * s));
}
)";

const char* const kBlendPass = R"(
void slimJet(Leaf leaf, float u, float v, out vec2 g, out vec3 h)
{
  g = vec2(leaf.c[1], leaf.c[2]);
  h = vec3(0.0);
  if (slimDegree >= 2) {
    g += vec2(2.0 * leaf.c[3] * u + leaf.c[4] * v, leaf.c[4] * u + 2.0 * leaf.c[5] * v);
    h += vec3(2.0 * leaf.c[3], leaf.c[4], 2.0 * leaf.c[5]);
  }
  if (slimDegree >= 3) {
    float c0 = leaf.c[6], c1 = leaf.c[7], c2 = leaf.c[8], c3 = leaf.c[9];
    g += vec2(3.0 * c0 * u * u + 2.0 * c1 * u * v + c2 * v * v,
              c1 * u * u + 2.0 * c2 * u * v + 3.0 * c3 * v * v);
    h += vec3(6.0 * c0 * u + 2.0 * c1 * v, 2.0 * (c1 * u + c2 * v), 2.0 * c2 * u + 6.0 * c3 * v);
  }
  if (slimDegree >= 4) {
    float c0 = leaf.c[10], c1 = leaf.c[11], c2 = leaf.c[12], c3 = leaf.c[13], c4 = leaf.c[14];
    g += vec2(4.0 * c0 * u * u * u + 3.0 * c1 * u * u * v + 2.0 * c2 * u * v * v + c3 * v * v * v,
              c1 * u * u * u + 2.0 * c2 * u * u * v + 3.0 * c3 * u * v * v + 4.0 * c4 * v * v * v);
    h += vec3(12.0 * c0 * u * u + 6.0 * c1 * u * v + 2.0 * c2 * v * v,
              3.0 * c1 * u * u + 4.0 * c2 * u * v + 3.0 * c3 * v * v,
              2.0 * c2 * u * u + 6.0 * c3 * u * v + 12.0 * c4 * v * v);
  }
}

// Adds a leaf without a root on the ray, which may pass above it.
void slimMiss(Leaf leaf, float hat2, float at_hat, float behind)
{
  if (!(at_hat > 0.0 && at_hat < kMaxShift)) discard;
  gl_FragData[0] = gl_FragData[1] = gl_FragData[2] = gl_FragData[3] = vec4(0.0);
  gl_FragData[4] = vec4(0.0, 0.0, 0.0, leaf.weight * slimWeight(hat2) * leaf.radius * behind);
}

void main()
{
  float first = texelFetch(slimFirst, ivec2(gl_FragCoord.xy), 0).x;
  if (first > 1e30) discard;
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes);
  Leaf leaf = slimReadLeaf(slopes, direction);
  float a[5], s, s_hat = (first - leaf.depth) / leaf.radius;
  if (!slimReaches(leaf, s_hat)) discard;
  slimAlongRay(leaf, direction, a);
  float w = slimBlendedRoot(leaf, a, s_hat, s), behind = slimValue(a, s_hat + kBehind);
  if (s == kNoRoot) {
    slimMiss(leaf, leaf.distance2 + s_hat * s_hat, slimValue(a, s_hat), behind);
    return;
  }
  if (!(w > 0.0)) discard;
  vec3 q = leaf.point + s * direction;
  vec2 g;
  vec3 h;
  float at_u = dot(q, leaf.u), at_v = dot(q, leaf.v);
  slimJet(leaf, at_u, at_v, g, h);
  float side = slimSlope(a, s) > 0.0 ? -1.0 : 1.0;
  float cover = slimWeight((leaf.distance2 + s * s) * slimPart.y * slimPart.y);
  vec3 u = leaf.u, v = leaf.v;
  float scale = -side * w / leaf.radius;
  gl_FragData[0] = vec4(w, w * (s - s_hat) * leaf.radius, cover, 1.0);
  gl_FragData[1] = vec4(w * q, side);
  gl_FragData[2] = vec4(side * w * (leaf.w - g.x * u - g.y * v), w * leaf.radius);
  gl_FragData[3] = vec4(scale * (h.x * u * u + 2.0 * h.y * u * v + h.z * v * v),
                        w * slimOutside(slimPart.z * at_u, slimPart.z * at_v));
  gl_FragData[4] = vec4(scale * (h.x * u.x * u.y + h.y * (u.x * v.y + v.x * u.y) + h.z * v.x * v.y),
                        scale * (h.x * u.x * u.z + h.y * (u.x * v.z + v.x * u.z) + h.z * v.x * v.z),
                        scale * (h.x * u.y * u.z + h.y * (u.y * v.z + v.y * u.z) + h.z * v.y * v.z),
                        w * leaf.radius * min(side * behind, 0.0));
}
)";

const char* const kLeafPass = R"(
uniform float slimScale;
void main()
{
  float first = texelFetch(slimFirst, ivec2(gl_FragCoord.xy), 0).x;
  if (first > 1e30) discard;
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes);
  Leaf leaf = slimReadLeaf(slopes, direction);
  float a[5], s, s_hat = (first - leaf.depth) / leaf.radius;
  if (!slimReaches(leaf, s_hat)) discard;
  slimAlongRay(leaf, direction, a);
  float w = slimBlendedRoot(leaf, a, s_hat, s);
  if (!(w > 0.0)) discard;
  // Depths near 1 tell small weights no longer apart, so it is the logarithm that is compared.
  gl_FragDepth = clamp(-log2(w) / 64.0, 0.0, 0.999);
  gl_FragData[0] = vec4(0.0, 0.0, leaf.radius / slimPart.z * slimScale, leaf.share);
}
)";

/** The sums of a pixel and whether its leaves cover the blend. */
const char* const kSums = R"(
uniform sampler2D slimFirst;
uniform sampler2D slimNearest;
uniform sampler2D slimSums0;
uniform sampler2D slimSums1;
uniform sampler2D slimSums2;
uniform sampler2D slimSums3;
uniform sampler2D slimSums4;
uniform float slimMinCoverage;

bool slimSupported(vec4 sum, vec3 offsets, float outside, float clearance)
{
  if (outside > 0.5 * sum.x || clearance > 0.0) return false;
  if (sum.z >= slimMinCoverage) return true;
  return sum.w > kMinLeaves - 0.5 && dot(offsets, offsets) < kMaxMeanOffset * kMaxMeanOffset * sum.x * sum.x;
}
)";

const char* const kResult = R"(
uniform float slimScale;
uniform int slimOriented;

// Principal curvatures of the level set of gradient g and Hessian (xx yy zz, xy xz yz).
vec2 slimPrincipal(vec3 g, vec3 d, vec3 o)
{
  float n2 = max(dot(g, g), 1e-30);
  float ghg = dot(g * g, d) + 2.0 * (g.x * g.y * o.x + g.x * g.z * o.y + g.y * g.z * o.z);
  float mean = 0.5 * (d.x + d.y + d.z - ghg / n2) / sqrt(n2);
  float minors = g.x * g.x * (d.y * d.z - o.z * o.z) + g.y * g.y * (d.x * d.z - o.y * o.y) +
                 g.z * g.z * (d.x * d.y - o.x * o.x) +
                 2.0 * (g.x * g.y * (o.y * o.z - o.x * d.z) + g.x * g.z * (o.x * o.z - o.y * d.y) +
                        g.y * g.z * (o.x * o.y - o.z * d.x));
  float spread = sqrt(max(0.0, mean * mean - minors / (n2 * n2)));
  return vec2(mean + spread, mean - spread);
}

void main()
{
  ivec2 at = ivec2(gl_FragCoord.xy);
  if (texelFetch(slimNearest, at, 0).x < 0.0) discard;
  float first = texelFetch(slimFirst, at, 0).x;
  vec4 sum = texelFetch(slimSums0, at, 0);
  vec4 offsets = texelFetch(slimSums1, at, 0), bent = texelFetch(slimSums3, at, 0);
  vec4 bent_aside = texelFetch(slimSums4, at, 0);
  if (!(sum.x > 0.0) || !slimSupported(sum, offsets.xyz, bent.w, bent_aside.w)) discard;
  vec3 g = texelFetch(slimSums2, at, 0).xyz / sum.x;
  vec3 d = bent.xyz / sum.x;
  vec3 o = bent_aside.xyz / sum.x;
  float depth = (first + sum.y / sum.x) * slimScale;
  bool behind = slimOriented != 0 && offsets.w < 0.0;
  gl_FragData[0] = vec4(g / sqrt(max(dot(g, g), 1e-30)), behind ? -depth : depth);
  gl_FragData[1] = vec4(slimPrincipal(g, d, o) / slimScale, 0.0, 0.0);
  gl_FragData[2] = vec4(first);
}
)";

const char* const kPeel = R"(
void main()
{
  ivec2 at = ivec2(gl_FragCoord.xy);
  if (texelFetch(slimNearest, at, 0).x < 0.0) discard;
  vec4 sum = texelFetch(slimSums0, at, 0);
  vec3 offsets = texelFetch(slimSums1, at, 0).xyz;
  float outside = texelFetch(slimSums3, at, 0).w, clearance = texelFetch(slimSums4, at, 0).w;
  if (!(sum.x > 0.0) || slimSupported(sum, offsets, outside, clearance)) discard;
  float radius = texelFetch(slimSums2, at, 0).w / sum.x;
  float step = clearance > 0.0 ? kBehind : kPeelStep;
  gl_FragData[0] = vec4(texelFetch(slimFirst, at, 0).x + step * radius);
}
)";

}  // namespace pcl_slim::detail
