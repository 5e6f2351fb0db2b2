// SPDX-License-Identifier: BSD-3-Clause
// A surface as modules/web packs it: its columns, the texels that shaders read, and rays in double.

const CENTER_MASK = 0xffff, NORMAL_GRID = 2047, ESCAPE = 255, LOG_STEPS = [0, 254, 4094], LARGE_BALL = 0.02;

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
  if (planes.number() !== 0x31504c53) throw new Error('foreign');
  const s = {count: planes.number(), leaves: planes.number()};
  [s.degree, s.kernel, s.oriented, s.paper] = planes.get(4, 1);
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
  s.radius = logarithms(0);
  s.error = logarithms(1, 2);
  s.level = planes.get(n, 1);
  planes.get(n, 1);  // degrees: unused coefficients are 0
  s.own = logarithms(2);
  s.parent = logarithms(2).map(size => size || 1e18);
  readCoefficients(s, planes);
  readTrimMaps(s, planes);
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

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const along = (a, t, b) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
export const minus = (a, b) => along(a, -1, b);
export const scaled = (a, t) => [a[0] * t, a[1] * t, a[2] * t];
export const length = a => Math.hypot(a[0], a[1], a[2]);
export const unit = a => scaled(a, 1 / (length(a) || 1));
export const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

const value = (a, x) => a.reduceRight((sum, c) => sum * x + c, 0);
const derived = a => a.slice(1).map((c, k) => c * (k + 1));

/** Roots of a polynomial in an interval, ascending: one between neighbouring roots of its derivative. */
export function roots(a, low, high) {
  while (a.length > 1 && a[a.length - 1] === 0) a = a.slice(0, -1);
  if (a.length < 2) return [];
  const slope = derived(a), stops = [low, ...roots(slope, low, high), high], found = [];
  for (let k = 1; k < stops.length; ++k) {
    let l = stops[k - 1], h = stops[k];
    const rises = value(a, l) <= 0;
    if (rises === (value(a, h) <= 0)) continue;
    let x = (l + h) / 2;
    for (let i = 0; i < 100 && h - l > 1e-16 * (1 + Math.abs(x)); ++i) {
      const f = value(a, x);
      if (f === 0) break;
      if (f <= 0 === rises) l = x; else h = x;
      const next = x - f / value(slope, x);
      x = next > l && next < h && i % 4 < 3 ? next : (l + h) / 2;
      if (Math.abs(next - x) < 1e-16 && Math.abs(f) < 1e-16) break;
    }
    found.push(x);
  }
  return found;
}

/** f / r along a ray through a leaf: coefficients of s, in radii from where it is nearest. */
function alongRay(s, i, frame, point, direction) {
  const [u, v, w] = frame.map(axis => dot(point, axis)), [p, q, r] = frame.map(axis => dot(direction, axis));
  const a = [w, r, 0, 0, 0];
  const times = (f, x, y) => f.reduce((g, c, k) => (g[k] += c * x, g[k + 1] = c * y, g), [0]);
  for (let n = 0, k = i * s.stride; n <= s.degree; ++n) {
    for (let j = 0; j <= n; ++j, ++k) {
      let term = [s.c[k]];
      for (let m = 0; m < n; ++m) term = m < n - j ? times(term, u, p) : times(term, v, q);
      term.forEach((c, m) => a[m] -= c);
    }
  }
  return a;
}

/** First and second derivatives of a leaf's height polynomial: [hu, hv, huu, huv, hvv]. */
function heightJet(s, i, u, v) {
  const jet = [0, 0, 0, 0, 0];
  for (let n = 1, k = i * s.stride + 1; n <= s.degree; ++n) {
    for (let j = 0; j <= n; ++j, ++k) {
      const c = s.c[k], p = n - j;
      if (p) jet[0] += c * p * u ** (p - 1) * v ** j;
      if (j) jet[1] += c * j * u ** p * v ** (j - 1);
      if (p > 1) jet[2] += c * p * (p - 1) * u ** (p - 2) * v ** j;
      if (p && j) jet[3] += c * p * j * u ** (p - 1) * v ** (j - 1);
      if (j > 1) jet[4] += c * j * (j - 1) * u ** p * v ** (j - 2);
    }
  }
  return jet;
}

/** How far outside of its data a leaf is at (u, v): 0 inside, 1 outside, 1/2 on the border. */
function outsideShare(s, i, u, v) {
  const side = s.side[i];
  if (!side) return 0;
  const spline = coordinate => {
    const x = Math.min(1, Math.max(0, 0.5 * (coordinate + 1))) * (side - 1), node = x + 0.5 | 0, d = x - node;
    return [node, 0.5 * (0.5 - d) ** 2, 0.75 - d * d, 0.5 * (0.5 + d) ** 2];
  };
  const column = spline(u), row = spline(v), inMap = k => Math.min(side - 1, Math.max(0, k));
  let outside = 0;
  for (let j = 0; j < 3; ++j) {
    for (let k = 0; k < 3; ++k) {
      const inside = s.map[i][inMap(row[0] + j - 1) * side + inMap(column[0] + k - 1)];
      if (!inside) outside += row[j + 1] * column[k + 1];
    }
  }
  return outside;
}

function kernel(power, s2) {
  if (!(s2 < 1)) return 0;
  if (power < 16) return (1 - s2) ** power;
  return s2 < 0.25 ? Math.exp(-8 * s2) : 16 * Math.exp(-2) * (1 - Math.sqrt(s2)) ** 4;
}

/** A leaf on a ray: depth and place of the point nearest to its centre, or nothing for a miss. */
function approach(s, i, eye, direction, reach) {
  const dx = s.x[i] - eye[0], dy = s.y[i] - eye[1], dz = s.z[i] - eye[2], r = s.radius[i];
  const depth = dx * direction[0] + dy * direction[1] + dz * direction[2];
  const px = direction[0] * depth - dx, py = direction[1] * depth - dy, pz = direction[2] * depth - dz;
  const distance2 = (px * px + py * py + pz * pz) / (r * r), rest = reach * reach - distance2;
  if (!(rest > 0)) return null;
  return {depth, distance2, point: [px / r, py / r, pz / r], half: Math.sqrt(rest)};
}

/** Depth of the first root of any leaf on a ray, each in its shrunken ball, or infinity. */
function firstHit(s, rules, eye, direction, nearest) {
  const reach = Math.min(rules.kMaxShrink, Math.max(0.05, s.coverRadius));
  let first = Infinity;
  for (let i = 0; i < s.leaves; ++i) {
    const near = approach(s, i, eye, direction, reach), r = s.radius[i];
    if (!near || near.depth - near.half * r > first) continue;
    const frame = frameOf(s, i), a = alongRay(s, i, frame, near.point, direction), slope = derived(a);
    const low = Math.max(-near.half, (nearest - near.depth) / r);
    for (const root of roots(a, low, Math.min(near.half, (first - near.depth) / r))) {
      if (rules.front && !(value(slope, root) < 0)) continue;
      const q = along(near.point, root, direction);
      if (rules.trim && outsideShare(s, i, dot(q, frame[0]), dot(q, frame[1])) > 0.5) continue;
      first = near.depth + root * r;
      break;
    }
  }
  return first;
}

/** Adds one leaf to a blend at the depth of the first hit. */
function blendLeaf(s, rules, i, eye, direction, first, sum) {
  const near = approach(s, i, eye, direction, 1), r = s.radius[i];
  if (!near) return;
  const hat = (first - near.depth) / r, hat2 = near.distance2 + hat * hat;
  if (!(hat2 < 1)) return;
  const frame = frameOf(s, i), a = alongRay(s, i, frame, near.point, direction), slope = derived(a);
  if (!(Math.abs(value(a, hat)) < rules.kMaxShift)) return;
  const low = Math.max(-near.half, (rules.near - near.depth) / r);
  let root = Infinity;
  for (const x of roots(a, low, near.half)) {
    if (Math.abs(x - hat) < Math.abs(root - hat) && !(rules.front && value(slope, x) >= 0)) root = x;
  }
  const root2 = near.distance2 + root * root, weight = s.weight[i] * kernel(s.kernel, Math.max(hat2, root2));
  if (root === Infinity || !(weight > 0)) return;
  const q = along(near.point, root, direction), [u, v, w] = frame, qu = dot(q, u), qv = dot(q, v);
  const [hu, hv, huu, huv, hvv] = heightJet(s, i, qu, qv), side = value(slope, root) > 0 ? -1 : 1;
  sum.weight += weight;
  sum.shift += weight * (root - hat) * r;
  sum.coverage += kernel(s.kernel, root2 / s.coverRadius ** 2);
  if (rules.trim) sum.outside += weight * outsideShare(s, i, qu, qv);
  sum.lean = along(sum.lean, weight, q);
  sum.leaves += 1;
  sum.gradient = along(sum.gradient, side * weight, along(along(w, -hu, u), -hv, v));
  for (let k = 0; k < 3; ++k) {
    sum.hessian[k] = along(sum.hessian[k], -side * weight / r,
      [0, 1, 2].map(l => huu * u[k] * u[l] + huv * (u[k] * v[l] + v[k] * u[l]) + hvv * v[k] * v[l]));
  }
  if (weight > sum.largest) [sum.largest, sum.leaf] = [weight, i];
}

function isSupported(s, rules, sum) {
  if (sum.outside > 0.5 * sum.weight) return false;
  if (sum.coverage >= s.coverThreshold) return true;
  return sum.leaves >= rules.kMinLeaves && length(sum.lean) < rules.kMaxLean * sum.weight;
}

/** Principal curvatures of a level set by its gradient and Hessian. */
function principal(g, h) {
  const n2 = dot(g, g), hg = h.map(row => dot(row, g));
  const mean = 0.5 * (h[0][0] + h[1][1] + h[2][2] - dot(g, hg) / n2) / Math.sqrt(n2);
  const minors = dot(g, [cross(h[1], h[2]), cross(h[2], h[0]), cross(h[0], h[1])].map(row => dot(row, g)));
  const spread = Math.sqrt(Math.max(0, mean * mean - minors / (n2 * n2)));
  return [mean + spread, mean - spread];
}

/**
 * What a ray meets, in local units and in double: {depth, point, normal, kMax, kMin, leaf}, or null.
 * rules: the frame's constants, and front, trim, near. O(leaves).
 */
export function cast(s, rules, eye, direction) {
  let nearest = rules.near;
  for (let layer = 0; layer < rules.kMaxLayers; ++layer) {
    const first = firstHit(s, rules, eye, direction, nearest);
    if (first === Infinity) return null;
    const sum = {weight: 0, shift: 0, coverage: 0, outside: 0, leaves: 0, largest: 0, leaf: -1,
                 lean: [0, 0, 0], gradient: [0, 0, 0], hessian: [[0, 0, 0], [0, 0, 0], [0, 0, 0]]};
    for (let i = 0; i < s.leaves; ++i) blendLeaf(s, rules, i, eye, direction, first, sum);
    if (sum.leaf < 0) return null;
    if (isSupported(s, rules, sum)) {
      const depth = first + sum.shift / sum.weight;
      const [kMax, kMin] = principal(scaled(sum.gradient, 1 / sum.weight),
                                     sum.hessian.map(row => scaled(row, 1 / sum.weight)));
      return {depth, point: along(eye, depth, direction), normal: unit(sum.gradient), kMax, kMin, leaf: sum.leaf};
    }
    nearest = first + rules.kPeelStep * s.radius[sum.leaf];
  }
  return null;
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

export const MOST_SIDE = 128, TRIM_UNIT = 4096;

/** A surface as the shaders of visualization/src/opengl read it, lengths in `unit`: texels of four numbers,
 * words of trim tables, and four bounds of heights and a slope for each surfel's hull. */
export function texels(s, rules, unit) {
  const perLeaf = 4 + Math.ceil(s.stride / 4), data = new Float32Array(4 * perLeaf * s.count);
  const hulls = new Float32Array(5 * s.count), words = [];
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
    hulls.set([...bounds(c, reach), ...bounds(c, 1), steepest(c)], 5 * i);
  }
  return {perLeaf, data, hulls, words: Int32Array.from(words.length ? words : [0])};
}

/** A ball around all leaves. */
export function boundsOf(s) {
  const low = [Infinity, Infinity, Infinity], high = low.map(x => -x);
  [s.x, s.y, s.z].forEach((column, k) => {
    for (let i = 0; i < s.leaves; ++i) {
      low[k] = Math.min(low[k], column[i] - s.radius[i]);
      high[k] = Math.max(high[k], column[i] + s.radius[i]);
    }
  });
  if (!s.leaves) return {center: [0, 0, 0], radius: 1};
  return {center: scaled(along(low, 1, high), 0.5), radius: 0.5 * length(minus(high, low))};
}
