#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_lines: the ridge of an ellipsoid in every format, the report, mistakes and failures.
program=pcl_slim_lines
# shellcheck source=tests/support/program_test.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# An ellipsoid with axes 1, .8 and .5: one ridge, the ellipse in the plane z = 0, 5.672 long.
awk -v n=6000 'BEGIN {
  print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " n "\nHEIGHT 1\nPOINTS " n
  print "DATA ascii"
  for (i = 0; i < n; ++i) {
    z = 1 - (2 * i + 1) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653
    if (i == 99) print "nan nan nan"
    else printf "%.7f %.7f %.7f\n", r * cos(a), .8 * r * sin(a), .5 * z
  }
}' > plain.pcd
head -c 3000 plain.pcd > cut.pcd
printf 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 0\nDATA ascii\n' > none.pcd

expect 0 '' plain.pcd a.vtp -json a.json
for key in program points threads seconds surfels lines length ridges ravines closed left_out; do
  grep -q "\"$key\"" a.json || complain "no $key in the report"
done
[ "$(value a.json lines)" = 1 ] || complain "$(value a.json lines) lines instead of 1"
[ "$(value a.json ridges)" = 1 ] || complain "the line is no ridge"
[ "$(value a.json closed)" = 1 ] || complain "the line does not close"
awk -v l="$(value a.json length)" 'BEGIN { exit !(l > 5.65 && l < 5.69) }' || complain "its length"
grep -aq 'NumberOfLines="1"' a.vtp || complain "no polyline in the VTP"
expect 0 '' plain.pcd a.ply
header a.ply 'property int vertex2'
header a.ply 'property float significance'
grep -aq '^element edge' a.ply || complain "no edges in the PLY"
expect 0 '' plain.pcd a.pcd
header a.pcd 'FIELDS x y z normal_x normal_y normal_z tangent_x tangent_y tangent_z k1 k2 significance strength type line'
expect 0 '' plain.pcd a.svg
grep -q '<path' a.svg || complain "no path in the SVG"
expect 0 '' plain.pcd side.svg -view 0,1,0 -up 0,0,1
differ a.svg side.svg

# Fewer lines: none of the other kind, none stronger than this one is.
expect 0 '' plain.pcd none.ply -type ravines -json b.json
[ "$(value b.json lines)" = 0 ] || complain "a ravine on an ellipsoid"
header none.ply 'element edge 0'
for option in '-strength 100' '-length 1000'; do
  # shellcheck disable=SC2086
  expect 0 '' plain.pcd few.ply $option -json b.json
  [ "$(value b.json lines)" = 0 ] || complain "$option leaves a line"
done

# The same bytes for any number of threads and from a surface made before.
expect 0 '' plain.pcd b1.ply -threads 1 -quiet 1
[ ! -s out.txt ] || complain "-quiet is not quiet"
expect 0 '' plain.pcd b3.ply -threads 3
same b1.ply b3.ply
"$bin/pcl_slim_fit" plain.pcd surface.slim -quiet 1 || complain "pcl_slim_fit failed"
expect 0 '' plain.pcd reused.ply -surface surface.slim -json c.json
same a.ply reused.ply
grep -q '"lambda"' c.json || complain "no lambda in the report"
grep -q '"surface"' c.json || complain "the report does not name the surface"

# Help, documentation, mistakes, failures.
documented "$program" slim_crest_lines slim_fit
expect 2 'did you mean -strength' plain.pcd d.vtp -strenght 1
expect 2 'exclude each other' plain.pcd d.vtp -surface surface.slim -penalty 2
expect 2 'no OUT' plain.pcd
expect 2 'must be named' plain.pcd d.obj
expect 2 'overwritten' plain.pcd ./plain.pcd
expect 2 'No such file' missing.pcd d.vtp
expect 2 'truncated' cut.pcd d.vtp
expect 2 '-type' plain.pcd d.vtp -type valleys
expect 1 'up direction' plain.pcd d.svg -view 0,1,0
expect 1 '' none.pcd d.vtp
keepsOld kept.vtp plain.pcd
expect 2 'does not exist' plain.pcd nowhere/d.vtp
absent d.vtp d.obj d.svg nowhere
[ -z "$(find . -name '*.part')" ] || complain "temporary files were left behind"

finish
