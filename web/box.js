// SPDX-License-Identifier: BSD-3-Clause
// Boxes along the axes: two corners [low, high].
import {along, minus, scaled} from './vectors.js';

/** The part of a ray, begin ... end, that is in a box: its two depths, or null. */
export function within([low, high], from, direction, begin = -Infinity, end = Infinity) {
  for (let k = 0; k < 3; ++k) {
    const a = low[k] - from[k], b = high[k] - from[k], d = direction[k];
    if (d === 0 && (a > 0 || b < 0)) return null;
    if (d === 0) continue;
    begin = Math.max(begin, Math.min(a / d, b / d));
    end = Math.min(end, Math.max(a / d, b / d));
  }
  return begin < end ? [begin, end] : null;
}

export const centerOf = ([low, high]) => scaled(along(low, 1, high), 0.5);

/** The eight corners relative to the centre; bit k of a corner's number: high along axis k. */
export function cornersOf([low, high]) {
  const half = scaled(minus(high, low), 0.5);
  return Array.from({length: 8}, (_, i) => half.map((h, k) => i >> k & 1 ? h : -h));
}

/** The twelve edges: pairs of corners. */
export function edgesOf(box) {
  const corners = cornersOf(box).map(c => along(centerOf(box), 1, c));
  return [1, 2, 4].flatMap(bit => corners.flatMap((c, i) => i & bit ? [] : [[c, corners[i | bit]]]));
}
