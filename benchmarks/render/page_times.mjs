// SPDX-License-Identifier: BSD-3-Clause
// What a reader of pages waits for without a graphics card: node page_times.mjs CHROMIUM WIDTH HEIGHT PAGE...
// A line for each page: seconds until the first sharp picture, milliseconds of each of eight moves of a drag until its picture is
// seen (median, longest), seconds from the release until every pixel is drawn, and until it has all samples; share of the
// canvas's pixels along an axis at rest.
import {resolve} from 'node:path';
import {Browser} from '../../tests/web/browser.mjs';

const [chromium, width, height, ...pages] = process.argv.slice(2), MOVES = 8;
const browser = await Browser.launch(chromium, +width, +height);
const isAtRest = 'slim.resting && !slim.isMoving() && !slim.pending';
const seconds = async condition => {
  const begin = performance.now();
  await browser.until(condition, 300);
  return ((performance.now() - begin) / 1000).toFixed(1);
};
console.log('| page | first sharp, s | a move, ms: median | longest | sharp after, s | all samples after, s | pixels at rest |');
for (const page of pages) {
  await browser.send('Page.navigate', {url: 'about:blank'});
  await browser.open(resolve(page));
  const first = await seconds(`slim.sampled > 0 || ${isAtRest}`), [x, y] = [width / 2, height / 2], moves = [];
  await browser.mouse('mousePressed', x, y);
  for (let k = 1; k <= MOVES; ++k) {
    const begin = performance.now();
    await browser.mouse('mouseMoved', x + 12 * k, y + 6 * k);
    await browser.evaluate(`new Promise(done => {
      const tell = slim.onFrame;
      slim.onFrame = () => {
        tell();
        slim.onFrame = tell;
        slim.finish();
        requestAnimationFrame(() => setTimeout(done));
      };
      slim.wake();
    })`);
    moves.push(Math.round(performance.now() - begin));
  }
  await browser.mouse('mouseReleased', x + 12 * MOVES, y + 6 * MOVES);
  const begin = performance.now(), sharp = await seconds(`slim.sampled > 0 || ${isAtRest}`);
  await seconds(isAtRest);
  const all = ((performance.now() - begin) / 1000).toFixed(1), share = await browser.evaluate('slim.renderer.targets.width / slim.canvas.width');
  moves.sort((a, b) => a - b);
  console.log(`| ${page} | ${first} | ${moves[MOVES >> 1]} | ${moves[MOVES - 1]} | ${sharp} | ${all} | ${share.toFixed(2)} |`);
}
await browser.close();
