// SPDX-License-Identifier: BSD-3-Clause
// What a ray meets of a surface, in double: modules/render/src/tiles/leaf_on_ray.cpp, leaf by leaf.
import {within} from './box.js';
import {COLOR_TERMS, frameOf} from './surface.js';
import {textureColor, textureWeight} from './textures.js';
import {along, cross, dot, length, scaled, unit} from './vectors.js';

const value = (a, x) => a.reduceRight((sum, c) => sum * x + c, 0);
const derived = a => a.slice(1).map((c, k) => c * (k + 1));

/** Roots of a polynomial in an interval, ascending: one between neighbouring roots of its derivative. */
export function roots(a, low, high) {
  while (a.length > 1 && a[a.length - 1] === 0) a = a.slice(0, -1);
  if (a.length < 2 || low > high) return [];
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
export function outsideShare(s, i, u, v) {
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

export function kernel(power, s2) {
  if (!(s2 < 1)) return 0;
  const q = 1 - s2, fourth = q * q * q * q;
  if (power < 16) return power === 4 ? fourth : power === 7 ? fourth * q * q * q : q ** power;
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
  const atHat = value(a, hat), behind = value(a, hat + rules.kBehind);
  if (!(Math.abs(atHat) < rules.kMaxShift)) return;
  const low = Math.max(-near.half, (rules.near - near.depth) / r);
  let root = Infinity;
  for (const x of roots(a, low, near.half)) {
    if (Math.abs(x - hat) < Math.abs(root - hat) && !(rules.front && value(slope, x) >= 0)) root = x;
  }
  if (root === Infinity) {
    if (atHat > 0) sum.clearance += s.weight[i] * kernel(s.kernel, hat2) * r * behind;
    return;
  }
  const root2 = near.distance2 + root * root, weight = s.weight[i] * kernel(s.kernel, Math.max(hat2, root2));
  if (!(weight > 0)) return;
  const q = along(near.point, root, direction), [u, v, w] = frame, qu = dot(q, u), qv = dot(q, v);
  const [hu, hv, huu, huv, hvv] = heightJet(s, i, qu, qv), side = value(slope, root) > 0 ? -1 : 1;
  sum.weight += weight;
  sum.shift += weight * (root - hat) * r;
  sum.coverage += kernel(s.kernel, root2 / s.coverRadius ** 2);
  sum.clearance += weight * r * Math.min(side * behind, 0);
  if (rules.trim) sum.outside += weight * outsideShare(s, i, qu, qv);
  sum.offsets = along(sum.offsets, weight, q);
  sum.side += side;
  sum.leaves += 1;
  sum.gradient = along(sum.gradient, side * weight, along(along(w, -hu, u), -hv, v));
  for (let k = 0; k < 3; ++k) {
    sum.hessian[k] = along(sum.hessian[k], -side * weight / r,
      [0, 1, 2].map(l => huu * u[k] * u[l] + huv * (u[k] * v[l] + v[k] * u[l]) + hvv * v[k] * v[l]));
  }
  if (weight > sum.largest) [sum.largest, sum.leaf] = [weight, i];
}

function isSupported(s, rules, sum) {
  if (sum.outside > 0.5 * sum.weight || sum.clearance > 0) return false;
  if (sum.coverage >= s.coverThreshold) return true;
  return sum.leaves >= rules.kMinLeaves && length(sum.offsets) < rules.kMaxMeanOffset * sum.weight;
}

/** Principal curvatures of a level set by its gradient and Hessian. */
export function principal(g, h) {
  const n2 = dot(g, g), hg = h.map(row => dot(row, g));
  const mean = 0.5 * (h[0][0] + h[1][1] + h[2][2] - dot(g, hg) / n2) / Math.sqrt(n2);
  const minors = dot(g, [cross(h[1], h[2]), cross(h[2], h[0]), cross(h[0], h[1])].map(row => dot(row, g)));
  const spread = Math.sqrt(Math.max(0, mean * mean - minors / (n2 * n2)));
  return [mean + spread, mean - spread];
}

/** The colour of a leaf at a place of its plane: its texture's within the reach of these, its polynomial's elsewhere. */
function leafColor(s, rules, i, u, v, square) {
  const reach = rules.kTextureReach;
  if (s.textures?.side[i] && square < reach * reach) return textureColor(s.textures, i, u / reach, v / reach);
  const terms = s.colors.subarray(COLOR_TERMS * i, COLOR_TERMS * (i + 1)), powers = [1, u, v, u * u, u * v, v * v];
  const color = [0, 1, 2].map(c => powers.reduce((value, power, k) => value + power * terms[3 * k + c], 0));
  return color.map(c => Math.max(0, Math.min(255, c)));
}

/** Red, green and blue, 0 ... 255, at a point with the normal of its side: modules/query/src/probe. */
function colorAt(s, rules, point, normal) {
  let all = 0, sum = [0, 0, 0];
  for (let i = 0; i < s.leaves; ++i) {
    const r = s.radius[i], q = [s.x[i], s.y[i], s.z[i]].map((c, k) => (point[k] - c) / r), square = dot(q, q);
    if (!(square < 1)) continue;
    const frame = frameOf(s, i), [u, v] = frame.map(axis => dot(q, axis));
    const isOwn = Math.abs(alongRay(s, i, frame, q, frame[2])[0]) <= rules.kColorGate &&
      (!s.oriented || dot(normal, frame[2]) > 0);
    const blend = kernel(s.kernel, square), own = s.textures ? textureWeight(rules, square, blend) : blend;
    const weight = (isOwn ? 1 : rules.kOtherSheet) * s.weight[i] * own;
    all += weight;
    sum = along(sum, weight, leafColor(s, rules, i, u, v, square));
  }
  return all > 0 ? scaled(sum, 1 / all) : [255, 255, 255];
}

/**
 * What a ray meets, in local units and in double: {depth, point, normal, kMax, kMin, leaf, color}, or null.
 * rules: the frame's constants, and front, trim, near and clip, a box or nothing. O(leaves).
 */
export function cast(s, rules, eye, direction) {
  const part = rules.clip ? within(rules.clip, eye, direction, rules.near) : [rules.near, Infinity];
  if (!part) return null;
  let [nearest, end] = part;
  for (let layer = 0; layer < rules.kMaxLayers; ++layer) {
    const first = firstHit(s, rules, eye, direction, nearest);
    if (first > end || first === Infinity) return null;
    const sum = {weight: 0, shift: 0, coverage: 0, outside: 0, clearance: 0, leaves: 0, side: 0, largest: 0, leaf: -1,
                 offsets: [0, 0, 0], gradient: [0, 0, 0], hessian: [[0, 0, 0], [0, 0, 0], [0, 0, 0]]};
    for (let i = 0; i < s.leaves; ++i) blendLeaf(s, rules, i, eye, direction, first, sum);
    if (sum.leaf < 0) return null;
    if (isSupported(s, rules, sum)) {
      const depth = first + sum.shift / sum.weight;
      const [kMax, kMin] = principal(scaled(sum.gradient, 1 / sum.weight),
                                     sum.hessian.map(row => scaled(row, 1 / sum.weight)));
      const point = along(eye, depth, direction), normal = unit(sum.gradient), hit = {depth, point, normal, kMax, kMin, leaf: sum.leaf};
      if (s.colored) hit.color = colorAt(s, rules, point, s.oriented && sum.side < 0 ? scaled(normal, -1) : normal);
      return hit;
    }
    nearest = first + (sum.clearance > 0 ? rules.kBehind : rules.kPeelStep) * s.radius[sum.leaf];
  }
  return null;
}
