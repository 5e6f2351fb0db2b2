// SPDX-License-Identifier: BSD-3-Clause
// A photograph of a page of pcl_slim_render after keys and clicks:
// node page_photograph.mjs CHROMIUM PAGE OUT.png WIDTH HEIGHT STEP..., a step being a key or a place X,Y to click.
import {writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {Browser} from '../../tests/web/browser.mjs';

const [chromium, page, out, width, height, ...steps] = process.argv.slice(2);
const browser = await Browser.launch(chromium, +width, +height);
const rest = () => browser.until('slim.resting && !slim.isMoving() && !slim.pending', 300);
await browser.open(resolve(page));
await browser.evaluate(`document.getElementById('facts').textContent = document.getElementById('facts').textContent.split(';')[0]`);
await rest();
for (const step of steps) {
  const [x, y] = step.split(',').map(Number);
  if (y >= 0) for (const type of ['mousePressed', 'mouseReleased']) await browser.mouse(type, x, y);
  else await browser.key(step);
}
await rest();
writeFileSync(out, await browser.screenshot());
await browser.close();
