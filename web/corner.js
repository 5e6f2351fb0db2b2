// SPDX-License-Identifier: BSD-3-Clause
// The scale bar and the axes in a corner of the picture.
import {roundLength, short} from './numbers.js';

const MOST_PIXELS_OF_BAR = 130, ARM = 24;

/** The bar's length in world units at a point's depth, and in pixels. */
export function scaleBar(viewer, point) {
  const {camera, canvas} = viewer, depth = camera.height ? 1 : Math.max(1e-9, camera.depth(point));
  const pixel = viewer.surface.scale * depth * camera.pixel(canvas.clientWidth, canvas.clientHeight);
  const length = roundLength(MOST_PIXELS_OF_BAR * pixel);
  return {length, pixels: length / pixel};
}

/** The world's axes as seen: [name, right, down, away] each, those farther away first. */
export function axesSeen(camera) {
  const [right, up, forward] = camera.axes();
  return ['x', 'y', 'z'].map((name, k) => [name, right[k], -up[k], forward[k]]).sort((a, b) => b[3] - a[3]);
}

export class Corner {
  constructor(viewer, $) { Object.assign(this, {viewer, $}); }

  /** At rest the bar is that of the point in the picture's middle; until then, of the one before. */
  draw() {
    const {viewer, $} = this, {canvas, camera} = viewer;
    if (viewer.resting && this.looked !== viewer.lastMove) {
      this.looked = viewer.lastMove;
      this.point = viewer.pick(canvas.clientWidth / 2, canvas.clientHeight / 2)?.point;
    }
    const {length, pixels} = scaleBar(viewer, this.point || viewer.middle()), unit = viewer.page.unit;
    const arms = axesSeen(camera).map(([name, x, y]) => `<path class="${name}" d="M0 0L${ARM * x} ${ARM * y}"/>` +
      `<text class="${name}" x="${1.35 * ARM * x}" y="${1.35 * ARM * y}">${name}</text>`).join('');
    if (this.seen === pixels + arms) return;
    this.seen = pixels + arms;
    $('bar').style.width = `${pixels}px`;
    $('bar').textContent = short(length) + (unit && ` ${unit}`);
    $('axes').innerHTML = arms;
  }
}
