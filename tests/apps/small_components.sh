#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A cluster of 20 points that floats over a plate is in no picture, page, mesh or sample unless
# -min_component 0 keeps it; a ball of 60 points is in all of them.
# Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

awk 'function jitter() { state = (state * 75 + 74) % 65537; return state / 65537 - 0.5 }
BEGIN {
  turn = 2.39996323
  for (i = 0; i < 8100; ++i)
    print i % 90 - 45 + 0.6 * jitter(), int(i / 90) - 45 + 0.6 * jitter(), 0.1 * jitter()
  for (i = 0; i < 20; ++i) {
    r = 2.52 * sqrt((i + 0.5) / 20)
    print -20 + r * cos(turn * i), -20 + r * sin(turn * i), 30 + 0.1 * jitter()
  }
  for (i = 0; i < 60; ++i) {
    z = (2 * i + 1) / 60 - 1; r = 2.2 * sqrt(1 - z * z)
    print 25 + r * cos(turn * i), 25 + r * sin(turn * i), 30 + 2.2 * z
  }
}' > scan.xyz
expect 0 '' pcl_slim_fit scan.xyz surface.slim
expect 0 '' pcl_slim_render surface.slim all.html -min_component 0 -json all.json

# leftOut FILE.json COMPONENTS: how many components a report names.
leftOut() {
  tr -d ' \n' < "$1" | grep -q "\"left_out\":{[^}]*\"components\":$2[,}]" || complain "$1: not $2 left out"
}
leftOut all.json 0
view="-size 200x150 -aa 1 -view front -ortho 1"
expect 0 '' pcl_slim_render surface.slim some.png $view -json some.json
grep -q '^  left out: 1 small component of about [0-9]* points; -min_component 0 keeps them$' out.txt ||
  complain "the picture does not name what it leaves out: $(cat out.txt)"
leftOut some.json 1
expect 0 '' pcl_slim_render surface.slim all.png $view -min_component 0
if grep -q 'left out' out.txt; then complain "-min_component 0 leaves something out"; fi
differ some.png all.png
expect 0 '' pcl_slim_render surface.slim some.html -json page.json
leftOut page.json 1
[ "$(wc -c < some.html)" -lt "$(wc -c < all.html)" ] || complain "the page keeps the cluster"

# above FILE.xyz|ply X_SIGN: points high over the plate on one side.
above() { awk -v side="$2" 'NF >= 3 && $3 + 0 > 15 && $1 * side > 0 { ++n } END { print n + 0 }' "$1"; }
for keep in 50 0; do
  expect 0 '' pcl_slim_mesh surface.slim mesh$keep.obj -min_component $keep
  sed -n 's/^v //p' mesh$keep.obj > mesh$keep.txt
  expect 0 '' pcl_slim_sample surface.slim samples$keep.ply -number 4000 -min_component $keep -json s$keep.json
  [ "$(above mesh$keep.txt 1)" -gt 5 ] || complain "the mesh lacks the ball of 60 points"
done
[ "$(above mesh50.txt -1)" -eq 0 ] || complain "the mesh keeps the cluster"
[ "$(above mesh0.txt -1)" -gt 0 ] || complain "-min_component 0: the mesh lacks the cluster"
leftOut s50.json 1
leftOut s0.json 0
expect 2 'min_component' pcl_slim_render surface.slim x.png -min_component -1

finish
