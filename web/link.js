// SPDX-License-Identifier: BSD-3-Clause
// The view in the page's address: camera, colours, clipping box and distances, in world coordinates.
import {cross, minus, unit} from './vectors.js';

const PAUSE = 300;  // milliseconds without a change before the address follows
const MOST = 100;   // distances of an address: labels are placed pair by pair

const numbersOf = (text, count) => {
  const all = (text || '').split(',').map(Number);
  return text && all.every(Number.isFinite) && (!count || all.length === count) ? all : null;
};

export class Link {
  /** page: whoever has viewer, clip, measures, numbers, setMode and setSpread */
  constructor(page) {
    this.page = page;
    this.seen = this.text();
    addEventListener('hashchange', () => this.restore());
    this.restore();
  }

  /** The view as a text behind '#'. */
  text() {
    const {viewer, clip, measures, numbers, spread} = this.page, {camera} = viewer, size = viewer.surface.scale;
    const place = p => viewer.world(p).map(x => numbers.fixed(x, numbers.decimals + 3)), exact = x => +x.toPrecision(9);
    const parts = {
      eye: place(camera.position), at: place(camera.target), up: camera.up.map(x => +x.toFixed(6)), fov: exact(camera.fov),
      height: exact(camera.height * size), aspect: exact(camera.aspect), mode: viewer.mode, range: spread,
      clip: clip.isOn() && clip.values, measure: measures.pairs.flat().flatMap(place),
    };
    return Object.entries(parts).filter(([, value]) => value && value.length !== 0).map(([name, value]) => `${name}=${value}`).join('&');
  }

  /** Takes up the view that the address names; one that is no view changes nothing. */
  restore() {
    const given = new URLSearchParams(location.hash.slice(1)), get = (name, count) => numbersOf(given.get(name), count);
    const {page} = this, {viewer} = page, eye = get('eye', 3), at = get('at', 3), up = get('up', 3), points = get('measure');
    if (!eye || !at || !up || !(Math.hypot(...cross(minus(at, eye), up)) > 0)) return;
    const [fov, height, aspect] = ['fov', 'height', 'aspect'].map(name => get(name, 1)?.[0]), {camera} = viewer;
    Object.assign(camera, {position: viewer.local(eye), target: viewer.local(at), up: unit(up), height: height > 0 ? height / viewer.surface.scale : 0});
    if (fov > 0 && fov < 180) camera.fov = fov;
    if (aspect > 0) camera.aspect = aspect;
    if (page.modes.includes(given.get('mode'))) page.setMode(given.get('mode'), Math.max(-4, Math.min(4, get('range', 1)?.[0] || 0)));
    const whole = (points || []).slice(0, Math.min(MOST, Math.floor((points || []).length / 6)) * 6);
    const ends = whole.flatMap((x, i) => i % 3 ? [] : [viewer.local(whole.slice(i, i + 3))]);
    page.measures.set(ends.flatMap((p, i) => i % 2 ? [[ends[i - 1], p]] : []));
    page.clip.restore(get('clip', 6));
    page.showProjection();
    viewer.moved();
  }

  /** Lets the address follow once the view rests. */
  follow() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), PAUSE);
  }

  write() {
    const text = this.text();
    if (text === this.seen || document.body.classList.contains('bare')) return;
    this.seen = text;
    try {
      history.replaceState(null, '', `#${text}`);
    } catch (refusal) { /* a frame without an address of its own */ }
  }

  /** Copies the address; where the browser forbids that, returns it to be shown. */
  async copy() {
    this.seen = '';
    this.write();
    try {
      await navigator.clipboard.writeText(location.href);
      return '';
    } catch (refusal) {
      return location.href;
    }
  }
}
