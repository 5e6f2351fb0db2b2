// SPDX-License-Identifier: BSD-3-Clause
// What the mouse and fingers do in the picture: turn, move, come nearer, tap.

export class Pointers {
  /** tap: called with the place of a click; double: with the point under a second one */
  constructor(viewer, tap, double) {
    Object.assign(this, {viewer, canvas: viewer.canvas, down: new Map(), tap, double});
    const on = (name, act) => this.canvas.addEventListener(name, act, {passive: false});
    on('pointerdown', e => this.press(e));
    on('pointermove', e => this.drag(e));
    for (const name of ['pointerup', 'pointercancel']) on(name, e => this.release(e));
    on('contextmenu', e => e.preventDefault());
    on('wheel', e => this.wheel(e));
  }

  place(e) {
    const box = this.canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }

  /** The point under a place, or the object's middle. */
  pivotAt(x, y) { return this.viewer.pick(x, y)?.point || this.viewer.middle(); }

  press(e) {
    this.canvas.focus({preventScroll: true, focusVisible: false});
    this.canvas.setPointerCapture(e.pointerId);
    this.down.set(e.pointerId, this.place(e));
    this.start = {at: this.place(e), moved: false, pan: e.button > 0 || e.shiftKey};
    this.pivot = this.pivotAt(...this.middle());
  }

  middle() {
    const all = [...this.down.values()];
    return [0, 1].map(k => all.reduce((sum, p) => sum + p[k], 0) / all.length);
  }

  drag(e) {
    if (!this.down.has(e.pointerId)) return;
    const before = this.middle(), gap = this.gap();
    this.down.set(e.pointerId, this.place(e));
    const after = this.middle(), [dx, dy] = [after[0] - before[0], after[1] - before[1]];
    if (Math.hypot(after[0] - this.start.at[0], after[1] - this.start.at[1]) > 4) this.start.moved = true;
    if (!this.start.moved && this.down.size < 2) return;
    const {camera} = this.viewer, {clientWidth: width, clientHeight: height} = this.canvas;
    if (this.down.size > 1) {
      this.start.moved = true;
      camera.pan(this.pivot, dx, dy, width, height);
      if (gap > 0 && this.gap() > 0) camera.zoom(this.pivot, gap / this.gap());
    } else if (this.start.pan) {
      camera.pan(this.pivot, dx, dy, width, height);
    } else {
      camera.orbit(this.pivot, -dx * Math.PI / height, -dy * Math.PI / height);
    }
    this.viewer.moved();
  }

  /** Distance between two fingers. */
  gap() {
    const [a, b] = this.down.values();
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  }

  release(e) {
    if (!this.down.delete(e.pointerId)) return;
    if (e.type === 'pointerup' && !this.start.moved && !this.down.size) this.count(...this.place(e), e.timeStamp);
    if (this.down.size) this.pivot = this.pivotAt(...this.middle());
  }

  /** One tap, or a second one at its place: fingers have no double click. */
  count(x, y, time) {
    const {last} = this, again = last && time - last.time < 400 && Math.hypot(x - last.x, y - last.y) < 12;
    this.last = again ? null : {x, y, time};
    const hit = again && this.viewer.pick(x, y);
    if (hit && this.double(hit.point)) return;
    this.tap(x, y);
  }

  wheel(e) {
    e.preventDefault();
    // One pick for one turn of the wheel: the point stays under the pointer.
    if (!(e.timeStamp - this.wheeled < 400)) this.wheelPivot = this.pivotAt(...this.place(e));
    this.wheeled = e.timeStamp;
    const lines = e.deltaMode ? 20 * e.deltaY : e.deltaY;
    this.viewer.camera.zoom(this.wheelPivot, Math.exp(0.0015 * Math.max(-300, Math.min(300, lines))));
    this.viewer.moved();
  }
}
