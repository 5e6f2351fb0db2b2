// SPDX-License-Identifier: BSD-3-Clause
// A surface's frames by the processor, tile by tile: the passes of renderer.js for one ray after the other, in double. Browsers
// without a graphics card take thirty times as long for the shaders.
import {within} from './box.js';
import {NOTHING} from './frames.js';
import {kernel, outsideShare, principal} from './rays.js';
import {meanTextureColor, textureWeight} from './textures.js';

const BLOCK = 8;     // pixels a side whose rays share a list
const COLUMNS = 17;  // of a surfel in a view: centre from the eye, radius; w, u, v; weight, cover, trim, nearest end
const RADIUS = 3, W = 4, U = 7, V = 10, WEIGHT = 13, COVER = 14, TRIM = 15, BEGIN = 16;

const poly = new Float64Array(5), local = new Float64Array(4), found = Float64Array.from({length: 5});
const slopes = [0, 1, 2, 3, 4].map(() => new Float64Array(5)), turns = [0, 1, 2, 3, 4].map(() => new Float64Array(5));

const valueAt = (a, x) => a[0] + x * (a[1] + x * (a[2] + x * (a[3] + x * a[4])));
const slopeAt = (a, x) => a[1] + x * (2 * a[2] + x * (3 * a[3] + x * 4 * a[4]));

/** The root in an interval in which a polynomial is monotone and changes its sign. */
function rootBetween(a, low, high, atLow, atHigh) {
  let x = low + (high - low) * atLow / (atLow - atHigh);
  for (let k = 0; k < 60; ++k) {
    const f = valueAt(a, x);
    if (f > 0 === atLow > 0) low = x; else high = x;
    let next = x - f / slopeAt(a, x);
    if (!(next >= low && next <= high) || k > 8 && k % 2 === 0) next = (low + high) / 2;
    if (Math.abs(next - x) < 1e-12) return next;
    x = next;
  }
  return x;
}

/** Roots of a polynomial of a degree in an interval, ascending; how many. */
function rootsOf(a, degree, low, high, out) {
  if (!(low <= high)) return 0;
  const h = Math.max(Math.abs(low), Math.abs(high));
  const bend = h * (2 * Math.abs(a[2]) + h * (3 * Math.abs(a[3]) + h * 4 * Math.abs(a[4])));
  let stops = 0, count = 0;
  const turn = turns[degree];
  if (!(Math.abs(a[1]) > bend) && degree > 1) {
    const d = slopes[degree];
    for (let k = 0; k < degree; ++k) d[k] = (k + 1) * a[k + 1];
    stops = rootsOf(d, degree - 1, low, high, turn);
  }
  let l = low, atL = valueAt(a, l);
  for (let k = 0; k <= stops; ++k) {
    const r = k < stops ? turn[k] : high, atR = valueAt(a, r);
    if (atL > 0 !== atR > 0) out[count++] = rootBetween(a, l, r, atL, atR);
    l = r;
    atL = atR;
  }
  return count;
}

export class Tracer {
  /** frames: SurfaceFrames, whose leaves in their texels it goes by */
  constructor(frames) {
    Object.assign(this, {frames, c: frames.texels, at: frames.perLeaf * 4});
    this.columns = new Float64Array(COLUMNS * frames.surface.count);
    this.sum = {};
  }

  /** Takes up the frame that was begun. */
  begin() {
    const {frames, columns: s, c, at} = this, {surface, values, rules, view} = frames, f = view.axes[2];
    this.values = values;
    const {slimEye: eye, slimDetail: detail} = values, cover = Math.min(rules.kMaxShrink, values.slimCoverRadius);
    const fade = size => {
      const t = Math.min(1, Math.max(0, (rules.kDetailFade - size) / (rules.kDetailFade - 1)));
      return t * t * (3 - 2 * t);
    };
    for (let i = 0, p = 0, q = 0; i < surface.count; ++i, p += COLUMNS, q += at) {
      for (let k = 0; k < 3; ++k) {
        s[p + k] = c[q + k] - eye[k];
        s[p + W + k] = c[q + 4 + k];
        s[p + U + k] = c[q + 8 + k];
        s[p + V + k] = c[q + 4 + (k + 1) % 3] * c[q + 8 + (k + 2) % 3] - c[q + 4 + (k + 2) % 3] * c[q + 8 + (k + 1) % 3];
      }
      const z = s[p] * f[0] + s[p + 1] * f[1] + s[p + 2] * f[2], own = c[q + 14], least = Math.max(detail * (view.parallel ? 1 : z), 1e-30);
      const part = detail > 0 ? fade(own / least) * (1 - fade(c[q + 15] / least)) : +(i < surface.leaves), isInner = detail > 0 && own > 0;
      s[p + RADIUS] = c[q + 3];
      s[p + WEIGHT] = c[q + 7] * part;
      s[p + COVER] = isInner ? 0 : 1 / values.slimCoverRadius;
      s[p + TRIM] = isInner ? rules.kMaxShrink / cover : 1;
      s[p + BEGIN] = (view.parallel ? z : Math.hypot(s[p], s[p + 1], s[p + 2])) - c[q + 3];
    }
    this.part = i => s[COLUMNS * i + WEIGHT] / c[at * i + 7];
  }

  /**
   * f / r along a ray through a leaf, into poly. x, y, z: the point nearest to its centre, from there, in radii; dx, dy, dz: the
   * direction. local: both along the leaf's u and v axes.
   */
  alongRay(i, x, y, z, dx, dy, dz) {
    const {c, columns: s} = this, {degree} = this.frames.surface, k = this.at * i + 16, at = COLUMNS * i;
    const ux = s[at + U], uy = s[at + U + 1], uz = s[at + U + 2], vx = s[at + V], vy = s[at + V + 1], vz = s[at + V + 2];
    const wx = s[at + W], wy = s[at + W + 1], wz = s[at + W + 2];
    const u = x * ux + y * uy + z * uz, v = x * vx + y * vy + z * vz, w = x * wx + y * wy + z * wz;
    const p = dx * ux + dy * uy + dz * uz, q = dx * vx + dy * vy + dz * vz, r = dx * wx + dy * wy + dz * wz;
    local[0] = u;
    local[1] = v;
    local[2] = p;
    local[3] = q;
    let a0 = c[k] + c[k + 1] * u + c[k + 2] * v, a1 = c[k + 1] * p + c[k + 2] * q, a2 = 0, a3 = 0, a4 = 0;
    if (degree > 1) {
      const x = c[k + 3], y = c[k + 4], z = c[k + 5], gu = 2 * x * u + y * v, gv = y * u + 2 * z * v;
      a0 += (gu * u + gv * v) / 2;
      a1 += gu * p + gv * q;
      a2 += x * p * p + y * p * q + z * q * q;
    }
    if (degree > 2) {
      const x = c[k + 6], y = c[k + 7], z = c[k + 8], t = c[k + 9];
      const gu = 3 * x * u * u + 2 * y * u * v + z * v * v, gv = y * u * u + 2 * z * u * v + 3 * t * v * v;
      const hu = 3 * x * p * p + 2 * y * p * q + z * q * q, hv = y * p * p + 2 * z * p * q + 3 * t * q * q;
      a0 += (gu * u + gv * v) / 3;
      a1 += gu * p + gv * q;
      a2 += hu * u + hv * v;
      a3 += (hu * p + hv * q) / 3;
    }
    if (degree > 3) {
      const x = c[k + 10], y = c[k + 11], z = c[k + 12], t = c[k + 13], o = c[k + 14];
      const gu = 4 * x * u * u * u + 3 * y * u * u * v + 2 * z * u * v * v + t * v * v * v;
      const gv = y * u * u * u + 2 * z * u * u * v + 3 * t * u * v * v + 4 * o * v * v * v;
      const hu = 4 * x * p * p * p + 3 * y * p * p * q + 2 * z * p * q * q + t * q * q * q;
      const hv = y * p * p * p + 2 * z * p * p * q + 3 * t * p * q * q + 4 * o * q * q * q;
      const uu = 12 * x * u * u + 6 * y * u * v + 2 * z * v * v, uv = 3 * y * u * u + 4 * z * u * v + 3 * t * v * v;
      const vv = 2 * z * u * u + 6 * t * u * v + 12 * o * v * v;
      a0 += (gu * u + gv * v) / 4;
      a1 += gu * p + gv * q;
      a2 += (uu * p * p + 2 * uv * p * q + vv * q * q) / 2;
      a3 += hu * u + hv * v;
      a4 += (hu * p + hv * q) / 4;
    }
    poly[0] = w - a0;
    poly[1] = r - a1;
    poly[2] = -a2;
    poly[3] = -a3;
    poly[4] = -a4;
  }

  /** The first hit of a ray behind `nearest` with the leaves of a list, nearest ends first; or infinity. */
  firstHit(list, [dx, dy, dz], [ox, oy, oz], nearest) {
    const {columns: s, frames} = this, {rules, surface, reach} = frames, trimmed = rules.trim && surface.trimmed, {degree} = surface;
    let first = Infinity;
    for (const i of list) {
      const at = COLUMNS * i;
      if (s[at + BEGIN] > first) break;
      const cx = s[at] - ox, cy = s[at + 1] - oy, cz = s[at + 2] - oz, radius = s[at + RADIUS];
      const depth = cx * dx + cy * dy + cz * dz, px = (dx * depth - cx) / radius, py = (dy * depth - cy) / radius, pz = (dz * depth - cz) / radius;
      const rest = reach * reach - (px * px + py * py + pz * pz);
      if (!(rest > 0) || this.detailed && this.part(i) < rules.kDetailMeets) continue;
      const half = Math.sqrt(rest), low = Math.max(-half, (nearest - depth) / radius), high = Math.min(half, (first - depth) / radius);
      if (!(low <= high)) continue;
      this.alongRay(i, px, py, pz, dx, dy, dz);
      const count = rootsOf(poly, degree, low, high, found);
      for (let k = 0; k < count; ++k) {
        const root = found[k], z = s[at + TRIM], [u, v, p, q] = local;
        if (rules.front && !(slopeAt(poly, root) < 0)) continue;
        if (trimmed && surface.side[i] && outsideShare(surface, i, z * (u + root * p), z * (v + root * q)) > 0.5) continue;
        first = depth + root * radius;
        break;
      }
    }
    return first;
  }

  /** Sums over the leaves around a first hit. */
  blend(list, [dx, dy, dz], [ox, oy, oz], first) {
    const {columns: s, frames, c, sum} = this, {rules, surface, values} = frames, {degree, kernel: power} = surface;
    const trimmed = rules.trim && surface.trimmed;
    let weight = 0, shift = 0, coverage = 0, outside = 0, clearance = 0, leaves = 0, side = 0, largest = 0, leaf = -1, radii = 0;
    let qx = 0, qy = 0, qz = 0, gx = 0, gy = 0, gz = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    for (const i of list) {
      const at = COLUMNS * i;
      if (s[at + BEGIN] > first) break;
      const cx = s[at] - ox, cy = s[at + 1] - oy, cz = s[at + 2] - oz, radius = s[at + RADIUS];
      const depth = cx * dx + cy * dy + cz * dz, hat = (first - depth) / radius;
      const px = (dx * depth - cx) / radius, py = (dy * depth - cy) / radius, pz = (dz * depth - cz) / radius;
      const distance2 = px * px + py * py + pz * pz, hat2 = distance2 + hat * hat;
      if (!(hat2 < 1)) continue;
      this.alongRay(i, px, py, pz, dx, dy, dz);
      const atHat = valueAt(poly, hat);
      if (!(Math.abs(atHat) < rules.kMaxShift)) continue;
      const half = Math.sqrt(1 - distance2), count = rootsOf(poly, degree, Math.max(-half, (values.slimNear - depth) / radius), half, found);
      let root = Infinity;
      for (let k = 0; k < count; ++k) {
        if (Math.abs(found[k] - hat) < Math.abs(root - hat) && !(rules.front && slopeAt(poly, found[k]) >= 0)) root = found[k];
      }
      const behind = valueAt(poly, hat + rules.kBehind);
      if (root === Infinity) {
        if (atHat > 0) clearance += s[at + WEIGHT] * kernel(power, hat2) * radius * behind;
        continue;
      }
      const root2 = distance2 + root * root, g = s[at + WEIGHT] * kernel(power, Math.max(hat2, root2));
      if (!(g > 0)) continue;
      const ux = s[at + U], uy = s[at + U + 1], uz = s[at + U + 2], vx = s[at + V], vy = s[at + V + 1], vz = s[at + V + 2];
      const wx = s[at + W], wy = s[at + W + 1], wz = s[at + W + 2], u = local[0] + root * local[2], v = local[1] + root * local[3];
      const k = this.at * i + 16, turned = slopeAt(poly, root) > 0 ? -1 : 1, cover = s[at + COVER];
      let hu = c[k + 1], hv = c[k + 2], huu = 0, huv = 0, hvv = 0;
      if (degree > 1) {
        huu = 2 * c[k + 3];
        huv = c[k + 4];
        hvv = 2 * c[k + 5];
        hu += huu * u + huv * v;
        hv += huv * u + hvv * v;
      }
      if (degree > 2) {
        const x = c[k + 6], y = c[k + 7], z = c[k + 8], t = c[k + 9];
        hu += 3 * x * u * u + 2 * y * u * v + z * v * v;
        hv += y * u * u + 2 * z * u * v + 3 * t * v * v;
        huu += 6 * x * u + 2 * y * v;
        huv += 2 * (y * u + z * v);
        hvv += 2 * z * u + 6 * t * v;
      }
      if (degree > 3) {
        const x = c[k + 10], y = c[k + 11], z = c[k + 12], t = c[k + 13], o = c[k + 14];
        hu += 4 * x * u * u * u + 3 * y * u * u * v + 2 * z * u * v * v + t * v * v * v;
        hv += y * u * u * u + 2 * z * u * u * v + 3 * t * u * v * v + 4 * o * v * v * v;
        huu += 12 * x * u * u + 6 * y * u * v + 2 * z * v * v;
        huv += 3 * y * u * u + 4 * z * u * v + 3 * t * v * v;
        hvv += 2 * z * u * u + 6 * t * u * v + 12 * o * v * v;
      }
      weight += g;
      shift += g * (root - hat) * radius;
      coverage += kernel(power, root2 * cover * cover);
      clearance += g * radius * Math.min(turned * behind, 0);
      if (trimmed && surface.side[i]) outside += g * outsideShare(surface, i, s[at + TRIM] * u, s[at + TRIM] * v);
      radii += g * radius;
      side += turned;
      ++leaves;
      qx += g * (px + root * dx);
      qy += g * (py + root * dy);
      qz += g * (pz + root * dz);
      const t = turned * g, b = -t / radius;
      gx += t * (wx - hu * ux - hv * vx);
      gy += t * (wy - hu * uy - hv * vy);
      gz += t * (wz - hu * uz - hv * vz);
      xx += b * (huu * ux * ux + 2 * huv * ux * vx + hvv * vx * vx);
      yy += b * (huu * uy * uy + 2 * huv * uy * vy + hvv * vy * vy);
      zz += b * (huu * uz * uz + 2 * huv * uz * vz + hvv * vz * vz);
      xy += b * (huu * ux * uy + huv * (ux * vy + vx * uy) + hvv * vx * vy);
      xz += b * (huu * ux * uz + huv * (ux * vz + vx * uz) + hvv * vx * vz);
      yz += b * (huu * uy * uz + huv * (uy * vz + vy * uz) + hvv * vy * vz);
      if (g > largest) [largest, leaf] = [g, i];
    }
    const isGap = leaves >= rules.kMinLeaves && Math.hypot(qx, qy, qz) < rules.kMaxMeanOffset * weight;
    const supported = !(outside > 0.5 * weight || clearance > 0) && (coverage >= surface.coverThreshold || isGap);
    return Object.assign(sum, {weight, shift, clearance, side, leaf, radii, supported, gx, gy, gz, xx, yy, zz, xy, xz, yz});
  }

  /** The mean colour of the leaves around a place of a ray, 0 ... 1. normal: of the side that is seen */
  colorAt(list, [dx, dy, dz], [ox, oy, oz], place, normal, color) {
    const {columns: s, frames, c} = this, {rules, surface, values, texturesSeen: textures} = frames, {slimScreen: [pixel, , , parallel]} = values;
    const one = [0, 0, 0], reach = rules.kTextureReach, wide = pixel * (parallel ? 1 : place);
    let all = 0, red = 0, green = 0, blue = 0;
    for (const i of list) {
      const at = COLUMNS * i;
      if (s[at + BEGIN] > place) break;
      const cx = s[at] - ox, cy = s[at + 1] - oy, cz = s[at + 2] - oz, radius = s[at + RADIUS];
      const depth = cx * dx + cy * dy + cz * dz, root = (place - depth) / radius;
      const px = (dx * depth - cx) / radius, py = (dy * depth - cy) / radius, pz = (dz * depth - cz) / radius;
      const s2 = px * px + py * py + pz * pz + root * root;
      if (!(s2 < 1)) continue;
      this.alongRay(i, px, py, pz, dx, dy, dz);
      const z = s[at + TRIM], own2 = z * z * s2, blend = kernel(surface.kernel, s2);
      const faces = !surface.oriented || s[at + W] * normal[0] + s[at + W + 1] * normal[1] + s[at + W + 2] * normal[2] > 0;
      const isOwn = faces && Math.abs(valueAt(poly, root)) <= rules.kColorGate;
      const g = s[at + WEIGHT] * (isOwn ? 1 : rules.kOtherSheet) * (textures ? textureWeight(rules, own2, blend) : blend);
      if (!(g > 0)) continue;
      const u = local[0] + root * local[2], v = local[1] + root * local[3];
      if (textures?.side[i] && own2 < reach * reach) {
        meanTextureColor(textures, i, z * u / reach, z * v / reach, z * wide / radius / reach, one);
      } else {
        const k = this.at * i + 4 * frames.colorAt;
        for (let n = 0; n < 3; ++n) {
          one[n] = c[k + n] + u * c[k + 3 + n] + v * c[k + 6 + n] + u * u * c[k + 9 + n] + u * v * c[k + 12 + n] + v * v * c[k + 15 + n];
        }
      }
      all += g;
      red += g * Math.min(255, Math.max(0, one[0]));
      green += g * Math.min(255, Math.max(0, one[1]));
      blue += g * Math.min(255, Math.max(0, one[2]));
    }
    if (all > 0) color.set([red / all / 255, green / all / 255, blue / all / 255, 1]);
  }

  /** What the rays of a tile meet: columns of geometry, attributes, met, named and, where it is asked for, painted. O(pixels x leaves of a block). */
  trace({box: [left, top, width, height], list}, isPainted) {
    const {columns: s} = this, {rules, values, eye, unit} = this.frames, size = width * height;
    const out = {geometry: new Float32Array(4 * size), attributes: new Float32Array(2 * size), met: new Float32Array(size).fill(NOTHING),
                 named: new Float32Array(4 * size), painted: isPainted && new Float32Array(4 * size)};
    const order = Uint32Array.from(list).sort((a, b) => s[COLUMNS * a + BEGIN] - s[COLUMNS * b + BEGIN]);
    const clip = rules.clip?.map(corner => corner.map((x, k) => (x - eye[k]) / unit)), half = BLOCK / 2;
    this.detailed = values.slimDetail > 0;
    for (let y = 0; y < height; y += BLOCK) {
      for (let x = 0; x < width; x += BLOCK) {
        const near = this.nearTo(order, this.ray(left + x + half, top + y + half), Math.SQRT1_2 * BLOCK * values.slimScreen[0]);
        if (!near.length) continue;
        for (let at = 0; at < BLOCK * BLOCK; ++at) {
          const column = x + at % BLOCK, row = y + (at / BLOCK | 0);
          if (column >= width || row >= height) continue;
          const [direction, origin] = this.ray(left + column + 0.5, top + row + 0.5);
          const part = clip ? within(clip, origin, direction, values.slimNear) : [values.slimNear, Infinity];
          if (part) this.traceRay(near, direction, origin, part, row * width + column, out);
        }
      }
    }
    return out;
  }

  /** Direction and origin, from the eye, of the ray through a place of the picture. */
  ray(column, row) {
    const {values: {slimScreen: [pixel], slimShift: shift}, view: {axes: [right, up, forward], width, height, parallel}} = this.frames;
    const x = pixel * (column + shift[0] - width / 2), y = -pixel * (row + shift[1] - height / 2), length = Math.hypot(x, y, 1);
    const aside = right.map((r, k) => x * r + y * up[k]);
    return parallel ? [forward, aside] : [forward.map((f, k) => (f + aside[k]) / length), [0, 0, 0]];
  }

  /** Those of a list whose balls are within some distance of a ray; at unit depth, in perspective. */
  nearTo(list, [[dx, dy, dz], [ox, oy, oz]], distance) {
    const {columns: s} = this, {parallel} = this.frames.view;
    return list.filter(i => {
      const at = COLUMNS * i, cx = s[at] - ox, cy = s[at + 1] - oy, cz = s[at + 2] - oz, radius = s[at + RADIUS];
      const depth = cx * dx + cy * dy + cz * dz, reach = radius + distance * (parallel ? 1 : Math.max(0, depth) + radius);
      return s[at + WEIGHT] > 0 && cx * cx + cy * cy + cz * cz - depth * depth < reach * reach;
    });
  }

  traceRay(list, direction, origin, [nearest, end], at, out) {
    const {rules, surface} = this.frames;
    for (let layer = 0; layer < rules.kMaxLayers; ++layer) {
      const first = this.firstHit(list, direction, origin, nearest);
      if (!(first <= end) || first === Infinity) return;
      const m = this.blend(list, direction, origin, first), n = m.weight;
      if (!(n > 0)) return;
      if (!m.supported) {
        nearest = first + (m.clearance > 0 ? rules.kBehind : rules.kPeelStep) * m.radii / n;
        continue;
      }
      const g = [m.gx / n, m.gy / n, m.gz / n], l = Math.hypot(...g) || 1, depth = first + m.shift / n;
      const h = [[m.xx / n, m.xy / n, m.xz / n], [m.xy / n, m.yy / n, m.yz / n], [m.xz / n, m.yz / n, m.zz / n]];
      const leaf = this.at * m.leaf;
      out.geometry.set([g[0] / l, g[1] / l, g[2] / l, surface.oriented && m.side < 0 ? -depth : depth], 4 * at);
      out.attributes.set(principal(g, h), 2 * at);
      out.met[at] = first;
      out.named.set([0, 0, this.c[leaf + 3] / this.columns[COLUMNS * m.leaf + TRIM], this.c[leaf + 11]], 4 * at);
      if (!out.painted) return;
      const seen = out.geometry.subarray(4 * at, 4 * at + 3), side = surface.oriented && m.side < 0 ? -1 : 1;
      return this.colorAt(list, direction, origin, depth, [side * seen[0], side * seen[1], side * seen[2]], out.painted.subarray(4 * at, 4 * at + 4));
    }
  }
}
