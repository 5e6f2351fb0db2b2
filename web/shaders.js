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
layout(location = 0) in vec4 slimHeights;  // bounds within the reach of pass 1, and in the whole ball
layout(location = 1) in float slimSteep;   // bound of the slope
uniform float slimFar;
uniform float slimMargin;  // of the bounds

void main()
{
  slimPass(gl_InstanceID);
  vec4 ball = slimBall, more = slimTexel(gl_InstanceID * slimTexelsOfLeaf + 3);
  vec3 w = slimNormal.xyz, u = slimAxis.xyz;
  vec3 center = (ball.xyz - slimEye) - slimEyeRest;
  float depth = dot(center, slimAxes[2]);
  slimTrim = slimTrimOf(more);
  slimPart = slimPartOf(more, depth);
  if (slimPart.x <= 0.0 || depth < -ball.w || slimTurnedAway(center, w, ball.w, slimSteep)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  int corner = 1 << gl_VertexID;  // of a cube as one strip
  vec2 heights = slimFirstPass != 0 ? slimHeights.xy : slimHeights.zw;
  float x = (0x287a & corner) != 0 ? 1.001 : -1.001, y = (0x02af & corner) != 0 ? 1.001 : -1.001;
  float above = slimFirstPass != 0 ? slimMargin : kMaxShift;
  float z = (0x31e3 & corner) != 0 ? heights.y + above : heights.x - slimMargin;
  vec3 place = (center + ball.w * (slimReach * (x * u + y * cross(w, u)) + z * w)) * slimAxes;
  float along = slimScreen.w > 0.0 ? 1.0 : place.z;
  float front = (slimScreen.w > 0.0 ? depth : length(center)) - 1.001 * ball.w;
  gl_Position = vec4(2.0 * (vec2(place.x, -place.y) / slimScreen.x - slimShift * along) / slimScreen.yz,
                     (2.0 * clamp(front / slimFar, 0.0, 1.0) - 1.0) * along, along);
}
`;

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
layout(location = 0) in vec4 slimFrom;   // place and kind
layout(location = 1) in vec3 slimTo;
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
  vec3 a = slimSeen(slimFrom.xyz), b = slimSeen(slimTo);
  bool parallel = slimScreen.w > 0.0;
  vec2 size = 0.5 * slimScreen.x * slimScreen.yz;
  vec2 p = a.xy / (parallel ? 1.0 : max(a.z, 1e-6)) / size, q = b.xy / (parallel ? 1.0 : max(b.z, 1e-6)) / size;
  vec2 run = (q - p) * slimCanvas;
  vec2 aside = vec2(-run.y, run.x) / max(length(run), 1e-6) / slimCanvas;
  bool end = (gl_VertexID & 2) != 0;
  slimSide = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  vec3 place = end ? b : a;
  slimAway = parallel ? place.z : length(place);
  slimKind = slimFrom.w;
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
export function surfacePrograms(constants, textured = false) {
  const head = HEAD(constants), es = text => text.replace(/gl_FragData\[(\d)\]/g, 'slimOut[$1]');
  const camera = SHARED.kCameraGlsl, vertexCamera = camera.slice(0, camera.indexOf('vec2 slimSlopes'));
  const hull = head + vertexCamera + SHARED.kSurfel + HULL_VERTEX, frame = head + FRAME_VERTEX;
  const ofLeaves = (outputs, ...parts) => head + OUTPUTS(outputs) + es(camera + SHARED.kLeafGlsl + parts.join(''));
  const ofFrame = (outputs, ...parts) => head + OUTPUTS(outputs) + es(parts.join(''));
  const renamed = text => text.replace('void main()', 'void slimMain()');
  return {
    first: [hull, ofLeaves(1, SHARED.kTrims, renamed(SHARED.kFirstPass), FIRST_DEPTH)],
    blend: [hull, ofLeaves(5, SHARED.kBlended, SHARED.kTrims, SHARED.kBlendPass)],
    name: [hull, ofLeaves(1, SHARED.kBlended, SHARED.kLeafPass)],
    paint: [hull, ofLeaves(1, SHARED.kBlended, SHARED.kColors, textured ? TEXTURES + SHARED.kTextureColors : SHARED.kPlainColors,
                           SHARED.kColorPass)],
    depths: [frame, head + MET_DEPTH],
    result: [frame, ofFrame(3, SHARED.kSums, SHARED.kResult)],
    peel: [frame, ofFrame(1, SHARED.kSums, SHARED.kPeel)],
    shade: [frame, ofFrame(1, camera, GEOMETRY, SHARED.kSrgb, SHARED.kLight, SHADE)],
    present: [frame, ofFrame(1, SHARED.kSrgb, PRESENT)],
    lines: [head + vertexCamera + LINE_VERTEX, ofFrame(1, LINE)],
    box: [frame, ofFrame(1, camera, BOX)],
  };
}
