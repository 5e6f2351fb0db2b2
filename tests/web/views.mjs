// SPDX-License-Identifier: BSD-3-Clause
// Standard views against the renderer's, and projections: node views.mjs CHROMIUM [UPX UPY UPZ NAME EYEX EYEY EYEZ TOPX TOPY TOPZ]...
// Prints what differs.
import {Camera} from '../../web/camera.js';
import {look} from '../../web/views.js';

/** Where three points are seen, the first of them ahead of the eye, the others as deep. */
function seen(camera, point) {
  const [right, up] = camera.axes();
  return [[0, 0], [0.2, 0], [0, 0.3]].flatMap(([x, y]) => camera.project(point.map((p, k) => p + x * right[k] + y * up[k]), 600, 400));
}

for (const more of [{fov: 40}, {height: 2}]) {
  const camera = new Camera({position: [3, 4, 5], look_at: [0.1, 0, 0], up: [0, 0, 1], aspect: 1.5, ...more}, [0, 0, 1], [0, 0, 0], 1);
  const point = [0.3, 0.2, -0.1], before = seen(camera, point);
  for (const parallel of [!camera.height, !!camera.height, !camera.height]) {
    camera.setParallel(parallel, point, {center: [0, 0, 0], radius: 1});
    const off = Math.max(...seen(camera, point).map((x, i) => Math.abs(x - before[i])));
    if (!(off < 1e-9) || parallel !== camera.height > 0) console.log('projection', more, parallel, off);
    if (parallel && !(camera.depth([0, 0, 0]) > 1)) console.log('the eye is in the object', camera.depth([0, 0, 0]));
  }
}

const words = process.argv.slice(3), BOX = [[-1, -2, -3], [2, 4, 1]];
for (let k = 0; k + 9 < words.length; k += 10) {
  const turn = words.slice(k, k + 3).map(Number), name = words[k + 3], truth = words.slice(k + 4, k + 10).map(Number);
  for (const fov of [30, 0]) {
    const given = {position: [3, 4, 5], look_at: [0, 0, 0], up: turn.map(x => x + 0.1), fov, height: fov ? 0 : 2, aspect: 1.5};
    const camera = new Camera(given, turn, [0, 0, 0], 1);
    const places = Array.from({length: 8}, (_, i) => [0, 1, 2].map(a => BOX[i >> a & 1][a]));
    look(camera, name, places.map(p => [...p, 0]), 600, 400);
    const seen = [...camera.axes()[2].map(x => -x), ...camera.up], off = Math.max(...seen.map((x, i) => Math.abs(x - truth[i])));
    const corners = places.map(p => camera.project(p, 600, 400));
    const [xs, ys] = [0, 1].map(a => corners.map(p => p[a])), wide = Math.max(...xs) - Math.min(...xs), tall = Math.max(...ys) - Math.min(...ys);
    if (!(off < 1e-9)) console.log(turn, name, seen, truth);
    if (!(Math.min(...xs, ...ys) > 0 && Math.max(...xs) < 600 && Math.max(...ys) < 400)) console.log(turn, name, 'outside', corners);
    if (!(wide > 0.9 * 600 || tall > 0.9 * 400)) console.log(turn, name, 'small', wide, tall);
  }
}
