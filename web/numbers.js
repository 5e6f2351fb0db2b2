// SPDX-License-Identifier: BSD-3-Clause
// Numbers as they are shown: lengths with digits by the object's diagonal, round steps, units.

const MOST_DECIMALS = 20, MANTISSAS = [1, 2, 5];

/** The unit of a mode's values, or of curvatures and areas by a power of the length's. */
export function unitOf(mode, unit) {
  if (mode === 'gauss') return `1/${unit}²`;
  return mode === 'level' ? '' : ['size', 'error'].includes(mode) ? unit : `1/${unit}`;
}

/** Texts of coordinates, lengths and curvatures of an object. */
export class Numbers {
  /** diagonal: the object's, in world units; unit: a length's, may be empty */
  constructor(diagonal, unit) {
    this.decimals = Math.min(MOST_DECIMALS, Math.max(0, Math.ceil(5 - Math.log10(diagonal || 1))));
    this.unit = unit;
  }

  fixed(x, decimals = this.decimals) { return (+x.toFixed(decimals) || 0).toFixed(decimals); }

  lengths(...values) { return this.named(values.map(x => this.fixed(x)), this.unit); }

  /** Four significant digits; mode: that of their unit */
  curvatures(mode, ...values) { return this.named(values.map(significant), this.unit && unitOf(mode, this.unit)); }

  named(words, unit) { return words.join('  ') + (unit && ` ${unit}`); }
}

function significant(x) {
  const isPlain = x === 0 || Math.abs(x) >= 0.001 && Math.abs(x) < 1e4;
  return (isPlain ? x.toPrecision(4) : x.toExponential(3)).replace('e+', 'e');
}

/** A number in few characters. */
export function short(x, isSmall = Math.abs(x) < 0.001) {
  return x !== 0 && (isSmall || Math.abs(x) >= 1e5) ? x.toExponential().replace('e+', 'e') : String(x);
}

/** The k-th of ... 0.5, 1, 2, 5, 10, 20 ...: 0 is 1. */
const roundStep = k => Number(`${MANTISSAS[(k % 3 + 3) % 3]}e${Math.floor(k / 3)}`);

/** The number of the largest round step that is not above x. */
function roundBelow(x) {
  let k = 3 * Math.floor(Math.log10(x)) - 1;
  while (roundStep(k + 1) <= x * (1 + 1e-9)) ++k;
  return k;
}

/** The largest of 1, 2, 5 times a power of ten that is not above x. */
export const roundLength = x => roundStep(roundBelow(x));

function multiples(step, low, high) {
  const slack = 1e-9 * (high - low), first = Math.ceil((low - slack) / step), last = Math.floor((high + slack) / step);
  return Array.from({length: Math.max(0, last - first + 1)}, (_, i) => +((first + i) * step).toPrecision(12));
}

/** Three to six round numbers of a range; logarithmic: round by their ratios, if it is wide enough. */
export function ticks(low, high, logarithmic = false) {
  if (!(high > low)) return [low];
  if (logarithmic) {
    const first = roundBelow(low * (1 - 1e-9)) + 1, all = Math.max(0, roundBelow(high) - first + 1);
    const every = all > 12 ? 3 * Math.ceil(all / 18) : Math.ceil(all / 6);  // powers of ten, if there are many
    const found = Array.from({length: all}, (_, i) => first + i).filter(k => k % every === 0).map(roundStep);
    if (found.length > 2) return found;
  }
  const most = logarithmic ? 4 : 6, of = step => multiples(step, low, high);  // by ratios, the upper ones are narrow
  let k = roundBelow((high - low) / most) - 1;
  while (of(roundStep(k)).length > most) ++k;
  return [roundStep(k), 2 * roundStep(k - 1), roundStep(k - 1)].map(of).find(found => found.length > 2);
}
