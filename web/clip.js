// SPDX-License-Identifier: BSD-3-Clause
// The clipping box: six sliders, two for each axis.
import {edgesOf} from './box.js';

const STEPS = 1000, WHOLE = [0, STEPS, 0, STEPS, 0, STEPS];

export class Clip {
  constructor(viewer, numbers, $) {
    Object.assign(this, {viewer, numbers, $, values: WHOLE});
    this.sliders = WHOLE.map((value, i) => this.addSlider('xyz'[i >> 1], i % 2, i));
    $('unclip').addEventListener('click', () => this.set(WHOLE));
    this.show();
  }

  addSlider(axis, isHigh, i) {
    const label = document.createElement('label'), slider = document.createElement('input'), value = document.createElement('output');
    Object.assign(slider, {type: 'range', max: STEPS});
    slider.setAttribute('aria-label', `${isHigh ? 'Largest' : 'Smallest'} ${axis}`);
    slider.addEventListener('input', () => this.set(this.values.map((v, k) => k === i ? +slider.value : v), i));
    label.append(slider, value);
    this.$('sides').append(...isHigh ? [] : [axis], label);
    return {slider, value};
  }

  /** Positions of the six sliders, 0 ... STEPS; the one that moved stops at its neighbour. */
  set(values, moved) {
    this.values = values.map((v, i) => i !== moved ? v : i % 2 ? Math.max(v, values[i - 1] + 1) : Math.min(v, values[i + 1] - 1));
    this.show();
    this.viewer.clipTo(this.isOn() ? this.box(0.01) : null);
  }

  /** Takes up positions from elsewhere; others than six in order clip nothing. */
  restore(values) {
    const fits = values?.every((v, i) => v >= 0 && v <= STEPS && (i % 2 === 0 || v > values[i - 1]));
    this.set(fits ? values : WHOLE);
  }

  isOn() { return this.values.some((v, i) => v !== WHOLE[i]); }

  /** The box in local units; sides at the end of their slider are moved out by a share of the whole. */
  box(outside = 0) {
    const [low, high] = this.viewer.surface.bounds.box;
    return [0, 1].map(side => low.map((l, k) => {
      const v = this.values[2 * k + side], share = v / STEPS + (v === WHOLE[side] ? outside * (2 * side - 1) : 0);
      return l + share * (high[k] - l);
    }));
  }

  show() {
    const box = this.box().map(corner => this.viewer.world(corner));
    this.sliders.forEach(({slider, value}, i) => {
      slider.value = this.values[i];
      value.textContent = this.numbers.lengths(box[i % 2][i >> 1]);
      slider.setAttribute('aria-valuetext', value.textContent);
    });
    this.$('unclip').disabled = !this.isOn();
    this.$('clip').classList.toggle('on', this.isOn());
  }

  /** The box's edges as SVG, while its panel is open. */
  draw(place) {
    if (this.$('box').hidden) return '';
    const edges = edgesOf(this.box()).map(edge => edge.map(place)).filter(([a, b]) => a && b);
    return `<path class="box" d="${edges.map(([a, b]) => `M${a}L${b}`).join('')}"/>`;
  }
}
