// SPDX-License-Identifier: BSD-3-Clause
// Where a page's controls are: inside the window, apart, large enough for fingers, and within reach of the Tab key.

const BLOCKS = ['title', 'readout', 'measures', 'axes', 'bar', 'views', 'box', 'keys'];
const PANELS = {'': 'none', v: 'views', k: 'clipping box', '?': 'help'};

/** What is outside the window, or over something else. */
const DEFECTS = `(() => {
  const seen = e => e && e.getClientRects().length && getComputedStyle(e).visibility !== 'hidden' && (b => b.width > 0 && b)(e.getBoundingClientRect());
  const blocks = [${BLOCKS.map(id => `'${id}'`)}].map(id => document.getElementById(id)).concat(document.querySelector('footer')).filter(seen);
  const controls = [...document.querySelectorAll('footer > *')].filter(seen), ticks = [...document.querySelectorAll('#ticks span')].filter(seen), found = [];
  const name = e => e.id || e.textContent || e.tagName;
  for (const group of [blocks, controls, ticks, [...document.querySelectorAll('#views > *, #box input, #box button')].filter(seen)]) {
    group.forEach((a, i) => {
      const p = a.getBoundingClientRect();
      if (p.left < 0 || p.top < 0 || p.right > innerWidth || p.bottom > innerHeight) found.push(name(a) + ' is outside');
      for (const b of group.slice(i + 1)) {
        const q = b.getBoundingClientRect();
        if (p.left < q.right - 0.5 && q.left < p.right - 0.5 && p.top < q.bottom - 0.5 && q.top < p.bottom - 0.5) found.push(name(a) + ' is over ' + name(b));
      }
    });
  }
  return found;
})()`;

const VISIBLE = `[...document.querySelectorAll('button, select, input')].filter(e => e.getClientRects().length && !e.disabled)`;

/** Blocks and controls in all states: nothing overlaps, light and dark. */
export async function checkLayout(browser, check, width, height) {
  const run = expression => browser.evaluate(expression);
  await browser.key('Escape');
  await run(`slim.ui.measures.set([[[0, 0, 0.25], [0.25, 0, 0]], [[0, 0.25, 0], [0.25, 0, 0]]]); slim.ui.setMode('size')`);
  for (const scheme of ['dark', 'light']) {
    await browser.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: scheme}]});
    const [ink, paper] = await run(`[getComputedStyle(document.body).color, getComputedStyle(document.body).backgroundColor].map(c => +c.match(/\\d+/)[0])`);
    check(`${scheme} has contrast`, scheme === 'dark' ? ink > paper + 120 : paper > ink + 120, [ink, paper]);
    for (const [key, panel] of Object.entries(PANELS)) {
      if (key) await browser.key(key);
      await run(`slim.ui.read(${width / 2}, ${height / 2})`);
      const defects = await run(DEFECTS);
      check(`with panel ${panel}, ${scheme}`, defects.length === 0, defects);
      await browser.key('Escape');
    }
  }
}

/** Controls on a touch screen are at least 44 pixels wide and high. */
export async function checkTargets(browser, check) {
  await browser.send('Emulation.setTouchEmulationEnabled', {enabled: true});
  check('the screen is one for fingers', await browser.evaluate('matchMedia("(pointer: coarse)").matches'));
  for (const [key, panel] of Object.entries(PANELS)) {
    if (key) await browser.key(key);
    const small = await browser.evaluate(`${VISIBLE}.map(e => [e.id || e.ariaLabel, e.getBoundingClientRect()])
      .filter(([, b]) => b.width < 44 || b.height < 44).map(([id, b]) => [id, b.width, b.height])`);
    check(`targets of 44 pixels with panel ${panel}`, small.length === 0, small);
    await browser.key('Escape');
  }
  await browser.send('Emulation.setTouchEmulationEnabled', {enabled: false});
}

/** The Tab key comes to every control; each has a name. */
export async function checkTabs(browser, check) {
  const run = expression => browser.evaluate(expression), name = '(e => e.id || e.ariaLabel || e.textContent)';
  for (const [key, panel] of Object.entries(PANELS)) {
    if (key) await browser.key(key);
    const all = await run(`${VISIBLE}.map(${name})`), reached = new Set();
    await run('document.activeElement.blur()');
    for (let k = 0; k < all.length + 4; ++k) {
      for (const type of ['rawKeyDown', 'keyUp']) await browser.send('Input.dispatchKeyEvent', {type, key: 'Tab', code: 'Tab', windowsVirtualKeyCode: 9});
      reached.add(await run(`${name}(document.activeElement)`));
    }
    check(`Tab reaches everything with panel ${panel}`, all.every(id => reached.has(id)), all.filter(id => !reached.has(id)));
    const nameless = await run(`${VISIBLE}.filter(e => !(e.ariaLabel || e.textContent.trim())).map(e => e.id)`);
    check(`everything has a name with panel ${panel}`, nameless.length === 0, nameless);
    await run('document.activeElement.blur()');
    await browser.key('Escape');
  }
}
