#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Clouds of pages and pictures, as text on stdout: made_points.sh KIND [SEED].
#   outliers   a noisy sphere of 50,000 points and 5,555 scattered ones, x y z
#   plates     two plates three spacings apart, x y z
#   blade      a blade of 30 degrees and a ball that touches it, x y z
#   frame      a .pcd of 120 x 120 points of a wave whose errors are shared by 5 x 5 points
#   street     a .pcd of 40,000 points of a street between houses with the time of each: x y z stamp
#   random     SEED random lines of stdin
# Numbers are drawn by Park and Miller's generator, so that any awk makes the same.
set -euo pipefail
[ $# -ge 1 ] || { echo "usage: made_points.sh KIND [SEED]" >&2; exit 2; }
awk -v kind="$1" -v seed="${2-1}" '
  function u() { s = (16807 * s) % 2147483647; return s / 2147483647 }
  function g() { return sqrt(-2 * log(u())) * cos(6.283185307179586 * u()) }
  function head(fields, width, height, viewpoint,   n, i, part, sizes, types, counts) {
    n = split(fields, part, " ")
    for (i = 0; i < n; ++i) { sizes = sizes " 4"; types = types " F"; counts = counts " 1" }
    print "VERSION 0.7\nFIELDS " fields "\nSIZE" sizes "\nTYPE" types "\nCOUNT" counts
    print "WIDTH " width "\nHEIGHT " height "\nVIEWPOINT " viewpoint " 1 0 0 0\nPOINTS " width * height "\nDATA ascii"
  }
  function outliers(   i, z, a, r) {
    for (i = 0; i < 50000; ++i) {
      z = 1 - (2 * i + 1) / 50000; a = 2.399963229728653 * i; r = sqrt(1 - z * z)
      printf "%.4f %.4f %.4f\n", r * cos(a) + .005 * g(), r * sin(a) + .005 * g(), z + .005 * g()
    }
    print "50000 points on a sphere and 5555 points scattered" > "/dev/stderr"
    for (i = 0; i < 5555; ++i) printf "%.4f %.4f %.4f\n", 2.4 * u() - 1.2, 2.4 * u() - 1.2, 2.4 * u() - 1.2
  }
  function blade(   i, j, y, z, a, r) {
    for (i = 0; i < 8280; ++i) {
      j = i % 4140; y = 50 * ((.6180339887498949 * j) % 1)
      printf "%.4f %.4f %.4f\n", 80 * (j + .5) / 4140 + .1 * g(), y + .1 * g(), (i < 4140 ? .268 : -.268) * y + .1 * g()
    }
    for (i = 0; i < 2827; ++i) {
      z = 1 - (2 * i + 1) / 2827; a = 2.399963229728653 * i; r = 15 * sqrt(1 - z * z)
      printf "%.4f %.4f %.4f\n", 40 + r * cos(a) + .1 * g(), 26.12 + r * sin(a) + .1 * g(), 22.53 + 15 * z + .1 * g()
    }
  }
  function plates(   i, j) {
    for (i = 0; i < 9800; ++i) {
      j = i % 4900
      printf "%.4f %.4f %.4f\n", 70 * (j + .5) / 4900 + .3 * g(), 70 * ((.6180339887498949 * j) % 1) + .3 * g(),
        3 * (i >= 4900) + .3 * g()
    }
  }
  function frame(   n, w, x, y, k, sum, e) {
    n = 120; w = 5
    head("x y z", n, n, .4 + .1 * (seed % 3) " " .5 - .1 * (seed % 2) " 2")
    for (y = 0; y < n + w; ++y) for (x = 0; x < n + w; ++x) e[y, x] = g()
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) {
      sum = 0
      for (k = 0; k < w * w; ++k) sum += e[y + int(k / w), x + k % w]
      printf "%.6f %.6f %.6f\n", .01 * x, .01 * y, .05 * sin(.06 * x) * cos(.05 * y) + .004 * sum / w
    }
  }
  function street(   n, i, x, side) {
    n = 40000
    head("x y z stamp", n, 1, "0 0 0")
    for (i = 0; i < n; ++i) {
      x = 40 * i / n; side = 3 * u()
      x += 8 * (u() - .5)
      if (side < 1) printf "%.3f %.3f %.3f", x, 10 * u() - 5, .01 * g()
      else printf "%.3f %.3f %.3f", x, (side < 2 ? -5 : 5) + .01 * g(), 4 * u()
      printf " %.3f\n", 30 + i / 1000
    }
  }
  function random(   lines, n, i, j, line) {
    while ((getline line) > 0) lines[n++] = line
    for (i = 0; i < seed && i < n; ++i) {
      j = i + int((n - i) * u()); line = lines[j]; lines[j] = lines[i]; print line
    }
  }
  BEGIN {
    s = kind == "frame" ? seed : 1
    if (kind == "outliers") outliers()
    else if (kind == "plates") plates()
    else if (kind == "blade") blade()
    else if (kind == "frame") frame()
    else if (kind == "street") street()
    else if (kind == "random") random()
    else { print "unknown kind " kind > "/dev/stderr"; exit 2 }
  }'
