// SPDX-License-Identifier: BSD-3-Clause
// The six standard views of an object, by the names of pcl_slim_render -view.
import {along, cross, dot, scaled, unit} from './vectors.js';

const FREE = 0.92;   // share of the picture that the object takes
const REACH = 0.7;   // share of a ball's radius that is sure to be shown

/** Directions to the viewer and upwards in the picture, by what is upwards: viewFromAngles() of modules/render. */
export function directionsOf(name, up) {
  const aside = Math.abs(up[0]) > 0.9 ? [0, 0, -Math.sign(up[0])] : [1, 0, 0];
  const right = unit(along(aside, -dot(aside, up), up)), front = cross(right, up);
  return {
    front: [front, up], back: [scaled(front, -1), up], left: [scaled(right, -1), up], right: [right, up],
    top: [up, scaled(front, -1)], bottom: [scaled(up, -1), front],
  }[name];
}

/** Places a camera so that balls [x, y, z, radius] fill a picture of these pixels; its projection stays. O(balls). */
export function look(camera, name, balls, width, height) {
  const [eye, top] = directionsOf(name, camera.turn), axes = [cross(top, eye), top, scaled(eye, -1)];
  const seen = balls.map(ball => [...axes.map(axis => dot(ball, axis)), REACH * ball[3]]);
  const wide = width / (camera.share * height), slope = FREE * camera.slope(), parallel = camera.height > 0;
  const slopes = parallel ? [0, 0] : [wide * slope, slope];
  const most = value => seen.reduce((m, ball) => Math.max(m, value(ball)), -Infinity);
  // Bounds of x - slope z and -x - slope z: of planes through the eye that all balls are inside of.
  const sides = slopes.map((s, k) => [1, -1].map(side => most(b => side * b[k] - s * b[2] + b[3] * Math.hypot(1, s))));
  const [x, y] = sides.map(([more, less]) => (more - less) / 2), half = sides.map(([more, less]) => (more + less) / 2);
  const nearest = -most(b => b[3] - b[2]), farthest = most(b => b[2] + b[3]), tall = Math.max(half[1], half[0] / wide);
  const z = parallel ? 2 * nearest - farthest : Math.min(-half[0] / slopes[0], -half[1] / slopes[1]);
  if (parallel) camera.height = 2 * tall / FREE;
  camera.aspect = most(b => (Math.abs(b[0] - x) + b[3]) / (parallel ? tall : slope * (b[2] - z)));
  camera.position = along(along(scaled(axes[0], x), y, axes[1]), z, axes[2]);
  camera.target = along(camera.position, (nearest + farthest) / 2 - z, axes[2]);
  camera.up = top;
}
