// SPDX-License-Identifier: BSD-3-Clause
// What frames of surfaces and splats have in common in WebGL 2: programs, targets, colours, lines over them.

import {within} from './box.js';
import {numbersTo, Pieces, seenBalls, SQUARE, tilesOf} from './pieces.js';
import {along, length, minus, scaled} from './vectors.js';

export const NOTHING = 3e38;
const ROW = 2048, MARGIN = 2, AWAY = 0.4;  // margin in pixels

/** Why this browser cannot draw, or nothing. */
export function obstacle(gl) {
  if (!gl) return 'This browser has no WebGL 2';
  if (!gl.getExtension('EXT_color_buffer_float')) return 'This device draws no float colours';
  if (gl.getParameter(gl.MAX_DRAW_BUFFERS) < 5) return 'This device draws too few colours at once';
  return '';
}

/** Whether frames are drawn by the processor: hundreds of times slower. */
export function isSoftware(gl) {
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** A linked program that takes its uniforms by name. */
class Program {
  constructor(gl, [vertex, fragment]) {
    this.gl = gl;
    this.id = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.id, shader);
      this.log = () => gl.getShaderInfoLog(shader) + gl.getProgramInfoLog(this.id);
    }
    gl.linkProgram(this.id);
  }

  use(values, textures) {
    const gl = this.gl;
    if (!this.places) this.find();
    gl.useProgram(this.id);
    for (const [name, value] of Object.entries(values)) if (this.places[name]) this.places[name](value);
    Object.entries(textures).forEach(([name, texture], unit) => {
      if (!this.places[name]) return;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      this.places[name](unit);
    });
  }

  find() {
    const gl = this.gl;
    if (!gl.getProgramParameter(this.id, gl.LINK_STATUS)) throw new Error(this.log());
    const set = {
      [gl.FLOAT]: (at, v) => gl.uniform1f(at, v), [gl.FLOAT_VEC2]: (at, v) => gl.uniform2fv(at, v),
      [gl.FLOAT_VEC3]: (at, v) => gl.uniform3fv(at, v), [gl.FLOAT_VEC4]: (at, v) => gl.uniform4fv(at, v),
      [gl.FLOAT_MAT3]: (at, v) => gl.uniformMatrix3fv(at, false, v),
    };
    this.places = {};
    for (let i = 0; i < gl.getProgramParameter(this.id, gl.ACTIVE_UNIFORMS); ++i) {
      const {name, type} = gl.getActiveUniform(this.id, i), at = gl.getUniformLocation(this.id, name);
      const to = set[type] || ((place, v) => gl.uniform1i(place, v));
      this.places[name.replace('[0]', '')] = value => to(at, value);
    }
  }
}

/** Textures and framebuffers of one size. */
class Targets {
  constructor(gl, width, height, sums, attributes) {
    Object.assign(this, {gl, width, height, format: sums, made: []});
    this.depth = this.buffer();
    this.first = this.texture(gl.R32F);
    this.nearest = [this.texture(gl.R32F), this.texture(gl.R32F)];
    this.sums = [0, 1, 2, 3, 4].map(() => this.texture(sums));
    this.geometry = this.texture(gl.RGBA32F);
    this.attributes = this.texture(attributes);
    this.met = this.texture(gl.R32F);
    this.named = this.texture(gl.RGBA32F);
    this.colors = this.texture(gl.RGBA16F, gl.LINEAR);
    this.into = {
      first: this.frame([this.first], true), firstNamed: this.frame([this.first, this.named], true), sums: this.frame(this.sums, true),
      result: this.frame([this.geometry, this.attributes, this.met]),
      nearest: this.nearest.map(texture => this.frame([texture])),
      draft: this.frame([this.geometry, this.attributes, this.met, this.named, this.sums[0]]),
      named: this.frame([this.named], true), painted: this.frame([this.sums[0]], true), colors: this.frame([this.colors]),
    };
  }
  texture(format, filter = this.gl.NEAREST) {
    const gl = this.gl, texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, this.width, this.height);
    for (const name of ['MIN', 'MAG']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}_FILTER`], filter);
    for (const name of ['S', 'T']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_WRAP_${name}`], gl.CLAMP_TO_EDGE);
    this.made.push(() => gl.deleteTexture(texture));
    return texture;
  }
  buffer() {
    const gl = this.gl, buffer = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT32F, this.width, this.height);
    this.made.push(() => gl.deleteRenderbuffer(buffer));
    return buffer;
  }
  frame(textures, deep) {
    const gl = this.gl, frame = gl.createFramebuffer(), places = textures.map((_, k) => gl.COLOR_ATTACHMENT0 + k);
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    textures.forEach((t, k) => gl.framebufferTexture2D(gl.FRAMEBUFFER, places[k], gl.TEXTURE_2D, t, 0));
    if (deep) gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, this.depth);
    gl.drawBuffers(places);
    this.complete = gl.checkFramebufferStatus(gl.FRAMEBUFFER) === gl.FRAMEBUFFER_COMPLETE && this.complete !== false;
    this.made.push(() => gl.deleteFramebuffer(frame));
    return frame;
  }
  release() { this.made.forEach(release => release()); }
}

/** Frames of a model; whoever draws one adds its passes. */
export class Frames {
  /** model: local units, with bounds and scale; unit: length here, a power of two; page: its options. */
  constructor(gl, model, unit, page, attributes) {
    Object.assign(this, {gl, model, unit, page, attributes, programs: {}});
    this.canAddFloats = !!gl.getExtension('EXT_float_blend');
    this.tileSide = 32;
    this.exact = false;  // sums in 32 bits: half floats take half the memory, and normals .03 degrees
    this.lines = {texture: null};
    this.squares = new Pieces(gl, ...SQUARE);
    this.linePieces = new Pieces(gl, ...SQUARE);
    this.packLines(null);
  }

  /** Programs by name; those in `later` when they are first drawn with. */
  compile(texts, later) {
    for (const [name, pair] of Object.entries(texts)) this.programs[name] = new Program(this.gl, pair);
    this.later = later;
  }

  program(name) { return this.programs[name] ||= new Program(this.gl, this.later[name]); }

  /** Most texels that a data texture has room for. */
  mostTexels() { return ROW * this.gl.getParameter(this.gl.MAX_TEXTURE_SIZE); }

  dataTexture(data, channels, internal, format, type) {
    const gl = this.gl, texture = gl.createTexture(), rows = Math.max(1, Math.ceil(data.length / channels / ROW));
    const padded = new data.constructor(rows * ROW * channels);
    padded.set(data);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, ROW, rows, 0, format, type, padded);
    for (const name of ['MIN', 'MAG']) gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}_FILTER`], gl.NEAREST);
    return texture;
  }

  /** The pieces of the page's lines that are in a box, or all of them. */
  packLines(box) {
    const data = [];
    for (const [kind, ...numbers] of this.page.lines) {
      for (let k = 0; k + 5 < numbers.length; k += 3) {
        const from = numbers.slice(k, k + 3), run = minus(numbers.slice(k + 3, k + 6), from);
        const part = box ? within(box, from, run, 0, 1) : [0, 1];
        if (!part) continue;
        const [a, b] = part.map(t => scaled(along(from, t, run), 1 / this.unit));
        data.push(...a, kind, ...b, 0);
      }
    }
    this.gl.deleteTexture(this.lines.texture);
    this.lines = {texture: this.dataTexture(new Float32Array(data), 4, this.gl.RGBA32F, this.gl.RGBA, this.gl.FLOAT), list: numbersTo(data.length / 8)};
  }

  resize(width, height) {
    const sums = this.exact && this.canAddFloats ? this.gl.RGBA32F : this.gl.RGBA16F, t = this.targets;
    if (t?.width === width && t.height === height && t.format === sums) return;
    t?.release();
    this.targets = new Targets(this.gl, width, height, sums, this.attributes);
    if (this.targets.complete) return;
    if (!this.exact) throw new Error('This device draws no float colours');
    this.canAddFloats = false;
    this.resize(width, height);
  }

  /** Takes up a frame: a camera in local units, the size of its picture and a shift of its rays in pixels. */
  begin(camera, width, height, shift) {
    this.resize(width, height);
    const axes = camera.axes(), [right, up, forward] = axes, {model} = this;
    const eye = camera.position.map(x => x / this.unit), parallel = camera.height > 0;
    const pixel = camera.pixel(width, height) / (parallel ? this.unit : 1);
    const box = model.bounds, away = Math.hypot(...box.center.map((c, k) => c / this.unit - eye[k]));
    this.eye = camera.position;
    this.view = {eye: this.eye, axes, pixel: camera.pixel(width, height), width, height, parallel};
    this.values = {
      slimEye: eye, slimEyeRest: eye.map(x => x - Math.fround(x)), slimAxes: [...right, ...up, ...forward],
      slimScreen: [pixel, width, height, parallel ? 1 : 0], slimShift: shift,
      slimNear: this.page.near / model.scale / this.unit, slimFar: (away + 1.01 * box.radius / this.unit) || 1,
      slimWorld: model.scale * this.unit,
    };
    this.cut(null);
  }

  /** Restricts what follows to a tile of the frame, or to none. */
  cut(tile) {
    const gl = this.gl;
    this.tile = tile;
    if (tile) gl.scissor(...tile.box);
    gl[tile ? 'enable' : 'disable'](gl.SCISSOR_TEST);
  }

  /** The tiles of the frame: whoever draws them need not wait for long. */
  tiles() { return tilesOf(this.view, this.model, this.model.count, (i, depth) => this.radiusOf(i, depth), MARGIN, this.tileSide); }

  /** The pieces that a frame shows, from front to back. faces: those that face the viewer alone */
  seen(faces) {
    const list = [], depths = new Float32Array(this.model.count), {model: {x, y, z, normal: n}, view: {eye, axes: [, , forward], parallel}} = this;
    seenBalls(this.view, this.model, this.model.count, (i, depth) => this.radiusOf(i, depth), MARGIN, (i, left, top, right, bottom, depth) => {
      const ray = parallel ? forward : [x[i] - eye[0], y[i] - eye[1], z[i] - eye[2]];
      const facing = n[3 * i] * ray[0] + n[3 * i + 1] * ray[1] + n[3 * i + 2] * ray[2];
      if (!faces || facing < AWAY * length(ray)) list.push(i);
      depths[i] = depth;
    });
    return Uint32Array.from(list).sort((a, b) => depths[a] - depths[b]);
  }

  /** Lets the frame's rays, or the tile's, begin. */
  start() {
    const gl = this.gl, t = this.targets;
    gl.viewport(0, 0, t.width, t.height);
    gl.disable(gl.BLEND);
    this.clear(t.into.result, [0, 0, 0, 0], [0, 0, 0, 0], [NOTHING, 0, 0, 0]);
    this.round = 0;
    this.isNamed = this.isPainted = false;
  }

  /** Begins what of all pieces is in front in a draft, into a target, and lets it be drawn. */
  drawFronts(frame, colors, draw) {
    const gl = this.gl;
    this.clear(frame, ...colors);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    if (this.rules.clip) this.leaveBox();
    gl.depthFunc(gl.LESS);
    gl.enable(gl.DEPTH_TEST);
    draw();
    gl.disable(gl.DEPTH_TEST);
  }

  clear(frame, ...colors) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    colors.forEach((color, k) => gl.clearBufferfv(gl.COLOR, k, color));
  }

  drawFrame(program, textures, values = {}) {
    this.program(program).use({...this.values, ...values}, textures);
    this.gl.drawArrays(this.gl.TRIANGLE_STRIP, 0, 4);
  }

  /** Where rays enter a box, into a texture. */
  enterBox(box, frame) {
    const [slimLow, slimHigh] = box.map(corner => scaled(minus(corner, this.eye), 1 / this.unit));
    Object.assign(this.values, {slimLow, slimHigh});
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, frame);
    this.drawFrame('box', {});
  }

  /** Where they leave it, into the depths of the bound frame: nothing behind it is met. */
  leaveBox() {
    const gl = this.gl;
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.ALWAYS);
    gl.colorMask(false, false, false, false);
    this.drawFrame('box', {});
    gl.colorMask(true, true, true, true);
    gl.disable(gl.DEPTH_TEST);
  }

  /** Adds the frame's colours to the samples, or takes their place. look: mode, table, range, ... */
  shade(look, add) {
    const gl = this.gl, t = this.targets;
    if (look.named) this.nameLeaves();
    const slimPainted = look.painted ? this.paint() : t.attributes;
    gl.viewport(0, 0, t.width, t.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, t.into.colors);
    if (!add) gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    this.drawFrame('shade', {slimGeometry: t.geometry, slimAttributes: t.attributes, slimNamed: t.named, slimPainted},
      {...look.values, slimHollows: look.hollows});
    gl.disable(gl.BLEND);
  }

  /** Shows the samples on the canvas, and the lines over them. */
  present(lineWidth) {
    const gl = this.gl, {width, height} = gl.canvas, canvas = {slimCanvas: [width, height]};
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.SCISSOR_TEST);
    gl.viewport(0, 0, width, height);
    this.drawFrame('present', {slimColors: this.targets.colors}, canvas);
    if (!this.lines.list.length || !lineWidth) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const slack = 0.004 * this.model.diagonal / this.unit;
    this.programs.lines.use({...this.values, ...canvas, slimWidth: lineWidth, slimSlack: slack},
      {slimLeaves: this.lines.texture, slimGeometry: this.targets.geometry});
    this.linePieces.draw(this.lines.list);
    gl.disable(gl.BLEND);
  }

  /** The frame's columns, rows from the top: normals and depths (local units, below 0 from behind), principal
   * curvatures, and of the named leaf level, residual and radius. */
  read() {
    const gl = this.gl, t = this.targets, of = (frame, k) => {
      const data = new Float32Array(4 * t.width * t.height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      gl.readBuffer(gl.COLOR_ATTACHMENT0 + k);
      gl.readPixels(0, 0, t.width, t.height, gl.RGBA, gl.FLOAT, data);
      gl.readBuffer(gl.COLOR_ATTACHMENT0);
      return data;
    };
    this.nameLeaves();
    return {geometry: of(t.into.result, 0), attributes: of(t.into.result, 1), named: of(t.into.named, 0)};
  }
}
