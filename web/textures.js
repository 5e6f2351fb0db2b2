// SPDX-License-Identifier: BSD-3-Clause
// Textures of surfels: as modules/web/src/page_textures.cpp packs them, their colours, and their texels on a graphics card.

const CLASSES = [1, 3, 6, 12, 24, 48];  // least sizes of residuals around a texel of the planes behind the first

const signed = byte => byte << 24 >> 24;
const median = (a, b, corner) => Math.max(Math.min(a, b), Math.min(Math.max(a, b), a + b - corner));

/** Luma and two differences of a colour, each modulo 256. */
function lumaOf([red, green, blue]) {
  const orange = signed(red - blue), base = blue + (orange >> 1) & 255, rest = signed(green - base);
  return [base + (rest >> 1) & 255, orange, rest];
}

/** Texels of which no place of the disc takes its colour are not stored. */
function isOutsideDisc(side, column, row) {
  const x = Math.max(Math.abs(2 * column + 1 - side) - 2, 0), y = Math.max(Math.abs(2 * row + 1 - side) - 2, 0);
  return x * x + y * y >= side * side;
}

/** Undoes the prediction of one texture. take(channel, plane): the next residual. */
function readTexture(side, first, step, take, rgb) {
  const values = new Int16Array(3 * side * side), sizes = new Int16Array(side * side);
  for (let at = 0; at < side * side; ++at) {
    const row = at / side | 0, column = at % side, stored = !isOutsideDisc(side, column, row);
    const from = row ? at - side : at - 1;
    let plane = 0, around = 0;
    if (row && stored) {
      around = sizes[from] + (column + 1 < side ? sizes[from + 1] : 0) + (column ? sizes[at - 1] + sizes[from - 1] : 0);
      while (plane < CLASSES.length && around >= CLASSES[plane]) ++plane;
    }
    for (let c = 0; c < 3; ++c) {
      let value = at ? values[3 * from + c] : first[c];
      if (stored) {
        if (row && column) value = median(values[3 * at - 3 + c], value, values[3 * from - 3 + c]);
        const residual = signed(take(c, plane));
        value = c ? signed(value + residual) : value + residual & 255;
        sizes[at] += Math.abs(residual);
      }
      values[3 * at + c] = value;
    }
    const green = values[3 * at + 2], base = values[3 * at] - (green >> 1);
    const orange = values[3 * at + 1], blue = base - (orange >> 1);
    rgb[3 * at] = Math.min(255, (blue + orange & 255) * step);
    rgb[3 * at + 1] = Math.min(255, (base + green & 255) * step);
    rgb[3 * at + 2] = Math.min(255, (blue & 255) * step);
  }
}

/** The textures of all surfels: sides (0: none), where each begins in texels, and red, green and blue of these. */
export function readTextures(s, planes, colorTerms) {
  const [error] = planes.get(1, 1), step = 2 * error + 1, side = planes.get(s.count, 1);
  const counts = Array.from(planes.get(CLASSES.length + 1, 4));
  const streams = [0, 1, 2].map(() => counts.map(count => ({bytes: planes.raw(count), at: 0})));
  const take = (c, plane) => {
    const stream = streams[c][plane];
    return stream.bytes[stream.at++];
  };
  const begin = new Uint32Array(s.count + 1);
  side.forEach((n, i) => begin[i + 1] = begin[i] + n * n);
  const rgb = new Uint8Array(3 * begin[s.count]);
  for (let i = 0; i < s.count; ++i) {
    const term = s.colors.subarray(colorTerms * i, colorTerms * i + 3).map(x => Math.floor((x + error) / step));
    readTexture(side[i], lumaOf(term), step, take, rgb.subarray(3 * begin[i], 3 * begin[i + 1]));
  }
  s.textures = {side, begin, rgb};
}

/** Weight of a leaf's colour by the squared distance from its centre, in radii, where a surface has textures. */
export function textureWeight(rules, square, blend) {
  return Math.max(1 - square / rules.kTextureReach ** 2, 0) ** 8 + rules.kTextureOuterWeight * blend;
}

/** The colour of a surfel's texture at a place of its plane, in its reach: -1 ... 1. */
export function textureColor({side: sides, begin, rgb}, i, x, y, color = [0, 0, 0]) {
  const side = sides[i], last = side - 1, column = Math.min(last, Math.max(0, 0.5 * side * (x + 1) - 0.5));
  const row = Math.min(last, Math.max(0, 0.5 * side * (y + 1) - 0.5)), next = side > 1 ? 3 : 0, down = next * side;
  const left = Math.min(column | 0, Math.max(side - 2, 0)), top = Math.min(row | 0, Math.max(side - 2, 0));
  const a = column - left, b = row - top, first = 3 * (begin[i] + top * side + left);
  for (let c = 0, at = first; c < 3; ++c, ++at) {
    const above = rgb[at] + a * (rgb[at + next] - rgb[at]), below = rgb[at + down] + a * (rgb[at + down + next] - rgb[at + down]);
    color[c] = above + b * (below - above);
  }
  return color;
}

/** The mean over a square, which a pixel shows that is wider than texels. width: in the reach */
export function meanTextureColor(textures, i, x, y, width, color) {
  const wide = 0.5 * textures.side[i] * width, taps = wide < 1.5 ? 1 : Math.min(Math.floor(wide + 0.5), 4);
  if (taps === 1) return textureColor(textures, i, x, y, color);
  const step = width / taps, first = 0.5 * (step - width), sum = [0, 0, 0];
  for (let k = 0; k < taps * taps; ++k) {
    textureColor(textures, i, x + first + step * (k % taps), y + first + step * (k / taps | 0), color);
    for (let c = 0; c < 3; ++c) sum[c] += color[c];
  }
  for (let c = 0; c < 3; ++c) color[c] = sum[c] / (taps * taps);
  return color;
}

/** Textures of half as many texels a side. */
function halved(textures) {
  const side = textures.side.map(n => n + 1 >> 1), begin = new Uint32Array(side.length + 1);
  side.forEach((n, i) => begin[i + 1] = begin[i] + n * n);
  const rgb = new Uint8Array(3 * begin[side.length]);
  side.forEach((n, i) => {
    for (let k = 0; k < n * n; ++k) {
      const place = [k % n, k / n | 0].map(cell => (2 * cell + 1) / n - 1);
      rgb.set(textureColor(textures, i, ...place).map(Math.round), 3 * (begin[i] + k));
    }
  });
  return {side, begin, rgb};
}

/** The textures that a card of a size takes: halved until there are at most so many texels. */
export function withinTexels(textures, most) {
  const texels = t => t.begin[t.begin.length - 1];
  while (texels(textures) > most && textures.side.some(n => n > 1)) textures = halved(textures);
  return textures;
}
