// SPDX-License-Identifier: BSD-3-Clause
// What is drawn when: coarse frames while something moves, then whole ones, then more samples. Without a graphics card they are
// drafts and whole frames tile by tile.
import {centerOf, cornersOf} from './box.js';
import {Camera} from './camera.js';
import {isSoftware} from './frames.js';
import {SurfaceFrames} from './renderer.js';
import {castSplats, SplatFrames} from './splats.js';
import {cast} from './rays.js';
import {boundsOf, bulkOf} from './surface.js';
import {along, length, minus, scaled} from './vectors.js';

export const MODES = ['shaded', 'normal', 'mean', 'gauss', 'kmax', 'kmin', 'level', 'size', 'reflection',
                      'color', 'error'];
const NAMED = ['level', 'size', 'error'], SIGNED = ['mean', 'gauss', 'kmax', 'kmin'];
const MOST_PIXELS = 2.3e6, REST = 160;
const STEP = 60, SHOWN = 250, STRIP = 100;  // milliseconds; rows of pixels that are shaded at once

export class Viewer {
  constructor(gl, surface, page) {
    Object.assign(this, {gl, surface, page, canvas: gl.canvas, isSplats: page.kind === 'splats'});
    surface.bounds = boundsOf(surface);
    surface.diagonal ||= 2 * surface.bounds.radius;
    this.rules = {...page.constants, front: page.front, trim: page.trim, near: page.near / surface.scale};
    this.camera = new Camera(page.camera, page.turn, surface.origin, surface.scale);
    this.home = this.camera.copy();
    this.mode = page.mode;
    this.spread = 1;       // of the range, by the slider
    this.hollows = page.ao;
    this.dark = false;
    this.software = isSoftware(gl);
    this.coarse = 0.5;  // pixels drawn while moving, of the canvas's along an axis
    this.finest = 1;    // the same at rest
    this.samples = 4;   // of every pixel at rest, beside its middle
    this.sampled = this.changes = 0;
    this.renderer = new (this.isSplats ? SplatFrames : SurfaceFrames)(gl, surface, this.rules, page);
    this.lastMove = -Infinity;
    this.onFrame = () => {};
  }

  /** The range of a mode's colours: the page's, spread by the slider. */
  range(mode = this.mode) {
    const [low, high] = mode === this.page.mode && this.page.range || this.page.ranges[mode] || [0, 1];
    if (mode === 'level') return [low, high];
    if (mode === 'size') {
      const middle = Math.sqrt(low * high), ratio = Math.sqrt(high / low) ** this.spread;
      return [middle / ratio, middle * ratio];
    }
    return [low * this.spread, high * this.spread];
  }

  /** Colours of the range, or of ten levels. */
  table(mode = this.mode) {
    const {colors, map} = this.page;
    if (mode === 'level') return colors.category;
    if (map !== 'auto') return colors[map];
    return mode === 'size' ? colors.size : mode === 'error' ? colors.perceptual : colors.diverging;
  }

  /** Clips to a box, two corners in local units, or to none. A cut surface shows its inner side, too, as in pictures. */
  clipTo(box) {
    Object.assign(this.rules, {clip: box, front: box ? this.page.cutFront : this.page.front});
    if (this.page.lines.length) this.renderer.packLines(box);
    this.moved();
  }

  /** Balls [x, y, z, radius] of what is drawn, strays apart, in local units. */
  balls() {
    const {surface: s} = this, [low, high] = this.box(), found = [];
    for (let i = 0; i < s.leaves; ++i) {
      const center = [s.x[i], s.y[i], s.z[i]];
      if (center.every((c, k) => c >= low[k] && c <= high[k])) found.push([...center, s.radius[i]]);
    }
    return found.length ? found : cornersOf([low, high]).map(c => [...along(centerOf([low, high]), 1, c), 0]);
  }

  /** The box around it. */
  box() {
    const bulk = this.bulk ||= bulkOf(this.surface), {clip} = this.rules;
    if (!clip) return bulk;
    const sides = [0, 1, 2].map(k => {
      const low = Math.max(bulk[0][k], clip[0][k]), high = Math.min(bulk[1][k], clip[1][k]);
      return low < high ? [low, high] : [clip[0][k], clip[1][k]];
    });
    return [0, 1].map(side => sides.map(s => s[side]));
  }

  hasRange() { return NAMED.includes(this.mode) || SIGNED.includes(this.mode); }

  look() {
    const {mode, page} = this, table = this.table(), logarithmic = mode === 'size';
    const [low, high] = this.range().map(x => logarithmic ? Math.log(x) : x);
    const plain = mode === 'normal' || mode === 'reflection';
    const lit = mode === page.mode ? page.lighting : true;
    const paper = page.white ? [1, 0, 0] : this.dark ? [0.17, 0.07, 0.012] : page.constants.kPaper;
    return {
      named: NAMED.includes(mode), painted: mode === 'color', hollows: lit && !plain ? this.hollows : 0,
      values: {slimMode: MODES.indexOf(mode), slimKnots: table.length, slimLevels: +(mode === 'level'),
               slimLit: +lit, slimTable: [...table, ...Array(10 - table.length).fill([0, 0, 0])].flat(),
               slimRange: [low, 1 / Math.max(1e-300, high - low), +logarithmic], slimPaper: paper},
    };
  }

  /** Fits the canvas to its place on the page. */
  fit() {
    const {clientWidth: w, clientHeight: h} = this.canvas;
    const most = matchMedia('(pointer: coarse)').matches ? MOST_PIXELS / 2 : MOST_PIXELS;  // phones have less memory
    const ratio = Math.min(window.devicePixelRatio || 1, Math.sqrt(most / Math.max(1, w * h)));
    const width = Math.max(1, Math.round(w * ratio)), height = Math.max(1, Math.round(h * ratio));
    if (this.canvas.width === width && this.canvas.height === height) return;
    [this.canvas.width, this.canvas.height] = [width, height];
    this.moved();
  }

  size(share) {
    return [this.canvas.width, this.canvas.height].map(pixels => Math.max(1, Math.round(pixels * share)));
  }

  /** Something moved: coarse frames until it rests. */
  moved() {
    this.lastMove = performance.now();
    this.sampled = 0;
    ++this.changes;
    this.resting = false;
    this.work = null;
    this.wake();
  }

  /** Colours changed, rays did not. */
  recolor() {
    this.resting = false;
    if (this.renderer.values && !this.isMoving() && !this.software) {
      this.show(false);
      this.work = this.refine();  // whose samples had the old colours
    } else {
      this.moved();
    }
    this.wake();
  }

  isMoving() { return performance.now() - this.lastMove < REST; }

  wake() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(now => this.tick(now));
  }

  tick(now) {
    this.pending = false;
    if (this.gl.isContextLost()) return;
    if (this.isMoving()) {
      this.drawCoarse(now);
      this.wake();
    } else {
      this.lastTick = 0;
      if (this.work === null) this.work = this.refine();
      // A processor has done a step when it returns, and events wait meanwhile; a card has just been told.
      const end = performance.now() + (this.software ? STEP : 0);
      do this.resting = this.work.next().done; while (!this.resting && performance.now() < end);
      if (!this.resting) this.wake();
    }
    this.onFrame();
  }

  drawCoarse(now) {
    const begin = performance.now();
    this.work = null;
    if (this.software && this.drawn === this.lastMove) return;
    this.renderer.begin(this.camera, ...this.size(this.coarse), [0, 0], Math.max(this.page.lod, 1));
    if (this.software) this.renderer.draft();
    else for (let k = 0; k < 2; ++k) this.renderer.drawRound();
    this.show(false);
    if (this.software) {
      this.finish();
      this.drawn = this.lastMove = performance.now();  // it rests once it is seen
    }
    // A frame took as long as the one before it was on the screen.
    const took = this.software ? performance.now() - begin : now - (this.lastTick || now);
    this.lastTick = now;
    if (!(took > 0 && took < 2000)) return;
    const goal = this.software ? 150 : 30, step = Math.min(1.25, Math.max(0.6, Math.sqrt(goal / took)));
    if (step < 0.9 || step > 1.1) this.coarse = Math.min(1, Math.max(this.software ? 0.25 : 0.2, this.coarse * step));
  }

  /** Waits for the picture. */
  finish() {
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
    this.gl.readPixels(0, 0, 1, 1, this.gl.RGBA, this.gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  show(add) {
    this.renderer.shade(this.look(), add);
    this.present();
  }

  present() {
    this.renderer.present(1.1 * this.canvas.width / this.canvas.clientWidth);
    this.shown = performance.now();
  }

  /** At rest: samples beside the pixels' centres, a round or some tiles a frame. */
  *refine() {
    for (let k = 0; k <= this.samples; ++k) {
      const shift = k ? [((k - 1) % 2 + 0.5) / 2 - 0.5, ((k - 1 >> 1) + 0.5) / 2 - 0.5] : [0, 0];
      this.renderer.begin(this.camera, ...this.size(this.finest), shift, this.page.lod);
      yield* this.software ? this.sampleTiles(k > 0) : this.sample(k > 0);
      ++this.sampled;
    }
  }

  /** All rays of a frame to their end; added to the samples before, or in their place. */
  *sample(add) {
    for (let left = true; left;) {
      this.renderer.drawRound();
      if (!add) this.show(false);
      do yield; while ((left = this.renderer.raysLeft()) === undefined);
    }
    this.show(add);
  }

  /** The same by the processor: tiles take the place of a draft, and are shown now and then. Shade in hollows wants the
   * whole frame. */
  *sampleTiles(add) {
    const {renderer} = this, look = this.look(), tiles = renderer.tiles();
    if (!add) {
      renderer.draft();
      this.show(false);
      this.finish();
      yield;
    }
    for (const tile of tiles.filter(t => t.list.length)) {
      yield;
      renderer.cut(tile);
      renderer.drawTile(tile, look);
      if (this.isSplats) this.finish();
      if (add) continue;
      renderer.shade(look, false);
      if (performance.now() - this.shown < SHOWN) continue;
      this.present();
      this.finish();
    }
    const [width, height] = this.size(this.finest);
    for (let row = 0; row < height; row += STRIP) {
      yield;
      renderer.cut({box: [0, row, width, STRIP]});
      renderer.shade(look, add);
      this.finish();
    }
    renderer.cut(null);
    this.present();
  }

  /** What the ray through a place of the canvas meets, in CSS pixels. */
  pick(x, y) {
    const {clientWidth: w, clientHeight: h} = this.canvas;
    return (this.isSplats ? castSplats : cast)(this.surface, this.rules, ...this.camera.ray(x, y, w, h));
  }

  /** The point about which to turn where nothing is under the pointer: the object's middle, at its depth. */
  middle() {
    return along(this.camera.position, Math.max(1e-6, this.camera.depth(this.rules.clip ? centerOf(this.rules.clip) : this.surface.bounds.center)), this.camera.axes()[2]);
  }

  local(place) { return scaled(minus(place, this.surface.origin), 1 / this.surface.scale); }

  world(point) { return point.map((x, k) => this.surface.origin[k] + this.surface.scale * x); }

  distance(a, b) { return this.surface.scale * length(minus(a, b)); }

  /** One complete frame of a size, as columns; for tests and for whoever wants the numbers. */
  async measure(width, height, shift = [0, 0], lod = this.page.lod, exact = true) {
    this.renderer.exact = exact;
    this.renderer.begin(this.camera, width, height, shift, lod);
    for (let left = true; left;) {
      this.renderer.drawRound();
      do await new Promise(done => setTimeout(done)); while ((left = this.renderer.raysLeft()) === undefined);
    }
    return {...this.renderer.read(), unit: this.renderer.unit};
  }
}
