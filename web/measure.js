// SPDX-License-Identifier: BSD-3-Clause
// Distances between pairs of points: kept, labelled in the picture, and listed.

const LABEL_HEIGHT = 17, LETTER_WIDTH = 8;  // pixels that labels take

export class Measures {
  /** changed: called after every change */
  constructor(viewer, numbers, $, changed) {
    Object.assign(this, {viewer, numbers, $, changed, pairs: [], start: null});
    $('clear').addEventListener('click', () => this.set([]));
  }

  /** The distance of a pair, with its unit. */
  label([a, b]) { return this.numbers.lengths(this.viewer.distance(a, b)); }

  /** The first point of a pair, or its second; returns the pair when it is complete. */
  add(point) {
    const pair = this.start && [this.start, point];
    this.start = pair ? null : point;
    if (pair) this.set([...this.pairs, pair]);
    return pair;
  }

  set(pairs) {
    this.pairs = pairs;
    this.list();
    this.changed();
  }

  /** Removes a pair; by default the last one. */
  remove(k = this.pairs.length - 1) { this.set(this.pairs.filter((_, i) => i !== k)); }

  list() {
    const {$, pairs} = this;
    $('measures').hidden = !pairs.length;
    $('pairs').replaceChildren(...pairs.map((pair, k) => {
      const item = document.createElement('li'), button = document.createElement('button');
      button.textContent = '×';
      button.setAttribute('aria-label', `Remove distance ${k + 1}`);
      button.addEventListener('click', () => {
        this.remove(k);
        ($('pairs').querySelectorAll('button')[Math.min(k, pairs.length - 2)] || this.viewer.canvas).focus();
      });
      item.append(this.label(pair), button);
      return item;
    }));
  }

  /** The lines and labels as SVG. place: where a point is seen, or null */
  draw(place) {
    const lines = [], labels = [];
    this.pairs.forEach((pair, k) => {
      const [a, b] = pair.map(place);
      if (!a || !b) return;
      const label = {x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 - 8, words: `${k + 1}: ${this.label(pair)}`};
      const isTaken = () => labels.some(l => Math.abs(l.y - label.y) < LABEL_HEIGHT && Math.abs(l.x - label.x) < LETTER_WIDTH * l.words.length);
      while (isTaken()) label.y += LABEL_HEIGHT;
      labels.push(label);
      lines.push(`<path class="halo" d="M${a}L${b}"/><path d="M${a}L${b}"/>`);
    });
    return lines.join('') + labels.map(({x, y, words}) => `<text x="${x}" y="${y}">${words}</text>`).join('');
  }

  /** All points to mark. */
  points() { return [...this.pairs.flat(), ...this.start ? [this.start] : []]; }
}
