// SPDX-License-Identifier: BSD-3-Clause
// The rays of a page's opening view in double, as clicks are answered, without a browser:
// node cast.mjs CHROMIUM PAGE OUT WIDTH HEIGHT ... writes what gbuffer.mjs does, but of pictures the colours alone.
import {readFileSync, writeFileSync} from 'node:fs';
import {Camera} from '../../web/camera.js';
import {cast} from '../../web/rays.js';
import {decode, inflate} from '../../web/surface.js';

const [, page, out, w, h, , , mode] = process.argv.slice(2), width = +w, height = +h;
const part = id => new RegExp(`id="${id}">([^<]*)<`).exec(readFileSync(page, 'utf8'))[1];
const options = JSON.parse(part('options'));
const surface = decode(await inflate(part('data'), options.bytes));
const camera = new Camera(options.camera, options.turn, surface.origin, surface.scale);
const rules = {...options.constants, front: options.front, trim: options.trim, near: options.near};
const picture = new Uint8Array(mode ? 4 * width * height : 0), columns = [0, 1, 2].map(() => new Float32Array(4 * width * height));
for (let k = 0; k < width * height; ++k) {
  const hit = cast(surface, rules, ...camera.ray(k % width + 0.5, Math.floor(k / width) + 0.5, width, height));
  if (!hit) continue;
  columns[0].set([...hit.normal, hit.depth], 4 * k);
  columns[1].set([hit.kMax, hit.kMin], 4 * k);
  if (mode) picture.set(hit.color.map(Math.round), 4 * k);
  columns[2].set([0, 0, surface.radius[hit.leaf], surface.level[hit.leaf]], 4 * k);
}
writeFileSync(out, Buffer.concat([new Float64Array([surface.scale, width, height]), ...columns, picture].map(c => Buffer.from(c.buffer))));
