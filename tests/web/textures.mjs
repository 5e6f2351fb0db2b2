// SPDX-License-Identifier: BSD-3-Clause
// Textures for cards that have no room for all texels: node textures.mjs CHROMIUM PAGE prints what is wrong.
import {readFileSync} from 'node:fs';
import {decode, inflate} from '../../web/surface.js';
import {textureColor, withinTexels} from '../../web/textures.js';

const text = readFileSync(process.argv[3], 'utf8'), part = id => new RegExp(`id="${id}">([^<]*)<`).exec(text)[1];
const {textures} = decode(await inflate(part('data'), JSON.parse(part('options')).bytes));
const count = t => t.begin[t.begin.length - 1], all = count(textures);
const check = (right, what) => right || console.log(what);

check(withinTexels(textures, all) === textures, 'textures change where there is room for them');
for (const share of [2, 5]) {
  const few = withinTexels(textures, all / share);
  check(count(few) <= all / share, `more than 1/${share} of the texels`);
  check(few.rgb.length === 3 * count(few), 'texels are missing');
  const differences = [];
  for (let i = 0; i < textures.side.length; ++i) {
    for (let k = 0; k < 64; ++k) {
      const x = (k % 8 - 3.5) / 6, y = ((k >> 3) - 3.5) / 6, color = textureColor(textures, i, x, y);
      if (textures.side[i]) textureColor(few, i, x, y).forEach((value, c) => differences.push(Math.abs(value - color[c])));
    }
  }
  differences.sort((a, b) => a - b);
  // Six texels a side are .4 radians of a wave of 100 wide: 100 * .4^2 / 8, and rounding twice.
  check(differences[Math.floor(0.9 * differences.length)] < 4, `colours differ with 1/${share} of the texels`);
}
