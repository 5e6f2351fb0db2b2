// SPDX-License-Identifier: BSD-3-Clause
// The page: its controls, its keys, and what is read at a point.
import {decode, decodeLines, inflate} from './surface.js';
import {decodeSplats} from './splats.js';
import {obstacle} from './frames.js';
import {Viewer} from './viewer.js';
import {Clip} from './clip.js';
import {Corner} from './corner.js';
import {LABELS, modesOf, showLegend} from './legend.js';
import {Link} from './link.js';
import {Measures} from './measure.js';
import {Numbers} from './numbers.js';
import {Pointers} from './pointers.js';
import {look} from './views.js';

const $ = id => document.getElementById(id);
const VIEWS = {f: 'front', b: 'back', l: 'left', r: 'right', t: 'top', u: 'bottom'};
const PANELS = {help: 'keys', view: 'views', clip: 'box'};  // by the button that opens them

function fail(sentence) {
  $('message').textContent = sentence;
  $('message').hidden = false;
  document.body.classList.add('failed');
}

class Page {
  constructor(viewer, page) {
    Object.assign(this, {viewer, page, canvas: viewer.canvas, modes: modesOf(viewer), spread: 0});
    const {diagonal, scale} = viewer.surface;
    this.numbers = new Numbers(diagonal * scale, page.unit);
    this.measures = new Measures(viewer, this.numbers, $, () => this.drawMarks());
    this.clip = new Clip(viewer, this.numbers, $);
    this.corner = new Corner(viewer, $);
    this.pointers = new Pointers(viewer, (x, y) => this.read(x, y), point => this.center(point));
    for (const mode of this.modes) $('mode').add(new Option(LABELS[mode], mode));
    $('mode').value = viewer.mode;
    this.listen();
    viewer.onFrame = () => {
      this.drawMarks();
      this.corner.draw();
      $('message').hidden = true;
      document.body.classList.add('ready');
      // The still picture is better than a draft of the same view.
      if (!viewer.software || !$('still') || viewer.sampled || viewer.changes > this.opening) document.body.classList.add('drawn');
    };
    const dark = matchMedia('(prefers-color-scheme: dark)');
    const follow = () => { viewer.dark = dark.matches; viewer.recolor(); };
    dark.addEventListener('change', follow);
    viewer.dark = dark.matches;
    showLegend(viewer, $);
    this.showFacts();
    this.showProjection();
    this.fit();
    this.opening = viewer.changes;
    this.link = new Link(this);
    new ResizeObserver(() => this.fit()).observe(this.canvas);
  }

  /** Frames the object between what is above and below it, in the still picture, too. */
  fit() {
    const {clientWidth: width, clientHeight: height} = this.canvas, {aspect} = this.viewer.home;
    const taken = Math.max($('title').offsetHeight, document.querySelector('footer').offsetHeight) + 14;
    const share = document.body.classList.contains('bare') ? 1 : Math.max(0.5, 1 - 2 * taken / height);
    const tall = Math.min(share * height, width / aspect);
    if ($('still')) $('still').style.padding = `${(height - tall) / 2}px ${(width - aspect * tall) / 2}px`;
    for (const camera of [this.viewer.camera, this.viewer.home]) camera.share = share;
    this.viewer.fit();
  }

  showFacts() {
    const {count, degree} = this.viewer.surface;
    $('facts').textContent = `${count.toLocaleString('en')} ${this.viewer.isSplats ? 'coloured discs' : `polynomial patches of degree ${degree}`}` +
      (this.page.points ? `, ${this.page.points.toLocaleString('en')} points` : '') +
      (this.viewer.software ? '; no graphics card: coarse while it moves' : '');
  }

  listen() {
    const {canvas} = this, on = (target, name, act) => target.addEventListener(name, act);
    on(document, 'keydown', e => this.key(e));
    on(canvas, 'webglcontextlost', () => fail('The graphics card gave up: load the page again'));
    on($('mode'), 'change', () => this.setMode($('mode').value));
    on($('range'), 'input', () => this.setMode(this.viewer.mode, +$('range').value));
    on($('home'), 'click', () => this.reset());
    on($('parallel'), 'click', () => this.setParallel(!this.viewer.camera.height));
    on($('measure'), 'click', () => this.setMeasuring(!this.measuring));
    on($('save'), 'click', () => this.save());
    on($('link'), 'click', () => this.copyLink());
    on($('close'), 'click', () => this.setPanel(''));
    for (const name of Object.keys(PANELS)) on($(name), 'click', () => this.setPanel($(PANELS[name]).hidden ? name : ''));
    for (const name of Object.values(VIEWS)) on($(`from-${name}`), 'click', () => this.look(name));
  }

  /** Shows other colours. spread: power of two by which their range is widened */
  setMode(mode, spread = 0) {
    Object.assign(this.viewer, {mode, spread: 2 ** spread});
    this.spread = $('range').value = spread;
    $('mode').value = mode;
    showLegend(this.viewer, $);
    this.viewer.recolor();
  }

  key(e) {
    const {target} = e, isInput = target.matches?.('input, select, textarea');
    if (e.ctrlKey || e.altKey || e.metaKey || isInput && e.key !== 'Escape') return;
    if (target.matches?.('button') && (e.key === ' ' || e.key === 'Enter')) return;
    const {camera} = this.viewer, step = 0.09, {canvas} = this;
    const turn = (yaw, pitch) => this.move(() => camera.orbit(this.viewer.middle(), yaw, pitch));
    const zoom = factor => this.move(() => camera.zoom(this.viewer.middle(), factor));
    const click = id => $(id).click();
    const acts = {
      ArrowLeft: () => turn(step, 0), ArrowRight: () => turn(-step, 0), ArrowUp: () => turn(0, step), ArrowDown: () => turn(0, -step),
      '+': () => zoom(0.9), '=': () => zoom(0.9), '-': () => zoom(1 / 0.9),
      Home: () => this.reset(), o: () => click('parallel'), v: () => click('view'), k: () => click('clip'), '?': () => click('help'),
      m: () => click('measure'), Delete: () => this.measures.remove(), Backspace: () => this.measures.remove(),
      p: () => this.save(), s: () => this.copyLink(), c: () => this.modes.includes('color') && this.setMode('color'),
      Escape: () => this.forget(), ' ': () => this.read(canvas.clientWidth / 2, canvas.clientHeight / 2),
    };
    if (VIEWS[e.key]) this.look(VIEWS[e.key]);
    else if (acts[e.key]) acts[e.key]();
    else if (/^[0-9]$/.test(e.key)) this.setMode(this.modes[(+e.key + 9) % 10] || this.viewer.mode);
    else return;
    e.preventDefault();
  }

  move(act) {
    act();
    this.viewer.moved();
  }

  reset() {
    this.viewer.camera = this.viewer.home.copy();
    this.showProjection();
    this.viewer.moved();
  }

  look(side) {
    const {viewer, canvas} = this;
    this.move(() => look(viewer.camera, side, viewer.balls(), canvas.clientWidth, canvas.clientHeight));
  }

  setParallel(parallel) {
    const {viewer, canvas} = this, seen = viewer.pick(canvas.clientWidth / 2, canvas.clientHeight / 2);
    this.move(() => viewer.camera.setParallel(parallel, seen?.point || viewer.middle(), viewer.surface.bounds));
    this.showProjection();
  }

  showProjection() { $('parallel').setAttribute('aria-pressed', !!this.viewer.camera.height); }

  /** A second click brings its point to the middle; while measuring it is a point like others. */
  center(point) {
    if (!this.measuring) this.move(() => this.viewer.camera.center(point));
    return !this.measuring;
  }

  setMeasuring(on) {
    this.measuring = on;
    $('measure').setAttribute('aria-pressed', on);
    this.forget();
    if (on) this.say('Choose two points');
  }

  /** Opens one panel, by its button, or none. */
  setPanel(name) {
    for (const [button, panel] of Object.entries(PANELS)) {
      $(panel).hidden = button !== name;
      $(button).setAttribute('aria-expanded', button === name);
    }
    document.body.dataset.panel = name;
    this.drawMarks();
  }

  forget() {
    this.mark = this.measures.start = null;
    $('readout').hidden = true;
    this.setPanel('');
  }

  say(words) {
    $('readout').replaceChildren(words);
    $('readout').hidden = false;
  }

  /** What is at a point, or how far two are apart. */
  read(x, y) {
    const hit = this.viewer.pick(x, y);
    if (!hit) return this.measuring ? this.say('There is nothing; choose a point of the surface') : this.forget();
    if (this.measuring) {
      const pair = this.measures.add(hit.point);
      this.say(pair ? `Distance ${this.measures.label(pair)}` : 'Choose the second point');
    } else {
      this.mark = hit.point;
      this.sayPoint(hit);
    }
    this.drawMarks();
  }

  sayPoint({point, depth, normal, kMax, kMin, leaf, color}) {
    const {surface: s} = this.viewer, {scale} = s, {numbers} = this, table = document.createElement('table');
    const place = {
      Position: numbers.lengths(...this.viewer.world(point)), Normal: normal.map(x => numbers.fixed(x, 4)).join('  '),
      Distance: numbers.lengths(depth * scale),
    };
    const rows = this.viewer.isSplats ? {
      ...place, Radius: numbers.lengths(s.radius[leaf]), Colour: s.rgb.map(c => c[leaf]).join('  '),
    } : {
      ...place,
      'Principal curvatures': numbers.curvatures('mean', kMax / scale, kMin / scale),
      'Mean curvature': numbers.curvatures('mean', (kMax + kMin) / 2 / scale),
      'Gaussian curvature': numbers.curvatures('gauss', kMax * kMin / scale ** 2),
      'Ball, residual': numbers.lengths(s.radius[leaf] * scale, s.error[leaf] * scale), Level: s.level[leaf],
      ...color && {Colour: color.map(Math.round).join('  ')},
    };
    for (const [name, words] of Object.entries(rows)) {
      const row = table.insertRow();
      row.appendChild(Object.assign(document.createElement('th'), {textContent: name, scope: 'row'}));
      row.insertCell().textContent = words;
    }
    this.say(table);
  }

  /** Marks, distances and the clipping box over the picture. */
  drawMarks() {
    const {clientWidth: w, clientHeight: h} = this.canvas, {camera} = this.viewer;
    const place = point => camera.project(point, w, h)?.map(x => +x.toFixed(2));
    const points = [...this.measures.points(), ...this.mark ? [this.mark] : []].map(place).filter(Boolean);
    const marks = this.clip.draw(place) + this.measures.draw(place) + points.map(([x, y]) => `<circle cx="${x}" cy="${y}" r="5"/>`).join('');
    if (marks !== this.marks) $('marks').innerHTML = this.marks = marks;
    this.link?.follow();
  }

  async copyLink() {
    const refused = await this.link.copy();
    this.say(refused || 'The link to this view is copied');
  }

  /** Saves the picture as it is on the screen. */
  save() {
    this.viewer.present();
    this.canvas.toBlob(blob => {
      const link = Object.assign(document.createElement('a'),
        {href: URL.createObjectURL(blob), download: `${document.title || 'surface'}.png`});
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    });
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
