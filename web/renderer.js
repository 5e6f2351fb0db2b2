// SPDX-License-Identifier: BSD-3-Clause
// A surface's frames: first hits by the depth test, sums of blends, what they give, and behind what is uncovered
// once more (Ohtake, Belyaev, Alexa 2005, section 3), as visualization/src/opengl does it.
import {Frames, NOTHING} from './frames.js';
import {CUBE, numbersTo, Pieces, TENT} from './pieces.js';
import {surfacePrograms} from './shaders.js';
import {MOST_SIDE, texels} from './surface.js';
import {withinTexels} from './textures.js';
import {Tracer} from './tracer.js';

export class SurfaceFrames extends Frames {
  /** rules: the page's constants with front, trim and near. */
  constructor(gl, surface, rules, page) {
    const radii = Array.from(surface.radius).sort((a, b) => a - b);
    // In units of a typical radius, so that derivatives of small balls do not overflow half floats.
    super(gl, surface, 2 ** Math.round(Math.log2(radii[radii.length >> 1] || 1)), page, gl.RG32F);
    Object.assign(this, {surface, rules});
    this.reach = Math.min(rules.kMaxShrink, Math.max(0.05, surface.coverRadius));
    const textures = surface.textures && withinTexels(surface.textures, this.mostTexels());
    const packed = texels(surface, rules, this.unit, textures);
    Object.assign(this, {perLeaf: packed.perLeaf, colorAt: packed.colorAt, hullAt: packed.hullAt});
    this.texels = packed.data;
    this.leaves = this.dataTexture(packed.data, 4, gl.RGBA32F, gl.RGBA, gl.FLOAT);
    this.trims = this.dataTexture(packed.words, 1, gl.R32I, gl.RED_INTEGER, gl.INT);
    this.texturesSeen = textures;
    if (textures) this.textures = this.dataTexture(textures.rgb, 3, gl.RGB8, gl.RGB, gl.UNSIGNED_BYTE);
    this.hulls = new Pieces(gl, ...CUBE);
    this.tents = new Pieces(gl, ...TENT);
    this.all = numbersTo(surface.count);
    this.allLeaves = this.all.subarray(0, surface.leaves);
    const {box, tent, draft, ...programs} = surfacePrograms(page.constants, !!textures, !!surface.colored);
    this.compile(programs, {box, tent, draft});
    this.query = gl.createQuery();
  }

  /** lod: pixels below which coarser surfels stand for leaves; 0: never. */
  begin(camera, width, height, shift, lod) {
    super.begin(camera, width, height, shift);
    const {surface: s, rules} = this;
    this.detail = 0.5 * lod * this.view.pixel;
    Object.assign(this.values, {
      slimTexelsOfLeaf: this.perLeaf, slimDegree: s.degree, slimFrontOnly: +rules.front, slimKernel: s.kernel,
      slimCoverRadius: Math.min(1, Math.max(0.05, s.coverRadius)), slimScale: 1,
      slimDetail: 0.5 * lod * this.values.slimScreen[0], slimMostSide: MOST_SIDE,
      slimTrimmed: +(rules.trim && s.trimmed), slimMinCoverage: s.coverThreshold, slimOriented: s.oriented,
      slimMargin: 0.001, slimColorAt: this.colorAt, slimHullAt: this.hullAt,
    });
    this.start();
  }

  start() {
    super.start();
    const nearest = this.targets.into.nearest[0];
    if (this.rules.clip) this.enterBox(this.rules.clip, nearest); else this.clear(nearest, [this.values.slimNear, 0, 0, 0]);
  }

  drawHulls(program, reach, first, textures, values = {}) {
    const gl = this.gl, {leaves, trims} = this;
    const whole = this.values.slimDetail > 0 ? this.all : this.allLeaves;
    this.programs[program].use({...this.values, slimReach: reach, slimFirstPass: first, ...values},
      {slimLeaves: leaves, slimTrims: trims, ...textures});
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.cullFace(gl.FRONT);
    this.hulls.draw(whole);
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.DEPTH_TEST);
    gl.depthMask(true);
  }

  /** First hits, blends and what they give; what is uncovered waits for another round. */
  drawRound() {
    const gl = this.gl, t = this.targets, from = this.round++ % 2;
    this.isNamed = this.isPainted = false;
    gl.viewport(0, 0, t.width, t.height);
    const nearest = {slimNearest: t.nearest[from]};
    this.clear(t.into.first, [NOTHING, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    if (this.rules.clip) this.leaveBox();
    gl.depthFunc(gl.LESS);
    this.drawHulls('first', this.reach, 1, nearest);

    this.clear(t.into.sums, ...t.sums.map(() => [0, 0, 0, 0]));
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(false);
    this.drawHulls('blend', 1, 0, {slimFirst: t.first});
    gl.disable(gl.BLEND);

    const sums = Object.fromEntries(t.sums.map((texture, k) => [`slimSums${k}`, texture]));
    gl.bindFramebuffer(gl.FRAMEBUFFER, t.into.result);
    this.drawFrame('result', {slimFirst: t.first, ...nearest, ...sums});
    this.clear(t.into.nearest[1 - from], [-1, 0, 0, 0]);
    gl.beginQuery(gl.ANY_SAMPLES_PASSED, this.query);
    this.drawFrame('peel', {slimFirst: t.first, ...nearest, ...sums});
    gl.endQuery(gl.ANY_SAMPLES_PASSED);
  }

  /** Radius of a surfel's ball, or below 0 where it has no share in the level of detail at a depth. */
  radiusOf(i, depth) {
    const {surface: s, rules, view} = this, isLeaf = i < s.leaves;
    const detail = this.detail * (view.parallel ? 1 : Math.max(depth, 0));
    if (isLeaf && !this.detail) return s.radius[i];
    if (s.own[i] > 1.001 * rules.kDetailFade * detail || s.parent[i] < 0.999 * detail) return -1;
    return isLeaf ? s.radius[i] : s.radius[i] * rules.kMaxShrink / this.reach;
  }

  /** In place of the rounds: each pixel shows one leaf. */
  draft() {
    const t = this.targets, {leaves: slimLeaves, trims: slimTrims} = this, none = [0, 0, 0, 0];
    this.start();
    this.drawFronts(t.into.first, [none], () => {
      this.program('tent').use({...this.values, slimReach: this.reach, slimFirstPass: 1}, {slimLeaves, slimTrims, slimNearest: t.nearest[0]});
      this.tents.draw(this.seen(this.rules.front));
    });
    this.clear(t.into.draft, none, none, [NOTHING, 0, 0, 0], none, none);
    this.drawFrame('draft', {slimLeaves, slimChosen: t.first, slimTextures: this.textures});
    this.isNamed = this.isPainted = true;
  }

  /** All rays of a tile to their end, by the processor. */
  drawTile(tile, look) {
    const gl = this.gl, t = this.targets, tracer = this.tracer ||= new Tracer(this);
    if (tracer.values !== this.values) tracer.begin();
    const {geometry, attributes, met, named, painted} = tracer.trace(tile, look.painted);
    const put = (texture, format, data) => {
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, ...tile.box, format, gl.FLOAT, data);
    };
    put(t.geometry, gl.RGBA, geometry);
    put(t.attributes, gl.RG, attributes);
    put(t.met, gl.RED, met);
    put(t.named, gl.RGBA, named);
    if (painted) put(t.sums[0], gl.RGBA, painted);
    this.isNamed = this.isPainted = true;
  }

  /** Whether rays are left for another round; undefined while the answer is not there. */
  raysLeft() {
    const gl = this.gl;
    if (this.round >= this.rules.kMaxLayers) return false;
    if (!gl.getQueryParameter(this.query, gl.QUERY_RESULT_AVAILABLE)) return undefined;
    return gl.getQueryParameter(this.query, gl.QUERY_RESULT) !== 0;
  }

  /** Level, radius and residual of the leaf of the largest weight. */
  nameLeaves() {
    if (this.isNamed) return;
    const gl = this.gl, t = this.targets;
    gl.viewport(0, 0, t.width, t.height);
    this.clear(t.into.named, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    gl.depthFunc(gl.LESS);
    this.drawHulls('name', 1, 0, {slimFirst: t.met});
    this.isNamed = true;
  }

  /** The colours at the blend, times their weights: of leaves whose balls hold it, however far their polynomials. */
  paint() {
    const gl = this.gl, t = this.targets, painted = t.sums[0];
    if (this.isPainted) return painted;
    gl.viewport(0, 0, t.width, t.height);
    this.clear(t.into.painted, [0, 0, 0, 0]);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.ALWAYS);
    gl.colorMask(false, false, false, false);
    this.drawFrame('depths', {slimGeometry: t.geometry});
    gl.colorMask(true, true, true, true);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(false);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE);
    const textures = this.textures && {slimTextures: this.textures};
    this.drawHulls('paint', 1, 0, {slimShown: t.geometry, ...textures}, {slimMargin: this.rules.kColorGate, slimFrontOnly: 0});
    gl.disable(gl.BLEND);
    this.isPainted = true;
    return painted;
  }
}
