// SPDX-License-Identifier: BSD-3-Clause
// What the colours show: the names of modes, the colour bar and its numbers.
import {short, ticks, unitOf} from './numbers.js';

export const LABELS = {shaded: 'Shaded', normal: 'Normals', mean: 'Mean curvature', gauss: 'Gaussian curvature',
  kmax: 'Largest curvature', kmin: 'Smallest curvature', level: 'Level', size: 'Radius of balls', error: 'Residual',
  reflection: 'Reflection lines', color: 'Colours'};
const SPLAT_MODES = ['color', 'shaded', 'normal', 'size', 'reflection'];

/** The modes that a model can be shown in. */
export function modesOf(viewer) {
  return Object.keys(LABELS).filter(mode => viewer.isSplats ? SPLAT_MODES.includes(mode) : mode !== 'color' || viewer.surface.colored);
}

/** Round numbers of a range and where they are along its bar, 0 ... 1; of levels: their middles. */
export function ticksOf(mode, [low, high]) {
  if (mode === 'level') {
    const count = Math.round(high - low), every = Math.ceil(count / 6);
    return Array.from({length: Math.ceil(count / every)}, (_, k) => [Math.round(low + k * every + 0.5), (k * every + 0.5) / count]);
  }
  if (!(high > low)) return [[low, 0.5]];
  const at = mode === 'size' ? x => Math.log(x / low) / Math.log(high / low) : x => (x - low) / (high - low);
  return ticks(low, high, mode === 'size').map(x => [x, at(x)]);
}

/** Shows the colours of the viewer's mode and what they mean. */
export function showLegend(viewer, $) {
  const {mode} = viewer, range = viewer.range(), css = c => `rgb(${c.map(x => 255 * x)})`;
  const unit = unitOf(mode, viewer.page.unit || 'length'), found = ticksOf(mode, range);
  let stops = viewer.table().map(css);
  if (mode === 'level') {
    const count = Math.round(range[1] - range[0]), colorOf = k => css(viewer.table()[Math.round(range[0] + k + 0.5) % 10]);
    stops = Array.from({length: count}, (_, k) => `${colorOf(k)} ${100 * k / count}% ${100 * (k + 1) / count}%`);
  }
  $('scale').hidden = !viewer.hasRange();
  $('range').hidden = mode === 'level';
  $('caption').textContent = LABELS[mode] + (unit && ` (${unit})`);
  $('colors').style.background = `linear-gradient(90deg, ${stops})`;
  const largest = Math.max(...found.map(([x]) => Math.abs(x))), isSmall = largest < 0.01 && mode !== 'level';
  $('ticks').replaceChildren(...found.map(([x, at]) => {
    const tick = Object.assign(document.createElement('span'), {textContent: short(x, isSmall || mode === 'size' && x < 0.01)});
    tick.style.left = `${100 * at}%`;
    return tick;
  }));
}
