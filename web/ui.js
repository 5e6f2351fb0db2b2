// SPDX-License-Identifier: BSD-3-Clause
// The page: what pointers, keys and buttons do, and what is read at a point.
import {decode, decodeLines, inflate} from './surface.js';
import {decodeSplats} from './splats.js';
import {obstacle} from './frames.js';
import {Viewer} from './viewer.js';

const $ = id => document.getElementById(id);
const LABELS = {shaded: 'Shaded', normal: 'Normals', mean: 'Mean curvature', gauss: 'Gaussian curvature',
  kmax: 'Largest curvature', kmin: 'Smallest curvature', level: 'Level', size: 'Size of balls', error: 'Residual',
  reflection: 'Reflection lines', color: 'Colours'};
const SPLAT_MODES = ['color', 'shaded', 'normal', 'size', 'reflection'];

const text = x => x === 0 || Math.abs(x) >= 1e-3 && Math.abs(x) < 1e7 ? String(+x.toPrecision(Math.abs(x) < 1e4 ? 5 : 8)) : x.toExponential(3);

function fail(sentence) {
  $('message').textContent = sentence;
  $('message').hidden = false;
  document.body.classList.add('failed');
}

function unitOf(mode, unit) {
  const length = unit || 'length';
  return mode === 'gauss' ? `1/${length}²` : mode === 'level' ? '' : ['size', 'error'].includes(mode) ? length : `1/${length}`;
}

class Page {
  constructor(viewer, page) {
    Object.assign(this, {viewer, page, canvas: viewer.canvas, pointers: new Map(), marks: []});
    this.fillModes();
    this.listen();
    viewer.onFrame = () => {
      this.drawMarks();
      $('message').hidden = true;
      document.body.classList.add('ready');
    };
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const follow = () => { viewer.dark = dark.matches; viewer.recolor(); };
    dark.addEventListener('change', follow);
    viewer.dark = dark.matches;
    this.showScale();
    this.showFacts();
    new ResizeObserver(() => this.fit()).observe(this.canvas);
    this.fit();
  }

  /** Frames the object between what is above and below it. */
  fit() {
    const taken = Math.max($('title').offsetHeight, document.querySelector('footer').offsetHeight) + 14;
    const share = Math.max(0.5, 1 - 2 * taken / this.canvas.clientHeight);
    for (const camera of [this.viewer.camera, this.viewer.home]) camera.share = document.body.classList.contains('bare') ? 1 : share;
    this.viewer.fit();
  }

  fillModes() {
    this.modes = Object.keys(LABELS).filter(mode => this.viewer.isSplats ? SPLAT_MODES.includes(mode) : mode !== 'color' || this.viewer.surface.colored);
    for (const mode of this.modes) $('mode').add(new Option(LABELS[mode], mode));
    $('mode').value = this.viewer.mode;
  }

  showFacts() {
    const {count, degree} = this.viewer.surface;
    $('facts').textContent = `${count.toLocaleString('en')} ${this.viewer.isSplats ? 'coloured discs' : `polynomial patches of degree ${degree}`}` +
      (this.page.points ? `, ${this.page.points.toLocaleString('en')} points` : '') +
      (this.viewer.software ? '; no graphics card: coarse and slow' : '');
  }

  listen() {
    const {canvas, viewer} = this, on = (target, name, act) => target.addEventListener(name, act, {passive: false});
    on(canvas, 'pointerdown', e => this.press(e));
    on(canvas, 'pointermove', e => this.drag(e));
    for (const name of ['pointerup', 'pointercancel']) on(canvas, name, e => this.release(e));
    on(canvas, 'contextmenu', e => e.preventDefault());
    on(canvas, 'wheel', e => this.wheel(e));
    on(canvas, 'keydown', e => this.key(e));
    on(canvas, 'webglcontextlost', () => fail('The graphics card gave up: load the page again'));
    on($('mode'), 'change', () => this.setMode($('mode').value));
    on($('range'), 'input', () => { viewer.spread = 2 ** $('range').value; this.showScale(); viewer.recolor(); });
    on($('home'), 'click', () => this.reset());
    on($('measure'), 'click', () => this.setMeasuring(!this.measuring));
    on($('save'), 'click', () => this.save());
    on($('help'), 'click', () => this.setHelp($('keys').hidden));
    on($('close'), 'click', () => this.setHelp(false));
  }

  setMode(mode) {
    this.viewer.mode = $('mode').value = mode;
    this.viewer.spread = 2 ** ($('range').value = 0);
    this.showScale();
    this.viewer.recolor();
  }

  /** The colour bar and its numbers. */
  showScale() {
    const {viewer} = this, {mode} = viewer, [low, high] = viewer.range(), css = c => `rgb(${c.map(x => 255 * x)})`;
    $('scale').hidden = !viewer.hasRange();
    $('range').hidden = mode === 'level';
    let stops = viewer.table().map(css);
    if (mode === 'level') {
      const count = Math.round(high - low), levels = Array.from({length: count}, (_, k) => Math.round(low + k + 0.5));
      stops = levels.flatMap((l, k) => [`${css(viewer.table()[l % 10])} ${100 * k / count}% ${100 * (k + 1) / count}%`]);
    }
    $('colors').style.background = `linear-gradient(90deg, ${stops})`;
    const middle = mode === 'size' ? Math.sqrt(low * high) : (low + high) / 2;
    const numbers = mode === 'level' ? [low + 0.5, '', high - 0.5] : [low, middle, high].map(x => +x.toPrecision(3));
    $('numbers').replaceChildren(...numbers.map(x => Object.assign(document.createElement('span'), {textContent: x})));
    $('unit').textContent = unitOf(mode, this.page.unit);
  }

  place(e) {
    const box = this.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }

  /** The point under a place, or the object's middle. */
  pivotAt(x, y) { return this.viewer.pick(x, y)?.point || this.viewer.middle(); }

  press(e) {
    this.canvas.focus({preventScroll: true, focusVisible: false});
    this.canvas.setPointerCapture(e.pointerId);
    this.pointers.set(e.pointerId, this.place(e));
    this.start = {at: this.place(e), moved: false, pan: e.button > 0 || e.shiftKey};
    this.pivot = this.pivotAt(...this.middleOfPointers());
  }

  middleOfPointers() {
    const all = [...this.pointers.values()];
    return [0, 1].map(k => all.reduce((sum, p) => sum + p[k], 0) / all.length);
  }

  drag(e) {
    if (!this.pointers.has(e.pointerId)) return;
    const before = this.middleOfPointers(), gap = this.gap();
    this.pointers.set(e.pointerId, this.place(e));
    const after = this.middleOfPointers(), [dx, dy] = [after[0] - before[0], after[1] - before[1]];
    if (Math.hypot(after[0] - this.start.at[0], after[1] - this.start.at[1]) > 4) this.start.moved = true;
    if (!this.start.moved && this.pointers.size < 2) return;
    const {camera} = this.viewer, {clientWidth: width, clientHeight: height} = this.canvas;
    if (this.pointers.size > 1) {
      this.start.moved = true;
      camera.pan(this.pivot, dx, dy, width, height);
      if (gap > 0 && this.gap() > 0) camera.zoom(this.pivot, gap / this.gap());
    } else if (this.start.pan) {
      camera.pan(this.pivot, dx, dy, width, height);
    } else {
      camera.orbit(this.pivot, -dx * Math.PI / height, -dy * Math.PI / height);
    }
    this.viewer.moved();
  }

  /** Distance between two fingers. */
  gap() {
    const [a, b] = this.pointers.values();
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  }

  release(e) {
    if (!this.pointers.delete(e.pointerId)) return;
    if (e.type === 'pointerup' && !this.start.moved && !this.pointers.size) this.tap(...this.place(e), e.timeStamp);
    if (this.pointers.size) this.pivot = this.pivotAt(...this.middleOfPointers());
  }

  /** One tap reads a point, a second one at its place brings it to the middle: fingers have no double click. */
  tap(x, y, time) {
    const {tapped} = this, again = tapped && time - tapped.time < 400 && Math.hypot(x - tapped.x, y - tapped.y) < 12;
    this.tapped = again ? null : {x, y, time};
    const hit = again && !this.measuring && this.viewer.pick(x, y);
    if (!hit) return this.read(x, y);
    this.viewer.camera.center(hit.point);
    this.viewer.moved();
  }

  wheel(e) {
    e.preventDefault();
    // One pick for one turn of the wheel: the point stays under the pointer.
    if (!(e.timeStamp - this.wheeled < 400)) this.wheelPivot = this.pivotAt(...this.place(e));
    this.wheeled = e.timeStamp;
    const lines = e.deltaMode ? 20 * e.deltaY : e.deltaY;
    this.viewer.camera.zoom(this.wheelPivot, Math.exp(0.0015 * Math.max(-300, Math.min(300, lines))));
    this.viewer.moved();
  }

  key(e) {
    if (e.ctrlKey || e.altKey || e.metaKey) return;
    const {camera} = this.viewer, middle = this.viewer.middle(), step = 0.09;
    const moves = {
      ArrowLeft: () => camera.orbit(middle, step, 0), ArrowRight: () => camera.orbit(middle, -step, 0),
      ArrowUp: () => camera.orbit(middle, 0, step), ArrowDown: () => camera.orbit(middle, 0, -step),
      '+': () => camera.zoom(middle, 0.9), '=': () => camera.zoom(middle, 0.9), '-': () => camera.zoom(middle, 1 / 0.9),
    };
    const acts = {
      Home: () => this.reset(), r: () => this.reset(), m: () => this.setMeasuring(!this.measuring),
      p: () => this.save(), c: () => this.modes.includes('color') && this.setMode('color'), '?': () => this.setHelp($('keys').hidden), Escape: () => this.forget(),
      ' ': () => this.read(this.canvas.clientWidth / 2, this.canvas.clientHeight / 2),
    };
    if (moves[e.key]) {
      moves[e.key]();
      this.viewer.moved();
    } else if (acts[e.key]) {
      acts[e.key]();
    } else if (/^[0-9]$/.test(e.key)) {
      this.setMode(this.modes[(+e.key + 9) % 10] || this.viewer.mode);
    } else {
      return;
    }
    e.preventDefault();
  }

  reset() {
    this.viewer.camera = this.viewer.home.copy();
    this.viewer.moved();
  }

  setMeasuring(on) {
    this.measuring = on;
    $('measure').setAttribute('aria-pressed', on);
    this.forget();
    if (on) this.say('Choose two points');
  }

  setHelp(open) {
    $('keys').hidden = !open;
    $('help').setAttribute('aria-expanded', open);
  }

  forget() {
    this.marks = [];
    this.setHelp(false);
    $('readout').hidden = true;
    this.drawMarks();
  }

  say(words) {
    $('readout').replaceChildren(words);
    $('readout').hidden = false;
  }

  /** What is at a point, or how far two are apart. */
  read(x, y) {
    const hit = this.viewer.pick(x, y);
    if (!hit) return this.measuring ? this.say('There is nothing; choose a point of the surface') : this.forget();
    this.marks = this.measuring && this.marks.length === 1 ? [this.marks[0], hit.point] : [hit.point];
    if (this.measuring) this.sayDistance(); else this.sayPoint(hit);
    this.drawMarks();
  }

  sayDistance() {
    const [a, b] = this.marks, unit = this.page.unit || '';
    this.say(b ? `Distance ${text(this.viewer.distance(a, b))} ${unit}` : 'Choose the second point');
  }

  sayPoint({point, depth, normal, kMax, kMin, leaf, color}) {
    const {surface: s} = this.viewer, {scale} = s, table = document.createElement('table');
    const list = v => v.map(text).join('  ');
    const place = {
      Position: list(this.viewer.world(point)), Normal: list(normal.map(x => +x.toFixed(4))), Distance: text(depth * scale),
    };
    const rows = this.viewer.isSplats ? {
      ...place, Radius: text(s.radius[leaf]), Colour: list(s.rgb.map(c => c[leaf])),
    } : {
      ...place,
      'Principal curvatures': list([kMax / scale, kMin / scale]),
      'Mean, Gaussian': list([(kMax + kMin) / 2 / scale, kMax * kMin / scale ** 2]),
      'Ball, residual': list([s.radius[leaf] * scale, s.error[leaf] * scale]), Level: s.level[leaf],
      ...color && {Colour: list(color.map(Math.round))},
    };
    for (const [name, words] of Object.entries(rows)) {
      const row = table.insertRow();
      row.appendChild(Object.assign(document.createElement('th'), {textContent: name, scope: 'row'}));
      row.insertCell().textContent = words;
    }
    this.say(table);
  }

  drawMarks() {
    const {clientWidth: w, clientHeight: h} = this.canvas, {camera} = this.viewer;
    const at = this.marks.map(p => camera.project(p, w, h)).filter(Boolean);
    const line = at.length > 1 ? `<line x1="${at[0][0]}" y1="${at[0][1]}" x2="${at[1][0]}" y2="${at[1][1]}"/>`.repeat(2) : '';
    $('marks').innerHTML = line + at.map(([x, y]) => `<circle cx="${x}" cy="${y}" r="5"/>`).join('');
  }

  /** Saves the picture as it is on the screen. */
  save() {
    this.viewer.show(false);
    this.canvas.toBlob(blob => {
      const link = Object.assign(document.createElement('a'),
        {href: URL.createObjectURL(blob), download: `${document.title || 'surface'}.png`});
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
    this.viewer.recolor();
  }
}

async function open() {
  const canvas = $('canvas');
  let page, surface;
  try {
    page = JSON.parse($('options').textContent);
    page.lines = decodeLines(await inflate($('lines').textContent, page.lineBytes));
    surface = (page.kind === 'splats' ? decodeSplats : decode)(await inflate($('data').textContent, page.bytes));
  } catch (defect) {
    return fail('This page is damaged or was cut off: save it again');
  }
  const gl = canvas.getContext('webgl2', {antialias: false, alpha: false, powerPreference: 'high-performance'});
  const missing = obstacle(gl);
  if (missing) return fail(`${missing}: the picture does not turn; try another browser`);
  try {
    const viewer = window.slim = new Viewer(gl, surface, page);
    if (location.hash === '#still') document.body.classList.add('bare');
    viewer.ui = new Page(viewer, page);
  } catch (defect) {
    console.error(defect);
    fail(`This device does not draw the surface (${String(defect.message).split('\n')[0]}); try another browser`);
  }
}

open();
