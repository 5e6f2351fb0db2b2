// SPDX-License-Identifier: BSD-3-Clause
// What a reader does to a page, and what the page does then: node actions.mjs CHROMIUM PAGE
// PAGE shows a sphere of radius 1/4 about the origin by its normals. Prints what is wrong; nothing if all is well.
import {mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {Browser} from './browser.mjs';

const RADIUS = 0.25;
const [chromium, page] = process.argv.slice(2), folder = mkdtempSync(join(tmpdir(), 'pcl_slim_page_'));
const browser = await Browser.launch(chromium, 480, 360);
const check = (name, holds, seen = '') => { if (!holds) console.log(`${name} ${JSON.stringify(seen)}`); };
const near = (a, b, tolerance) => Math.abs(a - b) <= tolerance;
const run = expression => browser.evaluate(expression);
const rest = () => browser.until('slim.resting && !slim.isMoving() && !slim.pending');
const message = () => run('document.getElementById("message").hidden ? "" : document.getElementById("message").textContent');
const readout = () => run('document.getElementById("readout").hidden ? "" : document.getElementById("readout").innerText');
const position = () => run('slim.camera.position');
const hitAt = (x, y) => run(`slim.pick(${x}, ${y})?.point`);
const seenAt = point => run(`slim.camera.project([${point}], slim.canvas.clientWidth, slim.canvas.clientHeight)`);
const click = async (x, y, clickCount = 1) => {
  await browser.mouse('mousePressed', x, y, {clickCount});
  await browser.mouse('mouseReleased', x, y, {clickCount});
};
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

/** Acts and waits; says whether the canvas looks otherwise. */
async function changes(act) {
  const before = await browser.screenshot();
  await act();
  await rest();
  return !before.equals(await browser.screenshot());
}

async function turnAndZoom() {
  const pivot = await hitAt(200, 150), from = await position();
  check('a drag turns', await changes(async () => {
    await browser.mouse('mousePressed', 200, 150);
    for (const x of [220, 260]) await browser.mouse('mouseMoved', x, 165);
    await browser.mouse('mouseReleased', 260, 165);
  }));
  check('the point under the pointer stays', distance(await seenAt(pivot), [200, 150]) < 0.5, await seenAt(pivot));
  check('at its distance', near(distance(pivot, await position()), distance(pivot, from), 1e-9));

  const under = await hitAt(250, 160), away = distance(under, await position());
  check('the wheel zooms', await changes(() => browser.mouse('mouseWheel', 250, 160, {deltaX: 0, deltaY: -200})));
  check('to the point under it', distance(await seenAt(under), [250, 160]) < 0.5, await seenAt(under));
  check('nearer', distance(under, await position()) < 0.9 * away);

  const before = distance([0, 0, 0], await position());
  const touch = (type, gap) => browser.send('Input.dispatchTouchEvent',
    {type, touchPoints: gap ? [{x: 240 - gap, y: 180, id: 0}, {x: 240 + gap, y: 180, id: 1}] : []});
  check('a pinch zooms', await changes(async () => {
    await touch('touchStart', 80);
    for (const gap of [70, 55, 40]) await touch('touchMove', gap);
    await touch('touchEnd', 0);
  }));
  check('outwards', distance([0, 0, 0], await position()) > 1.3 * before, [before, await position()]);

  const side = await position();
  check('the right button moves', await changes(async () => {
    await browser.mouse('mousePressed', 240, 180, {button: 'right'});
    await browser.mouse('mouseMoved', 270, 180, {button: 'right'});
    await browser.mouse('mouseReleased', 270, 180, {button: 'right'});
  }) && distance(side, await position()) > 0.01);
}

async function pressKeys() {
  await browser.key('Home');
  await rest();
  const at = await position();
  for (const key of ['ArrowLeft', 'ArrowUp', '+', '3']) check(`${key} acts`, await changes(() => browser.key(key)));
  check('3 chooses the mean curvature', await run('document.getElementById("mode").value') === 'mean');
  check('and shows its range', await run('!document.getElementById("scale").hidden'));
  const sphere = await run('slim.range()');
  check('which is that of the sphere', near(sphere[1], 1 / RADIUS, 0.1), sphere);
  check('the slider widens it', await changes(() => run(`(() => {
    const slider = document.getElementById('range');
    slider.value = 2;
    slider.dispatchEvent(new Event('input'));
  })()`)) && near((await run('slim.range()'))[1], 4 / RADIUS, 0.4));
  await browser.key('2');
  await browser.key('Home');
  await rest();
  check('Home is where it began', distance(at, await position()) === 0, await position());
}

async function readAndMeasure() {
  await click(230, 170);
  const said = await readout(), numbers = name => said.split('\n').find(l => l.startsWith(name))?.match(/-?[\d.]+(e-?\d+)?/g).map(Number) || [];
  check('a click reads a point of the sphere', near(Math.hypot(...numbers('Position')), RADIUS, 1e-4), said);
  check('its normal', near(numbers('Normal').reduce((sum, n, k) => sum + n * numbers('Position')[k] / RADIUS, 0), 1, 1e-3), said);
  check('its curvatures', numbers('Principal').every(k => near(k, 1 / RADIUS, 0.05)) && numbers('Principal').length === 2, said);
  check('and their means', near(numbers('Mean')[0], 1 / RADIUS, 0.05) && near(numbers('Gaussian')[0], 1 / RADIUS ** 2, 0.3), said);
  await click(5, 5);
  check('a click beside it clears', await readout() === '');

  await browser.key('m');
  const ends = [await hitAt(200, 150), await hitAt(280, 200)], truth = await run(`slim.surface.scale * ${distance(...ends)}`);
  for (const place of [[200, 150], [280, 200]]) await click(...place);
  check('two clicks measure', near(Number((await readout()).match(/[\d.]+/)?.[0]), truth, 1e-4 * truth), await readout());
  check('with a mark at each end', await run('document.querySelectorAll("#marks circle").length') === 2);
  await browser.key('Escape');
  await browser.key('m');

  const middle = await hitAt(260, 200);
  for (const nth of [1, 2]) await click(260, 200, nth);
  await rest();
  check('a double click centres', distance(await seenAt(middle), [240, 180]) < 0.5, await seenAt(middle));
  await browser.key('Escape');
}

async function save() {
  await browser.send('Browser.setDownloadBehavior', {behavior: 'allow', downloadPath: folder});
  await run('document.getElementById("save").click()');
  for (let k = 0; k < 100 && !readdirSync(folder).some(f => f.endsWith('.png')); ++k) {
    await new Promise(done => setTimeout(done, 50));
  }
  const png = readdirSync(folder).find(f => f.endsWith('.png'));
  check('Save writes a PNG', png && readFileSync(join(folder, png)).subarray(1, 4).toString() === 'PNG');
}

async function looks() {
  await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: 'dark'}]});
  await browser.until('slim.dark', 10);
  await rest();
  const corner = await run(`(() => {
    slim.show(false);
    const p = new Uint8Array(4);
    slim.gl.readPixels(2, 100, 1, 1, slim.gl.RGBA, slim.gl.UNSIGNED_BYTE, p);
    return p[0];
  })()`);
  check('a dark screen has a dark background', corner < 80, corner);
  await browser.resize(360, 640, 2, true);
  await new Promise(done => setTimeout(done, 300));
  await rest();
  const outside = await run(`[...document.querySelectorAll('footer *, h1')].filter(e => {
    const box = e.getBoundingClientRect();
    return box.width && (box.left < 0 || box.right > 360 || box.bottom > 640);
  }).map(e => e.id || e.tagName)`);
  check('everything is on a phone of 360 pixels', outside.length === 0, outside);
  const names = await run(`[...document.querySelectorAll('button, select, input, canvas')].filter(e =>
    !(e.getAttribute('aria-label') || e.textContent.trim())).map(e => e.id)`);
  check('every control has a name', names.length === 0, names);
  await browser.resize(480, 360);
}

/** What a page says that is not as it was written. */
async function sayOf(text) {
  const path = join(folder, 'damaged.html');
  writeFileSync(path, text);
  await browser.open(path);
  return message();
}

async function damage() {
  const text = readFileSync(page, 'utf8'), data = text.indexOf('id="data">'), viewer = text.indexOf('id="viewer">');
  for (const end of [viewer + 500, data + 500, text.length - 200]) {
    check(`a page cut at ${end}`, /damaged or was cut off/.test(await sayOf(text.slice(0, end))), await message());
  }
  for (const at of [viewer + 3000, data + 900, data + 2000]) {
    const other = text[at] === 'A' ? 'B' : 'A';
    check(`a byte changed at ${at}`, /damaged/.test(await sayOf(text.slice(0, at) + other + text.slice(at + 1))), await message());
  }
  check('the whole page says nothing', await sayOf(text) === '', await message());
  await browser.send('Page.addScriptToEvaluateOnNewDocument', {source: 'HTMLCanvasElement.prototype.getContext = () => null'});
  check('no WebGL 2', /no WebGL 2/.test(await sayOf(text)), await message());
  check('leaves a still picture', await run('getComputedStyle(document.getElementById("still")).display') !== 'none');
}

try {
  await browser.open(page);
  await run('Object.assign(slim, {finest: 0.4, samples: 0}).moved()');
  await rest();
  check('the page says something', await message() === '', await message());
  for (const step of [turnAndZoom, pressKeys, readAndMeasure, save, looks, damage]) await step();
  const left = browser.requests.filter(url => !/^(file|data|blob):/.test(url));
  check('requests leave the page', left.length === 0, left);
  check('the page complains', browser.complaints.length === 0, browser.complaints);
} catch (defect) {
  console.log(String(defect.stack), browser.complaints);
} finally {
  await browser.close();
  rmSync(folder, {recursive: true, force: true});
}
