// SPDX-License-Identifier: BSD-3-Clause
// One frame of a page as numbers: node gbuffer.mjs CHROMIUM PAGE OUT WIDTH HEIGHT LOD EXACT MODE...
// EXACT 1: sums in 32 bits, 0: in 16, as on the screen.
// OUT: floats of geometry, attributes and named leaves, four a pixel, then the bytes of a picture for each mode.
import {writeFileSync} from 'node:fs';
import {Browser} from './browser.mjs';

const [chromium, page, out, width, height, lod, exact, ...modes] = process.argv.slice(2);
const browser = await Browser.launch(chromium, +width, +height);
try {
  await browser.open(page, '#still');
  const message = await browser.evaluate('document.getElementById("message").hidden ? "" : document.getElementById("message").textContent');
  if (message) throw new Error(message);
  await browser.evaluate(`(async () => {
    const text = array => {
      const bytes = new Uint8Array(array.buffer);
      let all = '';
      for (let i = 0; i < bytes.length; i += 8192) all += String.fromCharCode(...bytes.subarray(i, i + 8192));
      return btoa(all);
    };
    slim.tick = () => {};
    slim.hollows = 0;
    const {geometry, attributes, named} = await slim.measure(${width}, ${height}, [0, 0], ${lod}, ${exact} > 0);
    const pictures = ${JSON.stringify(modes)}.map(mode => {
      slim.mode = mode;
      slim.show(false);
      const bytes = new Uint8Array(4 * ${width} * ${height});
      slim.gl.readPixels(0, 0, ${width}, ${height}, slim.gl.RGBA, slim.gl.UNSIGNED_BYTE, bytes);
      return bytes;
    });
    window.frame = [geometry, attributes, named, ...pictures].map(text);
    window.units = [slim.renderer.unit * slim.surface.scale, slim.canvas.width, slim.canvas.height];
  })()`);
  const parts = [];
  for (let k = 0; k < 3 + modes.length; ++k) parts.push(Buffer.from(await browser.evaluate(`frame[${k}]`), 'base64'));
  const units = await browser.evaluate('units');
  writeFileSync(out, Buffer.concat([Buffer.from(new Float64Array(units).buffer), ...parts]));
} catch (defect) {
  console.error(String(defect), browser.complaints.join('\n'));
  process.exitCode = 1;
} finally {
  await browser.close();
}
