// SPDX-License-Identifier: BSD-3-Clause
// Vectors of three numbers.

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const along = (a, t, b) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
export const minus = (a, b) => along(a, -1, b);
export const scaled = (a, t) => [a[0] * t, a[1] * t, a[2] * t];
export const length = a => Math.hypot(a[0], a[1], a[2]);
export const unit = a => scaled(a, 1 / (length(a) || 1));
export const cross = (a, b) =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
