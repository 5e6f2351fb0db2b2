// SPDX-License-Identifier: BSD-3-Clause
// Pages without a graphics card: node software.mjs CHROMIUM PAGE MODE... prints what is wrong. In every mode what the processor
// traces is compared with what the shaders draw: the whole, with a level of detail, clipped in parallel projection.
import {Browser} from './browser.mjs';

const [chromium, page, ...modes] = process.argv.slice(2), browser = await Browser.launch(chromium, 200, 150);
const check = (name, holds, seen = '') => { if (!holds) console.log(`${name} ${JSON.stringify(seen)}`); };
const run = expression => browser.evaluate(expression);
const rest = () => browser.until('slim.resting && !slim.isMoving() && !slim.pending', 120);
const shows = () => run('[getComputedStyle(document.getElementById("canvas")).opacity, getComputedStyle(document.getElementById("still")).display]');

/** Pixels that differ by more than 1 of 255 between the shaders' frame and the tracer's, in each mode. */
const differences = lod => run(`(async () => {
  const {gl, renderer, canvas: {width, height}} = slim, shift = [0.25, -0.25];
  const pictures = () => ${JSON.stringify(modes)}.map(mode => {
    const bytes = new Uint8Array(4 * width * height);
    slim.mode = mode;
    slim.show(false);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes;
  });
  await slim.measure(width, height, shift, ${lod});
  const shaded = pictures();
  renderer.begin(slim.camera, width, height, shift, ${lod});
  for (const tile of renderer.tiles().filter(t => t.list.length)) {
    renderer.cut(tile);
    renderer.drawTile(tile, {painted: slim.surface.colored});
  }
  renderer.cut(null);
  return pictures().map((picture, k) => shaded[k].reduce((sum, byte, i) => sum + (Math.abs(byte - picture[i]) > 1), 0));
})()`);

try {
  await browser.open(page);
  check('it is a browser without a graphics card', await run('slim.software'));
  const seen = await shows();
  check('at first the still picture is seen', await run('slim.sampled > 0') || seen[0] === '0' && seen[1] !== 'none', seen);
  await rest();
  check('then the surface', `${await shows()}` === '1,none', await shows());
  check('with all samples of all pixels', await run('slim.sampled === 5 && slim.renderer.targets.width === slim.canvas.width'));
  const first = await browser.screenshot();
  await browser.key('ArrowLeft');
  await browser.until('!slim.resting', 10);
  await rest();
  check('a turn changes the picture', !first.equals(await browser.screenshot()));
  await browser.key('Home');
  await browser.until('!slim.resting', 10);
  await rest();
  check('a view has one picture', first.equals(await browser.screenshot()));
  await browser.send('Page.navigate', {url: 'about:blank'});
  await browser.open(page);
  await run('slim.moved()');
  await browser.until('document.body.classList.contains("drawn")', 10);
  await run('slim.tick = () => {}');
  for (const [name, lod, change] of [['whole', 0, ''], ['detail', 2, ''], ['clipped and parallel', 0, `
      slim.ui.setParallel(true);
      slim.ui.clip.set([100, 1000, 0, 800, 0, 700])`]]) {
    await run(change);
    (await differences(lod)).forEach((count, k) => check(`${name}, ${modes[k]}: as the shaders draw it`, count <= 12, count));
  }
  check('the page complains', browser.complaints.length === 0, browser.complaints);
} catch (defect) {
  console.log(String(defect.stack), browser.complaints);
} finally {
  await browser.close();
}
