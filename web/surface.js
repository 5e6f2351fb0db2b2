// SPDX-License-Identifier: BSD-3-Clause
// A surface as modules/web packs it: its columns, and the texels that shaders read.
import {centerOf} from './box.js';
import {readTextures} from './textures.js';
import {length, minus} from './vectors.js';

const CENTER_MASK = 0xffff, NORMAL_GRID = 2047, ESCAPE = 255, LOG_STEPS = [0, 254, 4094], LARGE_BALL = 0.02, COLOR_STEP = 2;
const RIM = 0.05, SLACK = 0.5;  // of bulkOf()
export const COLOR_TERMS = 18;

/** Undoes base64 and gzip; throws for what was cut or changed. */
export async function inflate(text, length) {
  const packed = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  if (packed.length !== length) throw new Error('cut');
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Reads columns, each byte of all numbers in a plane of its own. */
export class Planes {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }
  get(count, size) {
    if (this.at + count * size > this.bytes.length) throw new Error('cut');
    const column = new Uint32Array(count);
    for (let p = 0; p < size; ++p) {
      for (let i = 0; i < count; ++i) column[i] |= this.bytes[this.at++] << 8 * p;
    }
    return column;
  }
  raw(count) {
    if (this.at + count > this.bytes.length) throw new Error('cut');
    return this.bytes.subarray(this.at, this.at += count);
  }
  number() { return this.get(1, 4)[0]; }
  double() { return new Float64Array(Uint32Array.of(this.number(), this.number()).buffer)[0]; }
  doubles(count) { return Array.from({length: count}, () => this.double()); }
  floats(count) { return Float64Array.from(new Float32Array(this.get(count, 4).buffer)); }
  /** Logarithms of one byte or two; 0 stays 0. */
  logarithms(count, [low, ratio], size = 1) {
    return Float64Array.from(this.get(count, size), code => code && low * ratio ** ((code - 1) / LOG_STEPS[size]));
  }
  cells(count, corner, step) {
    let cell = 0;
    return Float64Array.from(this.get(count, 2), d => corner + (cell = cell + d & CENTER_MASK) * step);
  }
}

/** The unit normal of octahedral codes. */
export function octNormal(a, b) {
  let x = a / NORMAL_GRID - 1, y = b / NORMAL_GRID - 1;
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
  const l = Math.hypot(x, y, z);
  return [x / l, y / l, z / l];
}

function readHeader(planes) {
  if (planes.number() !== 0x32504c53) throw new Error('foreign');
  const s = {count: planes.number(), leaves: planes.number()};
  [s.degree, s.kernel, s.oriented, s.paper, s.colored] = planes.get(5, 1);  // colored 2: with textures
  s.origin = planes.doubles(3);
  [s.scale, s.diagonal, s.lambda, s.coverRadius, s.coverThreshold, s.precision] = planes.doubles(6);
  s.corner = planes.doubles(3);
  s.step = planes.double();
  s.logs = [planes.doubles(2), planes.doubles(2), planes.doubles(2)];
  s.stride = (s.degree + 1) * (s.degree + 2) / 2;
  return s;
}

function readCoefficients(s, planes) {
  s.c = new Float64Array(s.count * s.stride);
  const steps = (k, r) => (k ? 1 : 4) * s.precision * Math.max(1, r / s.diagonal / LARGE_BALL);
  for (let k = 0; k < s.stride; ++k) {
    const codes = s.precision ? planes.get(s.count, 1) : planes.floats(s.count);
    const large = s.precision ? planes.get(codes.filter(c => c === ESCAPE).length, 3) : [];
    let next = 0;
    for (let i = 0; i < s.count; ++i) {
      const code = codes[i] === ESCAPE && s.precision ? large[next++] : codes[i];
      s.c[i * s.stride + k] = !s.precision ? code : (code & 1 ? -(code + 1) / 2 : code / 2) / steps(k, s.radius[i]);
    }
  }
}

/** Trim maps, a byte a node, 1 inside. */
function readTrimMaps(s, planes) {
  s.side = planes.get(s.count, 1);
  s.map = Array.from(s.side, side => {
    const map = new Uint8Array(side * side), bytes = side + 7 >> 3;
    const rows = planes.get(bytes * side, 1);
    for (let k = 0; k < side * side; ++k) {
      const row = k / side | 0, column = k % side;
      const changed = rows[row * bytes + (column >> 3)] >> (column & 7) & 1;
      map[k] = changed ^ (row ? map[k - side] : 0);
    }
    return map;
  });
  s.trimmed = s.side.some(side => side > 0);
}

/** Six terms of red, green and blue each, over the surfel's plane; in 255ths of white. */
function readColors(s, planes) {
  const codes = Array.from({length: COLOR_TERMS}, () => planes.get(s.count, 1));
  s.colors = Float64Array.from({length: COLOR_TERMS * s.count}, (_, at) => {
    const i = at / COLOR_TERMS | 0, k = at % COLOR_TERMS;
    const code = codes[k][i] + (k % 3 === 1 ? 0 : codes[k - k % 3 + 1][i]);  // from green
    return k < 3 ? code & 255 : COLOR_STEP * (code << 24 >> 24);
  });
}

/** The columns of a surface, in double. */
export function decode(bytes) {
  const planes = new Planes(bytes), s = readHeader(planes), n = s.count, exact = !s.precision;
  if (n > bytes.length) throw new Error('cut');
  [s.x, s.y, s.z] = s.corner.map(corner => exact ? planes.floats(n) : planes.cells(n, corner, s.step));
  s.normal = new Float64Array(3 * n);
  const codes = exact ? [0, 0, 0].map(() => planes.floats(n)) : [planes.get(n, 2), planes.get(n, 2)];
  for (let i = 0; i < n; ++i) {
    s.normal.set(exact ? codes.map(c => c[i]) : octNormal(codes[0][i], codes[1][i]), 3 * i);
  }
  const logarithms = (k, size) => exact ? planes.floats(n) : planes.logarithms(n, s.logs[k], size);
  s.radius = logarithms(0, s.colored > 1 ? 2 : 1);
  s.error = logarithms(1, 2);
  s.level = planes.get(n, 1);
  planes.get(n, 1);  // degrees: unused coefficients are 0
  s.own = logarithms(2);
  s.parent = logarithms(2).map(size => size || 1e18);
  readCoefficients(s, planes);
  readTrimMaps(s, planes);
  if (s.colored) readColors(s, planes);
  if (s.colored > 1) readTextures(s, planes, COLOR_TERMS);
  if (planes.at !== bytes.length) throw new Error('foreign');
  s.weight = s.radius.map((r, i) => {
    const expected = Math.max(0, s.lambda) * s.diagonal ** 2 + 1e-6 * r * r;
    return s.paper ? 1 : expected / (expected + s.error[i] ** 2);
  });
  return s;
}

/** Polylines: [kind, x, y, z, x, y, z, ...] each. */
export function decodeLines(bytes) {
  const planes = new Planes(bytes), count = planes.number(), kinds = planes.get(count, 1), counts = planes.get(count, 4);
  const points = counts.reduce((sum, n) => sum + n, 0), step = planes.double();
  const axes = [0, 1, 2].map(() => planes.cells(points, planes.double(), step));
  let next = 0;
  return Array.from(counts, (n, k) => [kinds[k], ...Array(n).fill(0).flatMap(() => {
    const point = axes.map(axis => axis[next]);
    ++next;
    return point;
  })]);
}

/** Axes (u, v, w) of a surfel's frame: a fixed function of its normal. */
export function frameOf(s, i) {
  const [x, y, z] = s.normal.subarray(3 * i, 3 * i + 3), sign = z < 0 || Object.is(z, -0) ? -1 : 1;
  const a = -1 / (sign + z), b = x * y * a;
  return [[1 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y], [x, y, z]];
}

/** Bounds of a leaf's heights within a share of its ball, and of its slope all over the ball. */
function bounds(c, reach) {
  const [c0, c1, c2, c3 = 0, c4 = 0, c5 = 0] = c;
  const middle = (c3 + c5) / 2, spread = Math.hypot((c3 - c5) / 2, c4 / 2);
  const largest = [0, 0, 0, 0, 0, 0, 1, .385, .385, 1, 1, .325, .25, .325, 1];
  let higher = 0;
  for (let k = 6; k < c.length; ++k) higher += Math.abs(c[k]) * largest[k] * reach ** (k < 10 ? 3 : 4);
  const rest = Math.hypot(c1, c2) * reach + higher, square = reach * reach;
  const low = c0 - rest + Math.min(0, middle - spread) * square;
  const high = c0 + rest + Math.max(0, middle + spread) * square;
  return [Math.max(-reach, Math.min(reach, low)), Math.max(-reach, Math.min(reach, high))];
}

function steepest(c) {
  const [, c1, c2, c3 = 0, c4 = 0, c5 = 0] = c;
  let slope = Math.hypot(c1, c2) + 2 * (Math.abs(c3 + c5) / 2 + Math.hypot((c3 - c5) / 2, c4 / 2));
  for (let k = 6; k < c.length; ++k) slope += (k < 10 ? 3 : 4) * Math.abs(c[k]);
  return slope;
}

/** A word of a trim table: the nodes below, on and above a row in columns 8 q - 1 ... 8 q + 8, set outside. */
function trimWords(map, side) {
  const words = [], inMap = k => Math.min(side - 1, Math.max(0, k));
  for (let row = 0; row < side; ++row) {
    for (let first = -1; first < side - 1; first += 8) {
      let word = 0;
      for (let k = 0; k < 30; ++k) {
        word |= (1 - map[inMap(row + k % 3 - 1) * side + inMap(first + (k / 3 | 0))]) << k;
      }
      words.push(word);
    }
  }
  return words;
}

export const MOST_SIDE = 128, TRIM_UNIT = 4096, TEXTURE_UNIT = 65536;

/** A surface as the shaders of visualization/src/glsl read it, lengths in `unit`: texels of four numbers,
 * the last two those of a surfel's hull: four bounds of heights and a slope; and words of trim tables. textures: those drawn. */
export function texels(s, rules, unit, textures) {
  const colorAt = 4 + Math.ceil(s.stride / 4), hullAt = colorAt + (s.colored ? Math.ceil(COLOR_TERMS / 4) : 0);
  const perLeaf = hullAt + 2, data = new Float32Array(4 * perLeaf * s.count), words = [];
  const reach = Math.min(rules.kMaxShrink, Math.max(0.05, s.coverRadius)), inner = rules.kMaxShrink / reach;
  for (let i = 0; i < s.count; ++i) {
    const scale = i < s.leaves ? 1 : inner, r = s.radius[i] * scale, [u, , w] = frameOf(s, i);
    const c = Array.from(s.c.subarray(i * s.stride, (i + 1) * s.stride),
      (v, k) => v * scale ** (Math.ceil((Math.sqrt(8 * k + 9) - 3) / 2) - 1));
    const side = s.side[i], begin = words.length;
    if (side) words.push(...trimWords(s.map[i], side));
    const share = s.level[i] + Math.min(1023 / 1024, s.error[i] / s.radius[i]);
    data.set([s.x[i] / unit, s.y[i] / unit, s.z[i] / unit, r / unit, ...w, s.weight[i], ...u, share,
              Math.floor(begin / TRIM_UNIT), side ? begin % TRIM_UNIT * MOST_SIDE + side - 1 : -1,
              s.own[i] / unit, s.parent[i] / unit, ...c], 4 * perLeaf * i);
    if (s.colored) {
      const terms = s.colors.subarray(COLOR_TERMS * i, COLOR_TERMS * (i + 1));
      data.set(terms.map((v, k) => v * scale ** (k < 3 ? 0 : k < 9 ? 1 : 2)), 4 * (perLeaf * i + colorAt));
      if (textures) {
        const first = textures.begin[i], place = [Math.floor(first / TEXTURE_UNIT), first % TEXTURE_UNIT * 256 + textures.side[i]];
        data.set(place, 4 * (perLeaf * i + colorAt) + COLOR_TERMS);
      }
    }
    data.set([...bounds(c, reach), ...bounds(c, 1), steepest(c)], 4 * (perLeaf * i + hullAt));
  }
  return {perLeaf, colorAt, hullAt, data, words: Int32Array.from(words.length ? words : [0])};
}

/** The box around leaves' balls, all of them or those that count, and a ball around it. */
export function boundsOf(s, counts = () => true) {
  const low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
  for (let i = 0; i < s.leaves; ++i) {
    if (!counts(i)) continue;
    [s.x, s.y, s.z].forEach((column, k) => {
      low[k] = Math.min(low[k], column[i] - s.radius[i]);
      high[k] = Math.max(high[k], column[i] + s.radius[i]);
    });
  }
  if (!(low[0] <= high[0])) return {center: [0, 0, 0], radius: 1, box: [[-1, -1, -1], [1, 1, 1]]};
  return {box: [low, high], center: centerOf([low, high]), radius: 0.5 * length(minus(high, low))};
}

/** The box that a view of the whole shows: without strays, which are beyond half of the bulk's extent past the 5th and
 * 95th percentile of the area. O(n log n). */
export function bulkOf(s) {
  const area = i => s.radius[i] ** 2, rim = RIM * s.radius.subarray(0, s.leaves).reduce((sum, r) => sum + r * r, 0);
  const ranges = [s.x, s.y, s.z].map(column => {
    const order = Array.from({length: s.leaves}, (_, i) => i).sort((i, j) => column[i] - column[j]);
    const inner = from => {
      let sum = 0;
      return column[from.find(i => (sum += area(i)) >= rim)];
    };
    const low = inner(order), high = inner(order.reverse()), slack = SLACK * (high - low) + 1e-3;
    return [low - slack, high + slack];
  });
  return boundsOf(s, i => [s.x, s.y, s.z].every((column, k) => column[i] >= ranges[k][0] && column[i] <= ranges[k][1])).box;
}
