#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Which side of a scan is out, where nothing or only the points' spacing shows it, and normals that contradict each
# other. Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# cloud FIELDS COUNT: a PCD's header; points follow on stdin.
cloud() {
  local sizes types counts
  sizes=$(sed 's/[a-z_][a-z_]*/4/g' <<< "$1")
  types=${sizes//4/F} counts=${sizes//4/1}
  printf 'VERSION 0.7\nFIELDS %s\nSIZE %s\nTYPE %s\nCOUNT %s\nWIDTH %s\nHEIGHT 1\nPOINTS %s\nDATA ascii\n' \
    "$1" "$sizes" "$types" "$counts" "$2" "$2"
  cat
}

# room X: a room of 8 x 6 x 3 m as a turning lidar in its middle sees it, 240 rings of 500 beams; moved along x.
room() {
  awk -v shift="$1" 'BEGIN {
    srand(5); pi = 3.14159265358979
    for (ring = 0; ring < 240; ++ring) for (step = 0; step < 500; ++step) {
      up = (ring / 239 - 0.5) * 120 * pi / 180; turn = 2 * pi * step / 500
      d[1] = cos(up) * cos(turn); d[2] = cos(up) * sin(turn); d[3] = sin(up)
      h[1] = 4; h[2] = 3; h[3] = 1.5; t = 1e9
      for (a = 1; a <= 3; ++a) { u = d[a] < 0 ? -d[a] : d[a]; if (u > 0 && h[a] / u < t) t = h[a] / u }
      t += 0.01 * (rand() - 0.5)
      printf "%.5f %.5f %.5f\n", t * d[1] + shift, t * d[2], t * d[3]
    }
  }'
}

# sphere SHARE: 20000 even points of a unit sphere with exact normals, a share of which are turned inward.
sphere() {
  awk -v share="$1" 'BEGIN {
    srand(7); n = 20000
    for (i = 0; i < n; ++i) {
      z = 1 - 2 * (i + 0.5) / n; r = sqrt(1 - z * z); a = 2.399963229728653 * i
      x = r * cos(a); y = r * sin(a); s = rand() < share ? -1 : 1
      printf "%.6f %.6f %.6f %.6f %.6f %.6f\n", x, y, z, s * x, s * y, s * z
    }
  }'
}

# inward FILE X: thousandths of the 120000 points of a binary PCD of 10 floats a point, whose last three are normals,
# that face the place X,0,0.
inward() {
  tail -c $((120000 * 40)) "$1" | od -An -v -tf4 -w40 | awk -v x="$2" '
    { seen += (x - $1) * $8 - $2 * $9 - $3 * $10 > 0 } END { print int(1000 * seen / NR) }'
}

# notes LINE...: the lines about sides that the last program printed, and no others.
notes() {
  grep 'sides: \|are opposed' out.txt > notes.txt
  [ $# -eq 0 ] || printf '%s\n' "$@" > expected.txt
  [ $# -gt 0 ] || : > expected.txt
  sed 's/^ *//' notes.txt | cmp -s - expected.txt || complain "notes: $(cat notes.txt) instead of: $*"
}
outward='sides: outward (no sensor known; -viewpoint X,Y,Z if it was scanned from inside)'
origin="sides: towards the origin, as the points' spacing shows a scanner there (-viewpoint X,Y,Z if it was elsewhere)"

from() { [ "$(value "$1" sides_from)" = "\"$2\"" ] || complain "$1: $(grep sides_from "$1"), not $2"; }

# facing REPORT KEY: the share of the points on leaves that face it.
facing() { sed -n '/"sides_facing"/,/}/p' "$1" | sed -n "s/.*\"$2\": \([^,]*\),*/\1/p"; }

room 0 | cloud 'x y z' 120000 > room.pcd
room 30 | cloud 'x y z' 120000 > moved.pcd
sphere 0 | cloud 'x y z normal_x normal_y normal_z' 20000 > sphere.pcd
sphere 0.1 | cloud 'x y z normal_x normal_y normal_z' 20000 > flipped.pcd
sphere 0 | awk '{ print $1, $2, $3 }' | cloud 'x y z' 20000 > plain.pcd

# Outward.
expect 0 '' pcl_slim_fit plain.pcd plain.slim -json plain.json
notes "$outward"
from plain.json outward
[ "$(facing plain.json outward)" = 1.0 ] || complain "outward: $(facing plain.json outward)"
[ "$(facing plain.json origin)" = 0.0 ] || complain "origin: $(facing plain.json origin)"
[ "$(value plain.json opposed_normals)" = 0.0 ] || complain "$(grep opposed_normals plain.json)"
expect 0 '' pcl_color_splat_sampling plain.pcd splats.pcd -json splats.json
notes "$outward"
from splats.json outward
[ "$(value splats.json opposed_normals)" = 0.0 ] || complain "$(grep opposed_normals splats.json)"
expect 0 '' pcl_slim_fit moved.pcd moved.slim -json moved.json
notes "$outward"
from moved.json outward

# Towards the origin.
expect 0 '' pcl_slim_fit room.pcd room.slim -json room.json -threads 1
notes "$origin"
from room.json origin
[ "$(facing room.json origin)" = 1.0 ] || complain "origin: $(facing room.json origin)"
expect 0 '' pcl_slim_fit room.pcd two.slim -threads 2
same room.slim two.slim
expect 0 '' pcl_color_splat_sampling room.pcd splats.pcd -json splats.json
notes "$origin"
from splats.json origin
expect 0 '' pcl_slim_fit room.pcd given.slim -viewpoint 0,0,0 -json given.json
notes
from given.json viewpoint
[ "$(facing given.json viewpoint)" = 1.0 ] || complain "viewpoint: $(facing given.json viewpoint)"

# By tiles: the same source and side; a room that was moved faces outward, as the whole of it does.
sides() {
  local shift=$1 least=$2 most=$3 surface got
  for surface in "$4" tiles.slim; do
    expect 0 '' pcl_slim_curvature "${4%.slim}.pcd" normals.pcd -surface "$surface"
    header normals.pcd 'FIELDS x y z k1 k2 mean_curvature gaussian_curvature normal_x normal_y normal_z'
    got=$(inward normals.pcd "$shift")
    if [ "$got" -lt "$least" ] || [ "$got" -gt "$most" ]; then
      complain "$surface of $4: $got of 1000 normals face the middle"
    fi
  done
}
expect 0 '' pcl_slim_fit room.pcd tiles.slim -tile_points 30000 -json tiles.json
notes "$origin"
from tiles.json origin
sides 0 995 1000 room.slim
mkdir job
expect 0 '' pcl_slim_fit room.pcd parts.slim -tile_points 30000 -plan job -tiles 0:1
expect 0 '' pcl_slim_fit room.pcd parts.slim -tile_points 30000 -plan job -json parts.json
from parts.json origin
same tiles.slim parts.slim
expect 0 '' pcl_slim_fit moved.pcd tiles.slim -tile_points 30000 -json tiles.json
notes "$outward"
from tiles.json outward
sides 30 0 5 moved.slim

# Normals of which some are opposed; those that agree are used as they are.
expect 0 '' pcl_slim_fit sphere.pcd sphere.slim -json sphere.json
notes
from sphere.json normals
[ "$(value sphere.json opposed_normals)" = 0.0 ] || complain "$(grep opposed_normals sphere.json)"
expect 0 '' pcl_slim_fit flipped.pcd flipped.slim -json flipped.json
grep -q '^ *normals of [0-9.]* % of the neighbours are opposed: used without their signs$' out.txt ||
  complain "opposed normals: $(cat out.txt)"
from flipped.json normals
awk -v o="$(value flipped.json opposed_normals)" 'BEGIN { exit !(o > 0.1 && o < 0.3) }' ||
  complain "$(grep opposed_normals flipped.json)"
same sphere.slim flipped.slim

finish
