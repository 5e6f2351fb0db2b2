// SPDX-License-Identifier: BSD-3-Clause
// Coloured discs: their columns, their frames (first discs, then what lies shortly behind them, blended, as
// modules/render/src/discs does it) and what a ray meets.
import {within} from './box.js';
import {Frames, NOTHING} from './frames.js';
import {numbersTo, Pieces, POINT} from './pieces.js';
import {HEAD, OUTPUTS, surfacePrograms} from './shaders.js';
import {frameOf, octNormal, Planes} from './surface.js';
import {along, dot, minus, scaled} from './vectors.js';

/** The columns of packSplats(), in double. */
export function decodeSplats(bytes) {
  const planes = new Planes(bytes);
  if (planes.number() !== 0x31534c53) throw new Error('foreign');
  const count = planes.number(), hasChange = planes.number();
  if (count > bytes.length) throw new Error('cut');
  const s = {count, leaves: count, scale: 1, origin: planes.doubles(3)}, corner = planes.doubles(3), step = planes.double();
  const log = planes.doubles(2);
  [s.x, s.y, s.z] = corner.map(c => planes.cells(count, c, step));
  const a = planes.get(count, 2), b = planes.get(count, 2);
  s.normal = Float64Array.from({length: 3 * count});
  for (let i = 0; i < count; ++i) s.normal.set(octNormal(a[i], b[i]), 3 * i);
  s.radius = planes.logarithms(count, log);
  s.rgb = [0, 1, 2].map(() => planes.get(count, 1));
  // Change of red, green and blue from the centre to the rim, along u and along v.
  const change = () => Float64Array.from(planes.get(count, 1), c => 4 * (c & 1 ? -(c + 1) / 2 : c / 2));
  s.change = hasChange ? [0, 1, 2].map(() => [change(), change()]) : null;
  if (planes.at !== bytes.length) throw new Error('foreign');
  return s;
}

const DISC = begin => `
const float kHalfDiagonal = 0.70710678;
const float kTolerance = 0.5;  // radii behind the first disc that still blend
flat in int slimDisc;

struct Hit { float depth, cosine, square; vec3 offset; bool front; };

float slimPixelAt(vec3 center) { return slimScreen.x * (slimScreen.w > 0.0 ? 1.0 : max(0.0, dot(center, slimAxes[2]))); }

/** The disc slimDisc and this pixel's ray. pixel: its width there */
bool slimMeets(out vec4 ball, out vec3 normal, out float pixel, out Hit hit)
{
  ball = slimTexel(5 * slimDisc);
  normal = slimTexel(5 * slimDisc + 1).xyz;
  vec3 center = (ball.xyz - slimEye) - slimEyeRest;
  pixel = slimPixelAt(center);
  vec2 slopes = slimSlopes();
  vec3 direction = slimDirection(slopes);
  if (slimScreen.w > 0.0) center -= slimAxes * vec3(slopes, 0.0);
  float facing = dot(normal, direction), middle = dot(center, direction), radius = ball.w;
  float depth = facing != 0.0 ? dot(normal, center) / facing : 1e30;
  float span = max(radius, kHalfDiagonal * pixel) + pixel;
  bool plane = abs(depth - middle) <= span;
  hit.depth = plane ? depth : middle;
  hit.offset = direction * hit.depth - center;
  float far = dot(hit.offset, hit.offset), square = radius * radius;
  hit.square = plane && far < square ? far / square : 1e30;
  vec3 aside = center - middle * direction;
  float filtered = kHalfDiagonal * pixel;
  if (far > square) hit.offset *= radius * inversesqrt(far);
  hit.square = min(hit.square, dot(aside, aside) / (filtered * filtered));
  hit.cosine = abs(facing);
  hit.front = facing <= 0.0;
  return hit.square < 1.0 && hit.depth > ${begin};
}
`;

const DISC_COLOR = `
vec3 slimDiscColor(Hit hit, vec3 normal, float radius)
{
  vec4 u = slimTexel(5 * slimDisc + 2), color = slimTexel(5 * slimDisc + 3);
  vec4 more = slimTexel(5 * slimDisc + 4);  // change of red along u and v, of green along u and v
  vec2 q = radius > 0.0 ? vec2(dot(hit.offset, u.xyz), dot(hit.offset, cross(normal, u.xyz))) / radius : vec2(0.0);
  return clamp(color.xyz + vec3(dot(more.xy, q), dot(more.zw, q), dot(vec2(u.w, color.w), q)), 0.0, 1.0);
}
`;

const VERTEX = `
uniform float slimFar;
flat out int slimDisc;
void main()
{
  slimDisc = gl_VertexID >> 2;
  vec4 ball = slimTexel(5 * slimDisc);
  vec3 center = ((ball.xyz - slimEye) - slimEyeRest) * slimAxes;
  bool parallel = slimScreen.w > 0.0;
  float pixel = slimScreen.x * (parallel ? 1.0 : max(0.0, center.z)), away = length(center);
  float reach = 1.001 * (max(ball.w, 0.7072 * pixel) + 2.0 * pixel);
  vec2 corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0);
  if (center.z < -reach) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (!parallel && away <= reach) { gl_Position = vec4(corner, 0.0, 1.0); return; }
  // A square around where the cone about the disc's ball meets the plane through its centre.
  vec3 view = parallel ? vec3(0.0, 0.0, 1.0) : center / away;
  vec3 x = normalize(abs(view.x) < 0.7 ? vec3(view.z, 0.0, -view.x) : vec3(view.y, -view.x, 0.0)), y = cross(view, x);
  vec3 place = center + (parallel ? reach : reach * away * inversesqrt(away * away - reach * reach)) * (corner.x * x + corner.y * y);
  float along = parallel ? 1.0 : place.z;
  gl_Position = vec4(2.0 * (vec2(place.x, -place.y) / slimScreen.x - slimShift * along) / slimScreen.yz, 0.0, along);
}
`;

/** A disc as a point as wide as its ball. */
const POINT_VERTEX = `
uniform float slimFar;
flat out int slimDisc;
void main()
{
  slimDisc = gl_VertexID;
  vec4 ball = slimTexel(5 * slimDisc);
  vec3 center = ((ball.xyz - slimEye) - slimEyeRest) * slimAxes;
  bool parallel = slimScreen.w > 0.0;
  float along = parallel ? 1.0 : center.z, depth = parallel ? center.z : length(center);
  gl_Position = along <= 0.0 ? vec4(2.0, 2.0, 2.0, 1.0)
      : vec4(2.0 * (vec2(center.x, -center.y) / slimScreen.x - slimShift * along) / slimScreen.yz,
             (2.0 * clamp(depth / slimFar, 0.0, 1.0) - 1.0) * along, along);
  gl_PointSize = 2.0 * ball.w / (slimScreen.x * max(along, 1e-6)) + 2.0;
}
`;

/** What a disc's pixel first meets; begin: where rays begin. */
const FIRST = begin => `
uniform float slimNear, slimFar;
uniform sampler2D slimNearest;
${DISC(begin)}
void main()
{
  vec4 ball;
  vec3 normal;
  float pixel;
  Hit hit;
  if (!slimMeets(ball, normal, pixel, hit)) discard;
  slimOut[0] = vec4(hit.depth);
  slimOut[1] = vec4(hit.cosine, 0.0, ball.w, 0.0);
  gl_FragDepth = clamp(hit.depth / slimFar, 0.0, 1.0);
}
`;

const BLEND = begin => `
uniform float slimNear;
uniform int slimFrontOnly;
uniform sampler2D slimFirst, slimNamed, slimNearest;
${DISC(begin)}${DISC_COLOR}
void main()
{
  ivec2 at = ivec2(gl_FragCoord.xy);
  float first = texelFetch(slimFirst, at, 0).x;
  if (first > 1e30) discard;
  vec4 named = texelFetch(slimNamed, at, 0);
  vec4 ball;
  vec3 normal;
  float pixel;
  Hit hit;
  if (!slimMeets(ball, normal, pixel, hit)) discard;
  float slack = kTolerance * (0.5 * (named.z + ball.w) + pixel);
  if ((hit.depth - first) * max(named.x, hit.cosine) > slack) discard;
  vec3 color = slimDiscColor(hit, normal, ball.w);
  float w = (1.0 - hit.square) * (1.0 - hit.square), side = slimFrontOnly != 0 || hit.front ? w : -w;
  slimOut[0] = vec4(w, w * (hit.depth - first), 0.0, 1.0);
  slimOut[1] = vec4(w * color, 0.0);
  slimOut[2] = vec4(side * normal, 0.0);
  slimOut[3] = slimOut[4] = vec4(0.0);
}
`;

/** The disc on a ray whose middle is in front: its number. */
const DISC_FRONT = begin => `
uniform float slimNear;
uniform sampler2D slimNearest;
${DISC(begin)}
void main()
{
  vec4 ball;
  vec3 normal;
  float pixel;
  Hit hit;
  if (!slimMeets(ball, normal, pixel, hit)) discard;
  slimOut[0] = vec4(slimDisc + 1);
}
`;

/** What it has there, without blending. */
const DISC_DRAFT = `
uniform sampler2D slimChosen;
uniform int slimFrontOnly;
${DISC('0.0').replace('flat in ', '')}${DISC_COLOR}
void main()
{
  slimDisc = int(texelFetch(slimChosen, ivec2(gl_FragCoord.xy), 0).x) - 1;
  if (slimDisc < 0) discard;
  vec4 ball;
  vec3 normal;
  float pixel;
  Hit hit;
  slimMeets(ball, normal, pixel, hit);
  slimOut[0] = vec4(slimFrontOnly != 0 || hit.front ? normal : -normal, hit.depth);
  slimOut[1] = vec4(slimDiscColor(hit, normal, ball.w), 1.0);
  slimOut[2] = vec4(hit.depth);
}
`;

const RESULT = `
uniform sampler2D slimFirst, slimSums0, slimSums1, slimSums2;
void main()
{
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 sum = texelFetch(slimSums0, at, 0);
  if (!(sum.x > 0.0)) discard;
  vec3 normal = texelFetch(slimSums2, at, 0).xyz;
  float first = texelFetch(slimFirst, at, 0).x;
  slimOut[0] = vec4(normal / max(length(normal), 1e-30), first + sum.y / sum.x);
  slimOut[1] = vec4(texelFetch(slimSums1, at, 0).xyz / sum.x, 1.0);
  slimOut[2] = vec4(first);
}
`;

/** Frames of discs: all in one round. */
export class SplatFrames extends Frames {
  constructor(gl, splats, rules, page) {
    const radii = Array.from(splats.radius).sort((a, b) => a - b);
    super(gl, splats, 2 ** Math.round(Math.log2(radii[radii.length >> 1] || 1)), page, gl.RGBA16F);
    this.rules = rules;
    this.discs = this.dataTexture(this.texels(), 4, gl.RGBA32F, gl.RGBA, gl.FLOAT);
    const {shade, present, lines, box} = surfacePrograms(page.constants), frame = shade[0], head = HEAD(page.constants);
    const camera = shade[1].slice(shade[1].indexOf('uniform vec3 slimEye;'), shade[1].indexOf('uniform sampler2D slimGeometry'));
    const atVertex = head + camera.slice(0, camera.indexOf('vec2 slimSlopes')), vertex = atVertex + VERTEX;
    const passes = begin => [[2, FIRST, vertex], [5, BLEND, vertex], [1, DISC_FRONT, atVertex + POINT_VERTEX]].map(([outputs, pass, of]) => [of, head + OUTPUTS(outputs) + camera + pass(begin)]);
    const [first, blend, front] = passes('slimNear'), draft = [frame, head + OUTPUTS(3) + camera + DISC_DRAFT];
    const [firstInBox, blendInBox, frontInBox] = passes('texelFetch(slimNearest, ivec2(gl_FragCoord.xy), 0).x');
    this.compile({shade, present, lines, first, blend, result: [frame, head + OUTPUTS(3) + RESULT]}, {box, front, draft, firstInBox, blendInBox, frontInBox});
    this.tileSide = 96;  // shaders draw them: some calls each
    this.all = numbersTo(splats.count);
    this.points = new Pieces(gl, ...POINT);
  }

  /** Centre and radius; normal; u axis and change of blue along u; colour and change of blue along v; other changes. */
  texels() {
    const s = this.model, data = new Float32Array(20 * s.count), zeros = [[0, 0], [0, 0], [0, 0]];
    for (let i = 0; i < s.count; ++i) {
      const [u, , w] = frameOf(s, i), color = s.rgb.map(c => c[i] / 255);
      const [red, green, blue] = s.change ? s.change.map(c => c.map(axis => axis[i] / 255)) : zeros;
      data.set([...[s.x[i], s.y[i], s.z[i], s.radius[i]].map(x => x / this.unit), ...w, 0, ...u, blue[0],
                ...color, blue[1], ...red, ...green], 20 * i);
    }
    return data;
  }

  begin(camera, width, height, shift) {
    super.begin(camera, width, height, shift);
    this.values.slimFrontOnly = +this.rules.front;
    this.start();
  }

  start() {
    super.start();
    if (this.rules.clip) this.enterBox(this.rules.clip, this.targets.into.nearest[0]);
  }

  drawDiscs(program, textures, draw = () => this.squares.draw(this.tile?.list || this.all)) {
    const {clip} = this.rules, slimNearest = this.targets.nearest[0];
    this.program(clip ? `${program}InBox` : program).use(this.values, {slimLeaves: this.discs, ...clip && {slimNearest}, ...textures});
    draw();
  }

  drawRound() {
    const gl = this.gl, t = this.targets;
    ++this.round;
    gl.viewport(0, 0, t.width, t.height);
    this.clear(t.into.firstNamed, [NOTHING, 0, 0, 0], [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    if (this.rules.clip) this.leaveBox();
    gl.depthFunc(gl.LESS);
    gl.enable(gl.DEPTH_TEST);
    this.drawDiscs('first', {});
    gl.disable(gl.DEPTH_TEST);
    this.clear(t.into.sums, ...t.sums.map(() => [0, 0, 0, 0]));
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    this.drawDiscs('blend', {slimFirst: t.first, slimNamed: t.named});
    gl.disable(gl.BLEND);
    gl.bindFramebuffer(gl.FRAMEBUFFER, t.into.result);
    const [slimSums0, slimSums1, slimSums2] = t.sums;
    this.drawFrame('result', {slimFirst: t.first, slimSums0, slimSums1, slimSums2});
  }

  /** In place of the round: each pixel shows one disc. */
  draft() {
    const gl = this.gl, t = this.targets;
    this.start();
    this.drawFronts(t.into.first, [[0, 0, 0, 0]], () => this.drawDiscs('front', {}, () => this.points.draw(this.seen(false), gl.POINTS)));
    gl.bindFramebuffer(gl.FRAMEBUFFER, t.into.result);
    this.drawFrame('draft', {slimLeaves: this.discs, slimChosen: t.first});
  }

  /** Radius of the ball around a disc; no disc is narrower than a pixel. */
  radiusOf(i, depth) { return Math.max(this.model.radius[i], this.view.pixel * (this.view.parallel ? 1 : depth)); }

  drawTile() {
    this.start();
    this.drawRound();
  }

  raysLeft() { return false; }
  nameLeaves() {}
  paint() { return this.targets.attributes; }
}

/** The first disc on a ray: {depth, point, normal, leaf}, or null. */
export function castSplats(s, rules, eye, direction) {
  const part = rules.clip ? within(rules.clip, eye, direction, rules.near) : [rules.near, Infinity];
  if (!part) return null;
  let [begin, depth] = part, leaf = -1;
  for (let i = 0; i < s.count; ++i) {
    const d = [s.x[i] - eye[0], s.y[i] - eye[1], s.z[i] - eye[2]], n = s.normal.subarray(3 * i, 3 * i + 3);
    const t = dot(n, d) / dot(n, direction), q = minus(scaled(direction, t), d);
    if (t > begin && t < depth && dot(q, q) < s.radius[i] ** 2) [depth, leaf] = [t, i];
  }
  if (leaf < 0) return null;
  const n = Array.from(s.normal.subarray(3 * leaf, 3 * leaf + 3));
  return {depth, leaf, point: along(eye, depth, direction), normal: dot(n, direction) > 0 && !rules.front ? scaled(n, -1) : n};
}
