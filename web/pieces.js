// SPDX-License-Identifier: BSD-3-Clause
// Boxes and squares of many surfels or discs in one draw call, and which of them a part of a picture needs.

/** Triangles of equal pieces, whose vertex shaders go by gl_VertexID alone: piece by piece `corners` numbers. Instances of
 * so few triangles take a processor four times as long. */
export class Pieces {
  constructor(gl, corners, triangles) {
    Object.assign(this, {gl, corners, triangles, array: gl.createVertexArray()});
    gl.bindVertexArray(this.array);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bindVertexArray(null);
  }

  /** Draws the pieces of a list of numbers, which is not changed afterwards. */
  draw(list, kind = this.gl.TRIANGLES) {
    const {gl, corners, triangles} = this;
    gl.bindVertexArray(this.array);
    if (list !== this.list) {
      const elements = new Uint32Array(triangles.length * list.length);
      list.forEach((piece, at) => triangles.forEach((corner, k) => elements[triangles.length * at + k] = corners * piece + corner));
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, elements, gl.DYNAMIC_DRAW);
      this.list = list;
    }
    gl.drawElements(kind, triangles.length * list.length, gl.UNSIGNED_INT, 0);
    gl.bindVertexArray(null);
  }
}

/** 0 ... count - 1. */
export const numbersTo = count => Uint32Array.from({length: count}, (_, i) => i);

export const SQUARE = [4, [0, 1, 2, 2, 1, 3]];  // corners: bit 0 right, bit 1 down

/** One corner: a point. */
export const POINT = [1, [0]];

/** A square's corners and its middle, number 4. */
export const TENT = [5, [4, 0, 1, 4, 1, 3, 4, 3, 2, 4, 2, 0]];

/** A cube's corners, bits for x, y, z, and its triangles. */
export const CUBE = [8, [6, 7, 2, 2, 7, 3, 2, 3, 1, 1, 3, 7, 1, 7, 5, 5, 7, 6, 5, 6, 4, 4, 6, 2, 4, 2, 0, 0, 2, 1, 0, 1, 4, 4, 1, 5]];

/**
 * The balls that a frame may show, each with the pixels that it covers and its depth: visit(number, left, top, right, bottom, depth).
 * frame: eye, axes, pixel at unit depth, width, height, parallel. radius(number, depth): below 0 for what it does not show;
 * margin: pixels around balls. O(count).
 */
export function seenBalls({eye, axes, pixel, width, height, parallel}, {x, y, z}, count, radius, margin, visit) {
  const [right, up, forward] = axes;
  for (let i = 0; i < count; ++i) {
    const dx = x[i] - eye[0], dy = y[i] - eye[1], dz = z[i] - eye[2];
    const depth = dx * forward[0] + dy * forward[1] + dz * forward[2], r = radius(i, depth);
    if (r < 0 || depth < -r) continue;
    const near = parallel ? 1 : depth - r, far = parallel ? 1 : depth + r;
    const side = (at, size) => near <= 0 ? [0, size] : [
      Math.max(0, (at - r) / (at < r ? near : far) / pixel + size / 2 - margin),
      Math.min(size, (at + r) / (at > -r ? near : far) / pixel + size / 2 + margin)];
    const [left, end] = side(dx * right[0] + dy * right[1] + dz * right[2], width);
    const [top, bottom] = side(-dx * up[0] - dy * up[1] - dz * up[2], height);
    if (left < end && top < bottom) visit(i, left, top, end, bottom, depth);
  }
}

/** Squares of a picture, those in the middle first: [left, top, width, height], and the numbers of the balls in them. */
export function tilesOf(frame, model, count, radius, margin, size) {
  const columns = Math.ceil(frame.width / size), rows = Math.ceil(frame.height / size);
  const tiles = Array.from({length: columns * rows}, (_, k) => {
    const left = k % columns * size, top = (k / columns | 0) * size;
    return {box: [left, top, Math.min(size, frame.width - left), Math.min(size, frame.height - top)], list: []};
  });
  seenBalls(frame, model, count, radius, margin, (i, left, top, right, bottom) => {
    for (let row = top / size | 0; row * size < bottom; ++row) {
      for (let column = left / size | 0; column * size < right; ++column) tiles[row * columns + column].list.push(i);
    }
  });
  const away = ({box: [left, top]}) => Math.hypot(left + size / 2 - frame.width / 2, top + size / 2 - frame.height / 2);
  return tiles.sort((a, b) => away(a) - away(b));
}
