#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_curvature as a user meets it: exit status, messages, values and the fields kept.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_curvature

# floats FILE COLUMNS COUNT: the data of a binary PCD of floats, one point a line.
floats() { tail -c $((4 * $2 * $3)) "$1" | od -An -v -t f4 "-w$((4 * $2))"; }

# A sphere of radius 5 with normals of the given sign, an outlier and a hole; intensity counts.
sphere() {
  awk -v sign="$2" -v n=5000 'BEGIN {
    print "VERSION 0.7\nFIELDS x y z intensity" (sign ? " normal_x normal_y normal_z" : "")
    print "SIZE 4 4 4 4" (sign ? " 4 4 4" : "") "\nTYPE F F F F" (sign ? " F F F" : "")
    print "COUNT 1 1 1 1" (sign ? " 1 1 1" : "") "\nWIDTH 100\nHEIGHT 50\nPOINTS " n "\nDATA ascii"
    for (i = 0; i < n; ++i) {
      z = 1 - (2 * i + 1) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653
      x = r * cos(a); y = r * sin(a); s = 5
      if (i == 77) s = 20
      if (i == 99) printf "nan nan nan 99"
      else printf "%.7f %.7f %.7f %d", s * x, s * y, s * z, i
      print sign ? " " sign * x " " sign * y " " sign * z : ""
    }
  }' > "$1"
}
sphere plain.pcd 0
sphere inward.pcd -1
badScans plain.pcd

# Values and fields, on a closed surface facing outward by itself. In rows it is one a sensor has seen,
# here from within.
expect 0 '' plain.pcd seen.pcd
floats seen.pcd 11 5000 | awk '!/nan/ && $1 * $9 + $2 * $10 + $3 * $11 > -4.9 {
  print "side of a scan in rows: " $0; exit }' > wrong.txt
[ ! -s wrong.txt ] || complain "$(cat wrong.txt)"
header seen.pcd 'WIDTH 100'
header seen.pcd 'HEIGHT 50'
sed -i 's/^WIDTH 100/WIDTH 5000/; s/^HEIGHT 50/HEIGHT 1/' plain.pcd
expect 0 '' plain.pcd a.pcd -json a.json
header a.pcd 'FIELDS x y z intensity k1 k2 mean_curvature gaussian_curvature normal_x normal_y normal_z'
for key in program points threads seconds surfels moved unsupported non_finite uncovered skipped; do
  grep -q "\"$key\"" a.json || complain "no $key in the report"
done
grep -q '"unsupported": 1,' a.json || complain "the outlier is not counted"
grep -q '"non_finite": 1,' a.json || complain "the hole is not counted"
floats a.pcd 11 5000 | awk 'function off(a, b) { return (a - b) ^ 2 > 1e-4 }
  {
    if ($4 != NR - 1) { print "order"; exit }
    unknown = NR == 78 || NR == 100
    if (unknown) {  # the outlier has the normal of its neighbours
      hole = NR == 100
      if ($5 !~ /nan/ || $8 !~ /nan/ || hole != ($9 ~ /nan/)) { print "unknown, not nan: " $0; exit }
      next
    }
    if (off($5, .2) || off($6, .2) || off($7, .2) || off($8, .04)) { print "values: " $0; exit }
    if ($1 * $9 + $2 * $10 + $3 * $11 < 4.9) { print "side: " $0; exit }
  }' > wrong.txt
[ ! -s wrong.txt ] || complain "$(cat wrong.txt)"
floats a.pcd 11 5000 | awk '{ print $1, $2, $3, $4 }' > kept.txt
"$bin/pcl_slim_curvature" plain.pcd kept.ply -quiet 1 || complain "no PLY"
header kept.ply 'property float k1'
header kept.ply 'property float nx'
awk '/^DATA/ { data = 1; next } data && !/nan/ { print $1, $2, $3, $4 }' plain.pcd > given.txt
grep -v nan kept.txt | paste -d' ' - given.txt | awk '{
  for (k = 1; k < 5; ++k) if (($k - $(k + 4)) ^ 2 > 1e-11) { print; exit } }' > wrong.txt
[ ! -s wrong.txt ] || complain "a point moved: $(cat wrong.txt)"

# Normals given decide the side. A point without support keeps its own; one that is NaN has none.
expect 0 '' inward.pcd b.pcd -directions 1
header b.pcd 'FIELDS x y z intensity normal_x normal_y normal_z k1 k2 mean_curvature gaussian_curvature direction1_x direction1_y direction1_z direction2_x direction2_y direction2_z'
floats b.pcd 17 5000 | awk '
  NR == 100 { if ($5 !~ /nan/ || $8 !~ /nan/) print "hole: " $0; next }
  NR == 78 { if ($5 ~ /nan/ || $8 !~ /nan/) print "outlier: " $0; next }
  ($10 + .2) ^ 2 > 1e-4 || ($11 - .04) ^ 2 > 1e-4 { print "values: " $0; exit }
  ($12 * $15 + $13 * $16 + $14 * $17) ^ 2 > 1e-8 { print "directions: " $0; exit }' > wrong.txt
[ ! -s wrong.txt ] || complain "$(cat wrong.txt)"
expect 0 '' inward.pcd c.pcd -use_normals 0
expect 0 '' plain.pcd inside.pcd -viewpoint 0,0,0
floats inside.pcd 11 5000 | awk 'NR < 78 && $7 > 0 { print; exit }' > wrong.txt
[ ! -s wrong.txt ] || complain "the viewpoint does not decide: $(cat wrong.txt)"

# The same bytes for any number of threads and from a surface made before.
expect 0 '' plain.pcd b1.pcd -threads 1 -quiet 1
[ ! -s out.txt ] || complain "-quiet is not quiet"
expect 0 '' plain.pcd b4.pcd -threads 4
same b1.pcd b4.pcd
"$bin/pcl_slim_fit" plain.pcd surface.slim -quiet 1 || complain "pcl_slim_fit failed"
expect 0 '' plain.pcd reused.pcd -surface surface.slim
same a.pcd reused.pcd

# Help, documentation, mistakes, failures.
documented "$program" slim_curvature_estimation slim_fit
expect 2 'did you mean -directions' plain.pcd d.pcd -direction 1
expect 2 'exclude each other' plain.pcd d.pcd -surface surface.slim -penalty 2
expect 2 '.pcd, .ply, .las or .vtp' plain.pcd d.vtk
expect 2 'overwritten' plain.pcd ./plain.pcd
absent d.vtk
noSurfaces
expect 1 'along lines' line.pcd line_out.pcd
absent line_out.pcd
refuses plain.pcd
keepsOld kept.pcd plain.pcd

if [ -n "$data" ] && [ -f "$data/fandisk_03_original.ply" ]; then
  expect 0 '' "$data/fandisk_03_original.ply" fandisk.ply
  header fandisk.ply 'element face 12946'
  header fandisk.ply 'property float gaussian_curvature'
fi

finish
