// SPDX-License-Identifier: BSD-3-Clause
// Pages without a graphics card: node software.mjs CHROMIUM PAGE MODE... prints what is wrong. In every mode what the processor
// traces is compared with what the shaders draw.
import {Browser} from './browser.mjs';

const [chromium, page, ...modes] = process.argv.slice(2), browser = await Browser.launch(chromium, 200, 150);
const check = (name, holds, seen = '') => { if (!holds) console.log(`${name} ${JSON.stringify(seen)}`); };
const run = expression => browser.evaluate(expression);
const rest = () => browser.until('slim.resting && !slim.isMoving() && !slim.pending', 120);
const shows = () => run('[getComputedStyle(document.getElementById("canvas")).opacity, getComputedStyle(document.getElementById("still")).display]');

/** Pixels that differ between the shaders' frame and the tracer's, by their largest channel: 0, 1, 2, more. */
const differences = (mode, lod) => run(`(async () => {
  const {gl, renderer, canvas: {width, height}} = slim;
  slim.mode = '${mode}';
  const picture = () => {
    const bytes = new Uint8Array(4 * width * height);
    slim.show(false);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes;
  };
  await slim.measure(width, height, [0.25, -0.25], ${lod});
  const shaded = picture();
  renderer.begin(slim.camera, width, height, [0.25, -0.25], ${lod});
  for (const tile of renderer.tiles().filter(t => t.list.length)) {
    renderer.cut(tile);
    renderer.drawTile(tile, slim.look());
  }
  renderer.cut(null);
  const traced = picture(), counts = [0, 0, 0, 0];
  for (let i = 0; i < traced.length; i += 4) {
    ++counts[Math.min(3, Math.max(...[0, 1, 2].map(c => Math.abs(traced[i + c] - shaded[i + c]))))];
  }
  return counts;
})()`);

try {
  await browser.open(page);
  check('it is a browser without a graphics card', await run('slim.software'));
  check('at first the still picture is seen', await run('slim.sampled > 0') || `${await shows()}` === '0,block' || `${await shows()}` === '0,inline', await shows());
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
  for (const mode of modes) {
    for (const lod of [0, 2]) {
      const [, , two, more] = await differences(mode, lod);
      check(`${mode}, detail ${lod}: as the shaders draw it`, two + more <= 6, [two, more]);
    }
  }
  const complaints = browser.complaints.filter(c => !/ReadPixels|GPU stall/.test(c));
  check('the page complains', complaints.length === 0, complaints);
} catch (defect) {
  console.log(String(defect.stack), browser.complaints);
} finally {
  await browser.close();
}
