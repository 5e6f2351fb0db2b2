// SPDX-License-Identifier: BSD-3-Clause
// Drives a Chromium over its pipe: no packages. Messages of the DevTools protocol, each ended by a zero byte.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

const FLAGS = ['--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
  '--hide-scrollbars', '--remote-debugging-pipe'];

export class Browser {
  static async launch(chromium, width, height) {
    const browser = new Browser();
    browser.home = mkdtempSync(join(tmpdir(), 'pcl_slim_web_'));
    browser.process = spawn(chromium, [...FLAGS, `--window-size=${width},${height}`, `--user-data-dir=${browser.home}`,
      'about:blank'], {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    browser.process.on('exit', () => browser.fail(new Error('the browser ended')));
    Object.assign(browser, {next: 1, waiting: new Map(), rest: Buffer.alloc(0), requests: [], complaints: []});
    browser.process.stdio[4].on('data', data => browser.receive(data));
    const {targetInfos} = await browser.send('Target.getTargets');
    const page = targetInfos.find(t => t.type === 'page');
    browser.session = (await browser.send('Target.attachToTarget', {targetId: page.targetId, flatten: true})).sessionId;
    for (const domain of ['Page', 'Runtime', 'Network', 'Log']) await browser.send(`${domain}.enable`);
    await browser.resize(width, height);
    return browser;
  }

  send(method, params = {}) {
    const id = this.next++, message = {id, method, params};
    if (this.session) message.sessionId = this.session;
    this.process.stdio[3].write(JSON.stringify(message) + '\0');
    return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
  }

  receive(data) {
    this.rest = Buffer.concat([this.rest, data]);
    for (let end; (end = this.rest.indexOf(0)) >= 0; this.rest = this.rest.subarray(end + 1)) {
      const message = JSON.parse(this.rest.subarray(0, end).toString());
      const {resolve, reject} = this.waiting.get(message.id) || {};
      this.waiting.delete(message.id);
      if (message.error) reject?.(new Error(message.error.message)); else resolve?.(message.result);
      if (message.method) this.notice(message.method, message.params);
    }
  }

  notice(method, params) {
    if (method === 'Network.requestWillBeSent') this.requests.push(params.request.url);
    if (method === 'Runtime.exceptionThrown') this.complaints.push(params.exceptionDetails.exception?.description);
    // Reading pixels back is slow, as drivers say.
    if (method === 'Log.entryAdded' && !/ReadPixels|GPU stall/.test(params.entry.text)) this.complaints.push(params.entry.text);
    if (method === 'Runtime.consoleAPICalled') {
      this.complaints.push(params.args.map(a => a.description || a.value).join(' '));
    }
  }

  fail(error) {
    for (const {reject} of this.waiting?.values() || []) reject(error);
  }

  /** The value of an expression in the page, awaited. */
  async evaluate(expression) {
    const {result, exceptionDetails} = await this.send('Runtime.evaluate',
      {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description || exceptionDetails.text);
    return result.value;
  }

  async until(condition, seconds = 60) {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
      if (await this.evaluate(condition)) return;
      await new Promise(done => setTimeout(done, 50));
    }
    throw new Error(`not within ${seconds} s: ${condition}`);
  }

  async open(path, hash = '') {
    await this.send('Page.navigate', {url: `file://${path}${hash}`});
    await this.until(`document.readyState === 'complete' && /ready|failed/.test(document.body.className) ||
      document.getElementById('message')?.textContent.includes('damaged')`);
  }

  async screenshot() {
    return Buffer.from((await this.send('Page.captureScreenshot', {format: 'png'})).data, 'base64');
  }

  resize(width, height, deviceScaleFactor = 1, mobile = false) {
    return this.send('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor, mobile});
  }

  mouse(type, x, y, more = {}) {
    return this.send('Input.dispatchMouseEvent', {type, x, y, button: 'left', clickCount: 1, ...more});
  }

  async key(key) {
    const code = key.length === 1 ? {text: key} : {};
    await this.send('Input.dispatchKeyEvent', {type: 'keyDown', key, ...code});
    await this.send('Input.dispatchKeyEvent', {type: 'keyUp', key});
  }

  async close() {
    try { await this.send('Browser.close'); } catch { /* it is gone */ }
    await new Promise(done => this.process.exitCode === null ? this.process.on('exit', done) : done());
    rmSync(this.home, {recursive: true, force: true, maxRetries: 5});
  }
}
