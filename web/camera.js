// SPDX-License-Identifier: BSD-3-Clause
// A camera that orbits, in a model's local units and in double.
import {along, cross, dot, length, minus, scaled, unit} from './vectors.js';

const USUAL_FOV = 30;  // where a page names none, degrees

/** v turned about a unit axis. */
function turned(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return along(along(scaled(v, c), s, cross(axis, v)), (1 - c) * dot(axis, v), axis);
}

export class Camera {
  /** given: a page's camera, in the world; turn: the direction that dragging turns about */
  constructor(given, turn, origin, scale) {
    const local = p => scaled(minus(p, origin), 1 / scale);
    this.position = local(given.position);
    this.target = local(given.look_at);
    this.up = unit(given.up);
    this.turn = unit(turn);
    this.fov = given.fov || USUAL_FOV;
    this.height = (given.height || 0) / scale;
    this.aspect = given.aspect;
    this.share = 1;  // of a picture's height that the object is framed in
  }

  copy() { return Object.assign(Object.create(Camera.prototype), this); }

  /** Right, up and forward, unit length. */
  axes() {
    const forward = unit(minus(this.target, this.position)), right = unit(cross(forward, this.up));
    return [right, cross(right, forward), forward];
  }

  /** Half of a picture's height at unit depth. */
  slope() { return Math.tan(this.fov * Math.PI / 360); }

  depth(point) { return dot(minus(point, this.position), this.axes()[2]); }

  /** A pixel's length at unit depth, or everywhere in parallel projection. What was framed stays in narrower
   * pictures. */
  pixel(width, height) {
    const tall = this.height || 2 * this.slope();
    return tall * Math.max(1 / (this.share * height), this.aspect / width);
  }

  /** The ray through a place of a picture, in pixels from its upper left corner. */
  ray(x, y, width, height) {
    const [right, up, forward] = this.axes(), pixel = this.pixel(width, height);
    const aside = along(scaled(right, (x - width / 2) * pixel), (height / 2 - y) * pixel, up);
    if (this.height) return [along(this.position, 1, aside), forward];
    return [this.position, unit(along(forward, 1, aside))];
  }

  /** Where a point is seen, or nothing behind the eye. */
  project(point, width, height) {
    const [right, up, forward] = this.axes(), d = minus(point, this.position), depth = dot(d, forward);
    if (!this.height && depth <= 0) return null;
    const pixel = this.pixel(width, height) * (this.height ? 1 : depth);
    return [width / 2 + dot(d, right) / pixel, height / 2 - dot(d, up) / pixel];
  }

  /** Turns about a point, which stays where it is seen; never over the poles. */
  orbit(pivot, yaw, pitch) {
    const [right, , forward] = this.axes();
    const angle = Math.acos(Math.max(-1, Math.min(1, dot(forward, this.turn))));
    const bounded = Math.max(0.03 - (Math.PI - angle), Math.min(angle - 0.03, pitch));
    const turn = v => turned(turned(v, right, bounded), this.turn, yaw);
    this.position = along(pivot, 1, turn(minus(this.position, pivot)));
    this.target = along(pivot, 1, turn(minus(this.target, pivot)));
    this.up = unit(turn(this.up));
  }

  /** Comes nearer to a point (factor below 1), which stays where it is seen. */
  zoom(pivot, factor) {
    if (this.height) {
      const forward = this.axes()[2], aside = minus(pivot, this.position);
      const flat = along(aside, -dot(aside, forward), forward);
      this.move(scaled(flat, 1 - factor));
      this.height *= factor;
      return;
    }
    this.move(scaled(minus(pivot, this.position), 1 - factor));
  }

  /** Moves so that a point follows a step in pixels. */
  pan(pivot, dx, dy, width, height) {
    const [right, up] = this.axes();
    const pixel = this.pixel(width, height) * (this.height ? 1 : this.depth(pivot));
    this.move(along(scaled(right, -dx * pixel), dy * pixel, up));
  }

  move(step) {
    this.position = along(this.position, 1, step);
    this.target = along(this.target, 1, step);
  }

  /** Looks at a point from the same direction and distance. */
  center(point) {
    const forward = this.axes()[2], away = length(minus(point, this.position));
    this.position = along(point, -away, forward);
    this.target = point;
  }
  /** Parallel projection, or perspective: what is at a point's depth keeps its place and size. ball: around the
   * object, all of which is in front of an eye outside */
  setParallel(parallel, point, ball) {
    if (parallel === !!this.height) return;
    const forward = this.axes()[2], size = 2 * this.slope();
    let step = 0;
    if (parallel) {
      this.height = size * Math.max(1e-9, this.depth(point));
      if (length(minus(ball.center, this.position)) > ball.radius) step = Math.min(0, this.depth(ball.center) - 1.01 * ball.radius);
    } else {
      step = this.depth(point) - this.height / size;
      this.height = 0;
    }
    this.move(scaled(forward, step));
  }
}
