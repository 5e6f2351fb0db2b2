// SPDX-License-Identifier: BSD-3-Clause
// Shaders. What meets a surface and what lights it are texts of visualization/src (SHARED, put in by
// bundle.cmake); here is what differs: WebGL 2 has no buffer textures, and leaves are drawn as hulls.
import {SHARED} from './shared.js';  // made by bundle.cmake

export const HEAD = constants => `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp isampler2D;
${Object.entries(constants).map(([name, v]) => v.length
    ? `const vec3 ${name} = vec3(${v.map(x => x.toFixed(6))});` : `const float ${name} = ${v.toFixed(6)};`).join('\n')}
uniform sampler2D slimLeaves;
uniform isampler2D slimTrims;
vec4 slimTexel(int at) { return texelFetch(slimLeaves, ivec2(at & 2047, at >> 11), 0); }
int slimTrimWord(int at) { return texelFetch(slimTrims, ivec2(at & 2047, at >> 11), 0).x; }
`;

export const OUTPUTS = count => `layout(location = 0) out vec4 slimOut[${count}];\n`;

/** A surfel as the box around the part of its polynomial inside its ball. Back faces are drawn: they are
 * there even where the eye is inside. Blends need rays that pass above it, too. Its depth is that of the ball's front, the same all over. */
const HULL_VERTEX = `
uniform float slimFar;
uniform float slimMargin;  // of the bounds
uniform int slimHullAt;

void main()
{
  int leaf = gl_VertexID >> 3;
  slimPass(leaf);
  vec4 ball = slimBall, more = slimTexel(leaf * slimTexelsOfLeaf + 3);
  vec4 bounds = slimTexel(leaf * slimTexelsOfLeaf + slimHullAt);  // of heights within the reach of pass 1, and in the whole ball
  float steep = slimTexel(leaf * slimTexelsOfLeaf + slimHullAt + 1).x;  // bound of the slope
  vec3 w = slimNormal.xyz, u = slimAxis.xyz;
  vec3 center = (ball.xyz - slimEye) - slimEyeRest;
  float depth = dot(center, slimAxes[2]);
  slimTrim = slimTrimOf(more);
  slimPart = slimPartOf(more, depth);
  if (slimPart.x <= 0.0 || depth < -ball.w || slimTurnedAway(center, w, ball.w, steep)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  vec2 heights = slimFirstPass != 0 ? bounds.xy : bounds.zw;
  float x = (gl_VertexID & 1) != 0 ? 1.001 : -1.001, y = (gl_VertexID & 2) != 0 ? 1.001 : -1.001;
  float above = slimFirstPass != 0 ? slimMargin : kMaxShift;
  float z = (gl_VertexID & 4) != 0 ? heights.y + above : heights.x - slimMargin;
  vec3 place = (center + ball.w * (slimReach * (x * u + y * cross(w, u)) + z * w)) * slimAxes;
  float along = slimScreen.w > 0.0 ? 1.0 : place.z;
  float front = (slimScreen.w > 0.0 ? depth : length(center)) - 1.001 * ball.w;
  gl_Position = vec4(2.0 * (vec2(place.x, -place.y) / slimScreen.x - slimShift * along) / slimScreen.yz,
                     (2.0 * clamp(front / slimFar, 0.0, 1.0) - 1.0) * along, along);
}
`;

/** A surfel as a tent over its plane, at the middle of its heights: of those that overlap the one whose middle is nearest is seen. */
const TENT_VERTEX = `
uniform float slimFar;
uniform int slimHullAt;
out vec2 slimAt;  // place in the plane, radii
const float kTent = 0.4;  // height [radii]

void main()
{
  int corner = gl_VertexID % 5;
  slimLeaf = gl_VertexID / 5;
  vec4 ball = slimTexel(slimLeaf * slimTexelsOfLeaf), more = slimTexel(slimLeaf * slimTexelsOfLeaf + 3);
  vec3 w = slimTexel(slimLeaf * slimTexelsOfLeaf + 1).xyz, u = slimTexel(slimLeaf * slimTexelsOfLeaf + 2).xyz;
  vec2 heights = slimTexel(slimLeaf * slimTexelsOfLeaf + slimHullAt).xy;
  vec3 center = (ball.xyz - slimEye) - slimEyeRest;
  slimTrim = slimTrimOf(more);
  slimPart = slimPartOf(more, dot(center, slimAxes[2]));
  slimAt = corner == 4 ? vec2(0.0) : slimReach * (2.0 * vec2(corner & 1, corner >> 1) - 1.0);
  vec3 place = (center + ball.w * (slimAt.x * u + slimAt.y * cross(w, u) + 0.5 * (heights.x + heights.y) * w)) * slimAxes;
  float along = slimScreen.w > 0.0 ? 1.0 : place.z;
  float depth = (slimScreen.w > 0.0 ? place.z : length(place)) + (corner == 4 ? 0.0 : kTent * ball.w);
  gl_Position = slimPart.x <= 0.0 ? vec4(2.0, 2.0, 2.0, 1.0)
      : vec4(2.0 * (vec2(place.x, -place.y) / slimScreen.x - slimShift * along) / slimScreen.yz,
             (2.0 * clamp(depth / slimFar, 0.0, 1.0) - 1.0) * along, along);
}
`;

/** Numbers of leaves: little to write for what others hide. */
const TENT_FRONT = `
uniform sampler2D slimNearest;
uniform float slimReach, slimFar;
flat in int slimLeaf;
flat in vec3 slimPart;
in vec2 slimAt;
void main()
{
  if (gl_FragCoord.z * slimFar < texelFetch(slimNearest, ivec2(gl_FragCoord.xy), 0).x) discard;
  if (dot(slimAt, slimAt) > slimReach * slimReach || slimOutside(slimPart.z * slimAt.x, slimPart.z * slimAt.y) > 0.5) discard;
  slimOut[0] = vec4(slimLeaf + 1);
}
`;

/** What that leaf has on the ray, without blending: all that a frame's passes give. */
const DRAFT = `
uniform sampler2D slimChosen;
uniform int slimOriented;

void main()
{
  int leaf_number = int(texelFetch(slimChosen, ivec2(gl_FragCoord.xy), 0).x) - 1;
  if (leaf_number < 0) discard;
  slimPass(leaf_number);
  slimPart = slimPartOf(slimTexel(leaf_number * slimTexelsOfLeaf + 3), 1.0);
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes);
  Leaf leaf = slimReadLeaf(slopes, direction);
  float a[5];
  slimAlongRay(leaf, direction, a);
  float s = -a[0] / a[1], most = sqrt(max(0.0, 1.0 - leaf.distance2));
  for (int k = 0; k < 2; ++k) s = clamp(s - slimValue(a, s) / slimSlope(a, s), -most, most);
  if (!(abs(slimValue(a, s)) < kMaxShift)) s = clamp(-dot(leaf.point, leaf.w) / dot(direction, leaf.w), -most, most);
  if (!(abs(slimValue(a, s)) < 1.0)) discard;  // so steep that the plane is no place of it
  float s2 = leaf.distance2 + s * s, depth = leaf.depth + s * leaf.radius;
  vec3 q = leaf.point + s * direction;
  float at_u = dot(q, leaf.u), at_v = dot(q, leaf.v);
  vec2 g;
  vec3 h;
  slimJet(leaf, at_u, at_v, g, h);
  vec3 u = leaf.u, v = leaf.v, normal = leaf.w - g.x * u - g.y * v;
  float side = dot(normal, direction) > 0.0 && slimFrontOnly == 0 ? -1.0 : 1.0, scale = -side / leaf.radius;
  slimOut[0] = vec4(side * normalize(normal), slimOriented != 0 && side < 0.0 ? -depth : depth);
  slimOut[1] = vec4(slimPrincipal(side * normal, scale * (h.x * u * u + 2.0 * h.y * u * v + h.z * v * v),
      scale * vec3(h.x * u.x * u.y + h.y * (u.x * v.y + v.x * u.y) + h.z * v.x * v.y,
                   h.x * u.x * u.z + h.y * (u.x * v.z + v.x * u.z) + h.z * v.x * v.z,
                   h.x * u.y * u.z + h.y * (u.y * v.z + v.y * u.z) + h.z * v.y * v.z)), 0.0, 0.0);
  slimOut[2] = vec4(depth);
  slimOut[3] = vec4(0.0, 0.0, leaf.radius / slimPart.z, leaf.share);
  slimOut[4] = slimDraftColor(at_u, at_v, s2, depth, leaf.radius);
}
`;

const DRAFT_COLOR = `
vec4 slimDraftColor(float u, float v, float s2, float depth, float radius)
{
  float terms[20];
  slimReadColor(terms);
  float pixel = slimScreen.x * (slimScreen.w > 0.0 ? 1.0 : depth);
  return vec4(clamp(slimColor(terms, u, v, s2, pixel / radius) / 255.0, 0.0, 1.0), 1.0);
}
`;

const NO_COLOR = 'vec4 slimDraftColor(float u, float v, float s2, float depth, float radius) { return vec4(0.0); }';

const FRAME_VERTEX = `
void main()
{
  gl_Position = vec4((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0, 0.0, 1.0);
}
`;

/** Depth in the depth buffer as well, which keeps the first hit of all leaves. */
const FIRST_DEPTH = `
uniform float slimFar;
void main()
{
  slimMain();
  gl_FragDepth = clamp(slimOut[0].x / slimFar, 0.0, 1.0);
}
`;

/** The depths of what was met, for tests against them. */
const MET_DEPTH = `
uniform sampler2D slimGeometry;
uniform float slimFar;
void main()
{
  gl_FragDepth = clamp(abs(texelFetch(slimGeometry, ivec2(gl_FragCoord.xy), 0).w) / slimFar, 0.0, 1.0);
}
`;

/** What the light of SHARED.kLight falls on and reads. */
const GEOMETRY = `
uniform sampler2D slimGeometry;
`;

/** Colours of modules/render/src/shading: modes, and the page behind; linear light. */
const SHADE = `
uniform sampler2D slimAttributes, slimNamed, slimPainted;
uniform int slimMode, slimKnots, slimLevels, slimLit;
uniform vec3 slimTable[10];
uniform vec3 slimRange;     // lowest value, 1 / span, and whether by the logarithm
uniform float slimWorld;    // world units per unit here
uniform float slimHollows;  // strength of their shade
uniform vec3 slimPaper;     // grey level at the top, what it loses downwards, tint

vec3 slimBackground(float from_top)
{
  float level = slimPaper.x - slimPaper.y * from_top * from_top;
  return slimLinear(vec3(level, level, level + slimPaper.z));
}

vec2 slimSlopesAt(ivec2 at)
{
  vec2 pixel = vec2(at) + 0.5 + slimShift - 0.5 * slimScreen.yz;
  return slimScreen.x * vec2(pixel.x, -pixel.y);
}

vec3 slimPlace(ivec2 at, float depth)
{
  vec2 slopes = slimSlopesAt(at);
  return slimScreen.w > 0.0 ? vec3(slopes, depth) : normalize(vec3(slopes, 1.0)) * depth;
}

float slimValueOf(ivec2 at)
{
  vec4 a = texelFetch(slimAttributes, at, 0), named = texelFetch(slimNamed, at, 0);
  if (slimMode == 2) return 0.5 * (a.x + a.y) / slimWorld;
  if (slimMode == 3) return a.x * a.y / (slimWorld * slimWorld);
  if (slimMode == 4) return a.x / slimWorld;
  if (slimMode == 5) return a.y / slimWorld;
  if (slimMode == 6) return floor(named.w);
  if (slimMode == 10) return fract(named.w) * named.z * slimWorld;
  return named.z * slimWorld;
}

vec3 slimColorOf(float value)
{
  if (slimLevels != 0) return slimTable[int(value) % 10];
  if (slimRange.z > 0.0) value = log(max(value, 1e-30));
  float x = clamp((value - slimRange.x) * slimRange.y, 0.0, 1.0) * float(slimKnots - 1);
  int k = min(int(x), slimKnots - 2);
  return mix(slimTable[k], slimTable[k + 1], x - float(k));
}

// Everything in the camera's axes: right, up, forward.
vec3 slimShade(ivec2 at, vec4 hit)
{
  vec3 place = slimPlace(at, abs(hit.w)), normal = hit.xyz * slimAxes;
  vec3 ray = slimScreen.w > 0.0 ? vec3(0.0, 0.0, 1.0) : normalize(place);
  if (slimMode == 1) return slimLinear(0.5 * hit.xyz + 0.5);
  if (slimMode == 8) return slimStripe(slimPhase(normal, ray));
  vec3 base = hit.w < 0.0 ? kClayBack : kClay;
  vec4 painted = texelFetch(slimPainted, at, 0);
  if (slimMode == 9) base = painted.a > 0.0 ? painted.rgb / painted.a : vec3(1.0);
  else if (slimMode > 0) base = slimColorOf(slimValueOf(at));
  base = slimLinear(base);
  if (slimLit == 0) return base;
  float pixel = slimScreen.x * (slimScreen.w > 0.0 ? 1.0 : abs(hit.w));
  float dim = slimHollows > 0.0 ? 1.0 - slimHollows * (1.0 - slimOpen(at, 1, place, normal, pixel)) : 1.0;
  return slimLitColor(base, slimMode > 0, normal, ray, dim);
}

void main()
{
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 hit = texelFetch(slimGeometry, at, 0);
  vec3 color = hit.w == 0.0 ? slimBackground((float(at.y) + 0.5) / slimScreen.z) : slimShade(at, hit);
  slimOut[0] = vec4(color, 1.0);
}
`;

/** Where rays enter the clipping box, and as depth where they leave it. */
const BOX = `
uniform vec3 slimLow, slimHigh;  // corners relative to the eye
uniform float slimNear, slimFar;
void main()
{
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes), aside = slimScreen.w > 0.0 ? slimAxes * vec3(slopes, 0.0) : vec3(0.0);
  direction = mix(direction, vec3(1e-20), lessThan(abs(direction), vec3(1e-20)));
  vec3 low = (slimLow - aside) / direction, high = (slimHigh - aside) / direction;
  vec3 begins = min(low, high), ends = max(low, high);
  float begin = max(max(begins.x, begins.y), max(begins.z, slimNear)), end = min(ends.x, min(ends.y, ends.z));
  slimOut[0] = vec4(begin < end ? begin : 1e30);
  gl_FragDepth = begin < end ? clamp(end / slimFar, 0.0, 1.0) : 0.0;
}
`;

/** The mean of the samples, on the canvas, whose rows begin at the bottom. */
const PRESENT = `
uniform sampler2D slimColors;
uniform vec2 slimCanvas;
void main()
{
  vec2 at = gl_FragCoord.xy / slimCanvas;
  vec4 sum = texture(slimColors, vec2(at.x, 1.0 - at.y));
  slimOut[0] = vec4(slimEncoded(sum.rgb / sum.a), 1.0);
}
`;

/** Lines over the surface: a quad for each piece, drawn where the surface is not in front of it. */
const LINE_VERTEX = `
uniform vec2 slimCanvas;
uniform float slimWidth;
out float slimAway, slimSide;
flat out float slimKind;

vec3 slimSeen(vec3 place)
{
  return ((place - slimEye) - slimEyeRest) * slimAxes;
}

void main()
{
  int at = 2 * (gl_VertexID >> 2);
  vec4 from = slimTexel(at);  // place and kind
  vec3 a = slimSeen(from.xyz), b = slimSeen(slimTexel(at + 1).xyz);
  bool parallel = slimScreen.w > 0.0;
  vec2 size = 0.5 * slimScreen.x * slimScreen.yz;
  vec2 p = a.xy / (parallel ? 1.0 : max(a.z, 1e-6)) / size, q = b.xy / (parallel ? 1.0 : max(b.z, 1e-6)) / size;
  vec2 run = (q - p) * slimCanvas;
  vec2 aside = vec2(-run.y, run.x) / max(length(run), 1e-6) / slimCanvas;
  bool end = (gl_VertexID & 2) != 0;
  slimSide = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  vec3 place = end ? b : a;
  slimAway = parallel ? place.z : length(place);
  slimKind = from.w;
  gl_Position = min(a.z, b.z) <= 0.0 && !parallel ? vec4(2.0, 2.0, 2.0, 1.0)
                                     : vec4((end ? q : p) + slimSide * (slimWidth + 1.0) * aside, 0.0, 1.0);
}
`;

const LINE = `
uniform sampler2D slimGeometry;
uniform vec2 slimCanvas;
uniform float slimWidth, slimSlack;
in float slimAway, slimSide;
flat in float slimKind;
void main()
{
  ivec2 size = textureSize(slimGeometry, 0);
  vec2 at = gl_FragCoord.xy / slimCanvas;
  float depth = abs(texelFetch(slimGeometry, ivec2(vec2(at.x, 1.0 - at.y) * vec2(size)), 0).w);
  if (depth > 0.0 && slimAway > depth + slimSlack) discard;
  float soft = clamp(0.5 * (slimWidth + 1.0 - abs(slimSide) * (slimWidth + 1.0)) + 0.5, 0.0, 1.0);
  slimOut[0] = vec4(slimKind < 0.5 ? vec3(0.72, 0.11, 0.09) : vec3(0.10, 0.22, 0.62), soft);
}
`;

/** How shaders read textures of surfels here. */
const TEXTURES = `
uniform sampler2D slimTextures;
vec3 slimTextureTexel(int at) { return 255.0 * texelFetch(slimTextures, ivec2(at & 2047, at >> 11), 0).rgb; }
`;

/** The programs of a surface: [vertex shader, fragment shader] by name. */
export function surfacePrograms(constants, textured = false, colored = textured) {
  const head = HEAD(constants), es = text => text.replace(/gl_FragData\[(\d)\]/g, 'slimOut[$1]');
  const camera = SHARED.kCameraGlsl, vertexCamera = camera.slice(0, camera.indexOf('vec2 slimSlopes'));
  const hull = head + vertexCamera + SHARED.kSurfel + HULL_VERTEX, frame = head + FRAME_VERTEX;
  const ofLeaves = (outputs, ...parts) => head + OUTPUTS(outputs) + es(camera + SHARED.kLeafGlsl + parts.join(''));
  const ofFrame = (outputs, ...parts) => head + OUTPUTS(outputs) + es(parts.join(''));
  const colors = [SHARED.kColors, textured ? TEXTURES + SHARED.kTextureColors : SHARED.kPlainColors];
  const part = (text, begin, end) => text.slice(text.indexOf(begin), text.indexOf(end));
  /** Of equal uniforms the first. */
  const once = text => text.replace(/^uniform .*$/gm, (line, at) => text.indexOf(line) < at ? '' : line);
  const renamed = text => text.replace('void main()', 'void slimMain()');
  return {
    first: [hull, ofLeaves(1, SHARED.kTrims, renamed(SHARED.kFirstPass), FIRST_DEPTH)],
    blend: [hull, ofLeaves(5, SHARED.kBlended, SHARED.kTrims, SHARED.kBlendPass)],
    name: [hull, ofLeaves(1, SHARED.kBlended, SHARED.kLeafPass)],
    paint: [hull, ofLeaves(1, SHARED.kBlended, ...colors, SHARED.kColorPass)],
    tent: [head + vertexCamera + SHARED.kSurfel + TENT_VERTEX, ofFrame(1, 'flat in ivec2 slimTrim;\n', SHARED.kTrims, TENT_FRONT)],
    draft: [frame, once(ofFrame(5, camera, SHARED.kSurfel.replace(/flat out /g, ''), SHARED.kLeafGlsl.replace(/flat in .*/g, ''), SHARED.kBlended,
                                part(SHARED.kBlendPass, 'void slimJet', 'void slimMiss'), part(SHARED.kResult, 'vec2 slimPrincipal', 'void main'),
                                ...colored ? [...colors, DRAFT_COLOR] : [NO_COLOR], DRAFT))],
    depths: [frame, head + MET_DEPTH],
    result: [frame, ofFrame(3, SHARED.kSums, SHARED.kResult)],
    peel: [frame, ofFrame(1, SHARED.kSums, SHARED.kPeel)],
    shade: [frame, ofFrame(1, camera, GEOMETRY, SHARED.kSrgb, SHARED.kLight, SHADE)],
    present: [frame, ofFrame(1, SHARED.kSrgb, PRESENT)],
    lines: [head + vertexCamera + LINE_VERTEX, ofFrame(1, LINE)],
    box: [frame, ofFrame(1, camera, BOX)],
  };
}
