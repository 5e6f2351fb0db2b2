// SPDX-License-Identifier: BSD-3-Clause
// Every control of a page in a wide and in a narrow window: node controls.mjs CHROMIUM SURFACE_PAGE SPLAT_PAGE
// SURFACE_PAGE shows a sphere of 250 m about (431000, 5812000, 300), z up, diagonal 1000 m, seen obliquely, by its
// radii of balls, and a ring of lines around it. SPLAT_PAGE shows discs on a sphere of radius 1/4 about the origin.
// Prints what is wrong; nothing if all is well.
import {Browser} from './browser.mjs';
import {checkLayout, checkTargets, checkTabs} from './layout.mjs';

const CENTER = [431000, 5812000, 300], RADIUS = 250;
const [chromium, page, splatPage] = process.argv.slice(2), browser = await Browser.launch(chromium, 1200, 800);
let where = '';
const check = (name, holds, seen = '') => { if (!holds) console.log(`${where}: ${name} ${JSON.stringify(seen)}`); };
const near = (a, b, tolerance) => [a].flat().length === [b].flat().length && [a].flat().every((x, k) => Math.abs(x - [b].flat()[k]) <= tolerance);
const run = expression => browser.evaluate(expression);
/** Lets the page come to rest at once. */
const rest = () => run(`new Promise(done => {
  const look = () => { slim.lastMove = Math.min(slim.lastMove, performance.now() - 1000); slim.resting && !slim.pending ? done() : setTimeout(look, 4); };
  look();
})`);
const press = key => browser.key(key);
const text = id => run(`document.getElementById('${id}').hidden ? '' : document.getElementById('${id}').innerText`);
const push = id => run(`document.getElementById('${id}').click()`);
const size = () => run('[slim.canvas.clientWidth, slim.canvas.clientHeight]');
const seenAt = point => run(`slim.camera.project(slim.local([${point}]), slim.canvas.clientWidth, slim.canvas.clientHeight)`);
const click = async ([x, y]) => {
  for (const type of ['mousePressed', 'mouseReleased']) await browser.mouse(type, x, y);
};
const picture = async () => {
  await rest();
  return (await browser.screenshot()).toString('base64');
};
const minus = (a, b) => a.map((x, k) => x - b[k]), dot = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const distance = (a, b) => Math.hypot(...minus(a, b));
const slide = (selector, value) => run(`(slider => { slider.value = ${value}; slider.dispatchEvent(new Event('input')); })(document.querySelector('${selector}'))`);

async function open(path, width, height, hash = '') {
  await browser.send('Page.navigate', {url: 'about:blank'});
  await browser.resize(width, height);
  await browser.open(path, hash);
  // The same frame for the same view, whatever the machine does: pictures are compared.
  await run('Object.assign(slim, {finest: 0.12, samples: 0, drawCoarse() { this.work = null; }}).moved()');
  await rest();
}

/** Where the ray through a place of the canvas meets the sphere, by the camera's numbers alone. */
async function onSphere([x, y]) {
  const {position, target, up, fov, pixel, w, h} = await run(`({...slim.camera, position: slim.world(slim.camera.position),
    target: slim.world(slim.camera.target), pixel: slim.camera.pixel(...[slim.canvas.clientWidth, slim.canvas.clientHeight]),
    w: slim.canvas.clientWidth, h: slim.canvas.clientHeight})`);
  const unit = v => v.map(c => c / Math.hypot(...v)), cross = (a, b) => [0, 1, 2].map(k => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
  const forward = unit(minus(target, position)), right = unit(cross(forward, up)), top = cross(right, forward);
  const d = unit(forward.map((f, k) => f + pixel * ((x - w / 2) * right[k] + (h / 2 - y) * top[k])));
  const from = minus(position, CENTER), b = dot(from, d), t = -b - Math.sqrt(b * b - dot(from, from) + RADIUS ** 2);
  return position.map((p, k) => p + t * d[k]);
}

const VIEWS = {  // key, what is towards the viewer and what is up, z being upwards
  front: ['f', [0, -1, 0], [0, 0, 1]], back: ['b', [0, 1, 0], [0, 0, 1]], left: ['l', [-1, 0, 0], [0, 0, 1]],
  right: ['r', [1, 0, 0], [0, 0, 1]], top: ['t', [0, 0, 1], [0, 1, 0]], bottom: ['u', [0, 0, -1], [0, -1, 0]],
};

async function views() {
  const [w, h] = await size();
  let before = await picture();
  for (const [name, [key, eye, up]] of Object.entries(VIEWS)) {
    await press('Home');
    const looks = async () => (await run('[slim.camera.axes()[2].map(x => -x), slim.camera.up]'));
    await press(key);
    check(`key ${key} looks from ${name}`, near((await looks()).flat(), [...eye, ...up], 1e-9), await looks());
    const ends = await Promise.all([0, 1, 2].flatMap(k => [-1, 1].map(s => seenAt(CENTER.map((c, i) => c + (i === k ? s * RADIUS : 0))))));
    const [xs, ys] = [0, 1].map(k => ends.map(p => p[k])), wide = Math.max(...xs) - Math.min(...xs), tall = Math.max(...ys) - Math.min(...ys);
    check(`${name} shows all`, Math.min(...xs, ...ys) > 0 && Math.max(...xs) < w && Math.max(...ys) < h, ends);
    check(`${name} fills the window`, wide > 0.7 * w || tall > 0.45 * h, [wide, tall]);
    await press('Home');
    await push(`from-${name}`);
    check(`the button looks from ${name}`, near((await looks()).flat(), [...eye, ...up], 1e-9), await looks());
    check(`another picture from ${name}`, before !== (before = await picture()));
  }
  await push('home');
  check('Reset is the first view', await run('JSON.stringify(slim.camera) === JSON.stringify(slim.home)'));
}

async function projection() {
  const middle = (await size()).map(x => x / 2), hit = await run(`slim.world(slim.pick(${middle}).point)`);
  const aside = await run('slim.camera.axes()[0]'), ends = [hit, hit.map((x, k) => x + 50 * aside[k])];
  const ofEnds = async () => (await Promise.all(ends.map(seenAt))).flat();
  const places = await ofEnds(), from = await run('slim.camera.position'), before = await picture();
  await press('o');
  check('o is parallel projection', await run('slim.camera.height > 0 && document.getElementById("parallel").ariaPressed === "true"'));
  check('with what is at the pivot as large', near(await ofEnds(), places, 0.01), [await ofEnds(), places]);
  check('and another picture', before !== await picture());
  await bar('parallel');
  const far = ends.map(p => p.map((x, k) => x - 3 * (p[k] - CENTER[k])));
  check('depth has no effect', near(distance(...await Promise.all(far.map(seenAt))) / distance(...far), distance(places.slice(0, 2), places.slice(2)) / 50, 1e-3));
  await push('parallel');
  check('and back', await run('slim.camera.height === 0') && near(await run('slim.camera.position'), from, 1e-6), [from, await run('slim.camera.position')]);
}

/** The scale bar's length in pixels against two points as far apart, where the picture's middle is. */
async function bar(name) {
  await rest();
  const middle = (await size()).map(x => x / 2), hit = await run(`slim.world((slim.pick(${middle})?.point || slim.middle()))`);
  const [right, words] = await run('[slim.camera.axes()[0], document.getElementById("bar").textContent]'), length = parseFloat(words);
  const pixels = distance(...await Promise.all([hit, hit.map((x, k) => x + length * right[k])].map(seenAt)));
  const drawn = await run('document.getElementById("bar").getBoundingClientRect().width');
  check(`the scale bar is right in ${name}`, near(pixels, drawn, 0.05), [pixels, drawn]);
  check(`round, with its unit, in ${name}`, /^[125]0* m$/.test(words) && drawn > 40 && drawn < 140, words);
}

async function axes(name) {
  await rest();
  const [right, up] = await run('slim.camera.axes()');
  const lines = await run('[...document.querySelectorAll("#axes path")].map(p => [p.className.baseVal, ...p.getAttribute("d").match(/L(\\S+) (\\S+)/).slice(1).map(Number)])');
  for (const [axis, x, y] of lines) {
    const k = 'xyz'.indexOf(axis), length = Math.hypot(right[k], up[k]);
    check(`the ${axis} axis points along ${axis} ${name}`, near([x, -y], [24 * right[k], 24 * up[k]], 1e-6) || length < 1e-6, [x, y]);
  }
  check(`three axes ${name}`, lines.length === 3, lines);
  return JSON.stringify(lines);
}

async function measures() {
  const [w, h] = await size(), at = (x, y) => [Math.round(w / 2 + x), Math.round(h / 2 + y)];
  const pairs = [[at(-50, -40), at(40, 30)], [at(-20, 60), at(55, -65)]], ends = [], truths = [];
  await push('measure');
  for (const [a, b] of pairs) {
    ends.push(await onSphere(a), await onSphere(b));
    truths.push(distance(...ends.slice(-2)));
    await click(a);
    await click(b);
    check('a distance is read out', near(parseFloat((await text('readout')).replace('Distance ', '')), truths.at(-1), 0.3), [await text('readout'), truths]);
  }
  const labels = async () => {
    await rest();
    return run('[...document.querySelectorAll("#marks text")].map(t => [t.textContent, +t.getAttribute("x"), +t.getAttribute("y")])');
  };
  const check2 = async when => {
    const seen = await labels();
    check(`two distances ${when}`, seen.length === 2, seen);
    for (const [k, [words, x, y]] of seen.entries()) {
      const [a, b] = await Promise.all(ends.slice(2 * k, 2 * k + 2).map(seenAt)), middle = a.map((c, i) => (c + b[i]) / 2);
      check(`label ${k + 1} is exact, in cm, with the unit ${when}`, near(Number(/^\d: (\d+\.\d\d) m$/.exec(words)?.[1]), truths[k], 0.3), [words, truths[k]]);
      check(`label ${k + 1} is at its line ${when}`, near([x, y], [middle[0], middle[1] - 8], 1) || near([x, y], [middle[0], middle[1] + 9], 1), [x, y, middle]);
    }
  };
  await check2('at first');
  await press('m');
  check('m ends measuring', await run('!slim.ui.measuring'));
  await press('ArrowLeft');
  await check2('after a turn');
  check('the list names both', /\d+\.\d\d m[^]*\d+\.\d\d m/.test(await text('measures')), await text('measures'));
  await click(at(0, 0));
  check('a click reads a point beside them', /Position/.test(await text('readout')) && (await labels()).length === 2);
  await run('document.querySelector("#pairs button").click()');
  check('one is removed', (await labels()).length === 1 && near(parseFloat((await labels())[0][0].slice(3)), truths[1], 0.3), await labels());
  await press('Delete');
  check('Delete removes the last', (await labels()).length === 0 && await text('measures') === '');
  await push('measure');
  for (const place of pairs.flat()) await click(place);
  await push('clear');
  check('all are removed', (await labels()).length === 0 && await run('document.querySelectorAll("#marks circle").length') === 0);
  await press('Escape');
  await press('m');
}

/** Whether what is drawn and what is picked are in the clipping box, and agree. */
async function clipped(name, slack = 0.03) {
  await rest();
  const {drawn, picked, both, outside} = await run(`(async () => {
    const slack = slim.isSplats ? 0.005 : 1e-5;
    const w = 80, h = 60, {geometry, unit} = await slim.measure(w, h), [low, high] = slim.rules.clip || slim.surface.bounds.box;
    const count = {drawn: 0, picked: 0, both: 0, outside: 0}, canvas = [slim.canvas.clientWidth, slim.canvas.clientHeight];
    const cast = slim.pick.bind({...slim, camera: slim.camera, canvas: {clientWidth: w, clientHeight: h}});
    for (let k = 0; k < w * h; ++k) {
      const depth = Math.abs(geometry[4 * k + 3]) * unit, [from, d] = slim.camera.ray(k % w + 0.5, Math.floor(k / w) + 0.5, w, h);
      const hit = cast(k % w + 0.5, Math.floor(k / w) + 0.5), points = [...depth ? [from.map((x, i) => x + depth * d[i])] : [], ...hit ? [hit.point] : []];
      count.drawn += depth > 0;
      count.picked += !!hit;
      count.both += depth > 0 && !!hit && Math.abs(hit.depth - depth) < 0.02;
      count.outside += points.some(p => p.some((x, i) => x < low[i] - slack || x > high[i] + slack));
    }
    return count;
  })()`);
  check(`${name}: nothing outside the box`, outside === 0, outside);
  check(`${name}: picture and picking agree`, both > 100 && drawn - both < slack * both + 4 && picked - both < slack * both + 4, [drawn, picked, both]);
  return drawn;
}

async function clip(isSurface) {
  await press('Home');
  const slack = isSurface ? 0.03 : 0.12;  // discs are blended in the picture
  const whole = await clipped('without a box', slack), middle = (await size()).map(x => x / 2);
  await run('slim.moved()');
  const before = await picture(), lines = await run('slim.renderer.lines.list.length'), near = await run(`slim.pick(${middle}).depth`);
  await push('clip');
  check('k and the button open the panel', await run('!document.getElementById("box").hidden && document.querySelectorAll("path.box").length === 1'));
  check('with six sliders', await run('document.querySelectorAll("#box input").length') === 6);
  for (const [k, value] of [[0, 300], [3, 450], [5, 600]]) {
    const old = await picture();
    await slide(`#box label:nth-of-type(${k + 1}) input`, value);
    check(`slider ${k} changes the picture`, old !== await picture());
  }
  const depths = await run(`[slim.pick(${middle})?.depth]`);
  check('what is clipped is not picked', depths[0] !== near, [depths, near]);
  check('less is drawn', await clipped('in a box', slack) < 0.9 * whole, whole);
  if (isSurface) {
    check('lines are clipped, too', await run('slim.renderer.lines.list.length') < 0.8 * lines && lines > 0, lines);
    await press('o');
    await clipped('in a box, parallel');
    await press('o');
    await slide('#box label:nth-of-type(1) input', 999);
    await slide('#box label:nth-of-type(2) input', 0);
    check('sliders stop at each other', await run('slim.ui.clip.values.slice(0, 2).join()') === '999,1000', await run('slim.ui.clip.values'));
  }
  await push('unclip');
  await press('k');
  check('Show all shows all', before === await picture() && await run('slim.rules.clip === null && slim.renderer.lines.list.length') === lines);
}

async function legend() {
  await press('Home');
  for (const [mode, title] of [['mean', /^Mean curvature \(1\/m\)$/], ['gauss', /^Gaussian curvature \(1\/m²\)$/], ['size', /^Radius of balls \(m\)$/], ['level', /^Level$/]]) {
    await run(`(select => { select.value = '${mode}'; select.dispatchEvent(new Event('change')); })(document.getElementById('mode'))`);
    const {ticks, low, high, caption} = await run(`({ticks: [...document.querySelectorAll('#ticks span')].map(t => [Number(t.textContent), parseFloat(t.style.left) / 100]),
      low: slim.range()[0], high: slim.range()[1], caption: document.getElementById('caption').textContent})`);
    check(`${mode} has its name and unit`, title.test(caption), caption);
    check(`${mode} has three to six numbers`, ticks.length >= 3 && ticks.length <= 6, ticks);
    const share = x => mode === 'size' ? Math.log(x / low) / Math.log(high / low) : mode === 'level' ? (x + 0.5 - Math.round(low + 0.5)) / (high - low) : (x - low) / (high - low);
    check(`${mode}'s numbers are at their colours`, ticks.every(([x, at]) => near(share(x), at, 1e-3) && at >= 0 && at <= 1), [ticks, low, high]);
    check(`${mode}'s numbers are round`, ticks.every(([x]) => x === 0 || Number(x.toPrecision(2)) === x), ticks);
  }
  const before = await run('slim.range()');
  await press('7');
  await press('3');
  await slide('#range', 1);
  check('the slider widens the range', await run('slim.mode === "mean" && slim.spread === 2') && before.length === 2);
}

async function readout() {
  await press('Escape');
  await click((await size()).map(x => Math.round(x / 2)));
  const words = await text('readout'), row = name => words.split('\n').find(line => line.startsWith(name)) || '';
  check('a UTM position is read to the centimetre', /43\d{4}\.\d\d  5\d{6}\.\d\d  \d+\.\d\d m$/.test(row('Position')), words);
  check('curvatures have four digits and their unit', /0?\.?00\d{1,5} .*1\/m$|e-\d .*1\/m$/.test(row('Principal')) && / 1\/m²$/.test(row('Gaussian')), words);
  check('lengths have their unit', / m$/.test(row('Distance')) && / m$/.test(row('Ball')), words);
}

async function keysWithoutClick(path, width, height) {
  await open(path, width, height);
  check('nothing has the focus', await run('document.activeElement === document.body'));
  check('the address is as it was opened', await run('location.hash') === '');
  const azimuth = () => run('(f => Math.atan2(f[1], f[0]))(slim.camera.axes()[2])');
  const steps = [];
  for (const focus of ['0', 'document.getElementById("canvas").focus()', 'document.getElementById("view").focus()']) {
    await run(focus);
    const from = await azimuth();
    await press('ArrowLeft');
    steps.push(await azimuth() - from);
  }
  check('keys act once, without a click, wherever the focus is', steps.every(s => near(s, 0.09, 1e-6)), steps);
  await press('v');
  check('v opens the views', await run('!document.getElementById("views").hidden'));
  await press('?');
  check('? opens the help alone', await run('!document.getElementById("keys").hidden && document.getElementById("views").hidden'));
  await press('Escape');
  check('Escape closes it', await run('document.getElementById("keys").hidden'));
  await press('m');
  check('m measures', await run('slim.ui.measuring && document.getElementById("measure").ariaPressed === "true"'));
  await press('m');
  await press('k');
  const before = await run('JSON.stringify([slim.camera, slim.mode])');
  await run('document.querySelector("#box input").focus()');
  for (const key of ['ArrowLeft', 'm', 'f', '4']) await browser.key(key);
  check('an input keeps its keys', await run('JSON.stringify([slim.camera, slim.mode])') === before && await run('!slim.ui.measuring'));
  await press('Escape');
  check('but Escape', await run('document.getElementById("box").hidden'));
  await run('document.activeElement.blur()');
}

async function link(path, width, height) {
  await run('slim.ui.measures.set([])');
  await press('r');
  for (const key of ['ArrowUp', 'ArrowUp', '+', 'o', '3']) await press(key);
  await slide('#range', 1.5);
  await run('slim.ui.clip.set([0, 1000, 100, 900, 0, 750])');
  await push('measure');
  const [w, h] = await size();
  for (const place of [[w / 2 - 30, h / 2], [w / 2 + 30, h / 2 + 20]]) await click(place);
  await press('m');
  const state = () => run(`({eye: slim.world(slim.camera.position), at: slim.world(slim.camera.target), up: slim.camera.up, more: [slim.camera.fov,
    slim.camera.height, slim.camera.aspect], mode: slim.mode, spread: slim.spread, clip: slim.ui.clip.values.join(), box: slim.rules.clip?.flat(),
    pairs: slim.ui.measures.pairs.flat().map(p => slim.world(p)).flat(), pressed: document.getElementById('parallel').ariaPressed})`);
  const was = await state();
  await browser.until('location.hash.includes("measure=")', 10);
  const hash = await run('location.hash');
  const same = (a, b) => near(a.eye, b.eye, 1e-4) && near(a.at, b.at, 1e-4) && near(a.up, b.up, 2e-6) && near(a.more, b.more, 1e-6) && a.mode === b.mode &&
    a.spread === b.spread && a.clip === b.clip && near(a.box, b.box, 1e-9) && near(a.pairs, b.pairs, 1e-4) && a.pressed === b.pressed;
  await browser.send('Browser.grantPermissions', {permissions: ['clipboardReadWrite', 'clipboardSanitizedWrite']});
  await browser.send('Emulation.setFocusEmulationEnabled', {enabled: true});
  await push('link');
  await browser.until('/copied/.test(document.getElementById("readout").textContent)', 10);
  check('Link copies the address', await run('navigator.clipboard.readText()') === await run('location.href'));
  await open(path, width, height, hash);
  check('a link restores the view', same(was, await state()), [was, await state()]);
  check('and its legend and marks', await run('document.getElementById("range").value === "1.5" && document.querySelectorAll("#marks text").length === 1'));
  await open(path, width, height);
  check('without it the page opens as always', !same(was, await state()));
  await run(`location.hash = ${JSON.stringify(hash)}`);
  await browser.until('slim.mode === "mean"', 10);
  check('a link pasted into the open page restores it', same(was, await state()), [was, await state()]);
  for (const damaged of ['#eye=1,2', '#eye=a,b,c&at=1,2,3&up=0,0,1', '#%%%', '#clip=1,2,3,4,5,6']) {
    await run(`location.hash = '${damaged}'`);
    await new Promise(done => setTimeout(done, 20));
    check(`${damaged} changes nothing`, same(was, await state()), await state());
  }
  await open(path, width, height, '#still');
  check('#still shows the picture alone', await run('["top", "bottom", "marks"].every(id => getComputedStyle(document.getElementById(id)).display === "none")'));
  await press('ArrowLeft');
  await new Promise(done => setTimeout(done, 400));
  check('and keeps its address', await run('location.hash') === '#still');
}

try {
  for (const [width, height] of [[1200, 800], [400, 800]]) {
    where = `${width} x ${height}`;
    await keysWithoutClick(page, width, height);
    await views();
    await bar('perspective');
    const oblique = await axes('at first');
    await press('t');
    check('the axes turn with the view', oblique !== await axes('from the top'));
    await press('Home');
    await projection();
    await measures();
    await clip(true);
    await legend();
    await readout();
    await checkLayout(browser, check, width, height);
    await checkTargets(browser, check);
    await checkTabs(browser, check);
    if (width > 500) await link(page, width, height);
    await open(splatPage, width, height);
    where += ', splats';
    await clip(false);
  }
  check('the page complains', browser.complaints.length === 0, browser.complaints);
} catch (defect) {
  console.log(where, String(defect.stack), browser.complaints);
} finally {
  await browser.close();
}
