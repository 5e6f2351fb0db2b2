// SPDX-License-Identifier: BSD-3-Clause
// A photograph of a page of pcl_slim_render after a click: node page_photograph.mjs CHROMIUM PAGE OUT.png WIDTH HEIGHT X Y
import {writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {Browser} from '../../tests/web/browser.mjs';

const [chromium, page, out, ...numbers] = process.argv.slice(2), [width, height, x, y] = numbers.map(Number);
const browser = await Browser.launch(chromium, width, height);
const rest = () => browser.until('slim.resting && !slim.isMoving() && !slim.pending', 300);
await browser.open(resolve(page));
// As with a graphics card: whole frames, however long a processor takes for them.
await browser.evaluate(`slim.patience = Infinity; slim.moved();
  document.getElementById('facts').textContent = document.getElementById('facts').textContent.split(';')[0]`);
await rest();
await browser.mouse('mousePressed', x, y);
await browser.mouse('mouseReleased', x, y);
await rest();
writeFileSync(out, await browser.screenshot());
await browser.close();
