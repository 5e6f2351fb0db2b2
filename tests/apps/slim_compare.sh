#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_compare as a user meets it: what it measures, writes and refuses.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_compare

# sheet SEED DEPTH OFFSET: a wavy sheet [-1, 1]^2 with noise of .002 and a dent of radius .4 about its middle.
sheet() {
  awk -v seed="$1" -v depth="$2" -v offset="$3" 'BEGIN { n = 6000; srand(seed); pi = atan2(0, -1)
    print "VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH " n
    print "HEIGHT 1\nVIEWPOINT 0 0 10 1 0 0 0\nDATA ascii"
    for (i = 0; i < n; ++i) {
      x = 2 * rand() - 1; y = 2 * rand() - 1; t = (x * x + y * y) / .16
      z = .1 * sin(3 * x) * cos(2 * y) - (t < 1 ? depth * (1 - t) ^ 2 : 0) + offset
      z += .002 * sqrt(-2 * log(1 - rand())) * cos(2 * pi * rand())
      printf "%.6f %.6f %.6f %d\n", x, y, z, i % 7
    } }'
}
sheet 1 0 0 > before.pcd
sheet 2 .02 0 > after.pcd
sheet 3 0 0 > again.pcd
sheet 4 0 .05 > raised.pcd
printf 'solid s\nfacet normal 0 0 1\nouter loop\nvertex -1 -1 .2\nvertex 1 -1 .2\nvertex 1 1 .2\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex -1 -1 .2\nvertex 1 1 .2\nvertex -1 1 .2\nendloop\nendfacet\nendsolid s\n' > plate.stl
badScans before.pcd

# part REPORT KEY: a number of the object "deviation".
part() { sed -n '/^  "deviation": {/,/^  }/p' "$1" | sed -n "s/.*\"$2\": \([^,]*\),*/\1/p" | head -n 1; }
# between LOW VALUE HIGH WHAT
between() {
  awk -v l="$1" -v v="$2" -v h="$3" 'BEGIN { exit !(v != "" && v + 0 >= l && v + 0 <= h) }' ||
    complain "$4 is '$2', not from $1 to $3"
}

# A dent: its depth, its volume pi r^2 depth / 3 = .00335, and no other change.
expect 0 '' after.pcd before.pcd out.pcd -json r.json
header out.pcd 'FIELDS x y z intensity deviation level_of_detection significant sigma_position'
header out.pcd 'WIDTH 6000'
between -.024 "$(part r.json least)" -.017 'the depth of the dent'
between .0027 "$(part r.json significant_volume_down)" .0038 'the volume of the dent'
between 0 "$(part r.json significant_volume_up)" .0003 'the volume of what is not there'
between 3.6 "$(sed -n '/"all": {/,/}/s/.*"area": \([^,]*\).*/\1/p' r.json | head -n 1)" 4.2 'the area'
grep -q 'registration error; -registration_error' out.txt || complain 'no word about a registration error'
grep -q '^  registration: offset' out.txt || complain 'no word about the registration'
tail -c $((32 * 6000)) out.pcd | od -An -v -t f4 -w32 | awk '{
  r = sqrt($1 * $1 + $2 * $2); inner += r < .2; found += r < .2 && $7 == 1 && $5 < 0
  if ($7 == 1 && ($5 * $5 < $6 * $6 || $5 == "nan")) { print; exit }
} END { if (inner < 100 || found < .97 * inner) print inner, found }' > wrong.txt
[ ! -s wrong.txt ] || complain "points of the dent: $(cat wrong.txt)"
expect 0 '' after.pcd before.pcd out1.pcd -threads 1 -quiet 1
[ ! -s out.txt ] || complain '-quiet is not quiet'
same out.pcd out1.pcd

"$bin/$program" - before.pcd - < after.pcd > stream.pcd 2> err.txt || complain "streams fail: $(cat err.txt)"
same out.pcd stream.pcd

# Two scans of one sheet: few false alarms.
expect 0 '' again.pcd before.pcd -json r.json
between 0 "$(sed -n '/"significant_up": {/,/}/s/.*"area": \([^,]*\).*/\1/p' r.json | head -n 1)" .2 'the area of false alarms'
expect 0 '' again.pcd before.pcd -smooth 0 -json r.json
between .0018 "$(part r.json rms)" .0024 'the RMS of points as measured'
grep -q '"at": "points"' r.json || complain '-smooth 0 is not at the points'
expect 0 '' again.pcd before.pcd -at reference -json r.json
between 0 "$(part r.json rms)" .001 'the RMS at the reference'

# An offset: measured, taken away, and along the reference's side for either order.
expect 0 '' raised.pcd before.pcd -json r.json
between .048 "$(part r.json mean)" .052 'the offset'
expect 0 '' before.pcd raised.pcd -json r.json -at reference
between -.052 "$(part r.json mean)" -.048 'the offset of the other order'
expect 0 '' raised.pcd before.pcd moved.ply -align 1 -matrix m.txt -json r.json
between -.001 "$(part r.json mean)" .001 'the mean after alignment'
between -.053 "$(awk 'NR == 3 { print $4 }' m.txt)" -.047 'the offset of the matrix'
[ "$(awk '{ print NF }' m.txt | sort -u)" = 4 ] && [ "$(wc -l < m.txt)" = 4 ] || complain 'no 4 x 4 matrix'
expect 0 '' raised.pcd before.pcd -registration_error .1 -json r.json
between .19 "$(part r.json level_of_detection)" .21 'the level with a registration error'

# Meshes: exact triangles as a reference and as what is measured; points beyond it have no counterpart.
expect 0 '' before.pcd plate.stl mesh.pcd -json r.json
between -.21 "$(part r.json mean)" -.19 'the mean below a plate'
expect 0 '' plate.stl before.pcd plate.ply -json r.json
# Edges of two spacings of the scan, not the finest that are allowed.
between 1000 "$(value r.json places)" 10000 'the places of a plate'
between .19 "$(part r.json mean)" .21 'the mean above a sheet'
header plate.ply 'element face 2'
header plate.ply 'property float deviation'
expect 0 '' before.pcd raised.pcd -max_distance .01 -json r.json
between 3.6 "$(sed -n '/"no_counterpart": {/,/}/s/.*"area": \([^,]*\).*/\1/p' r.json | head -n 1)" 4.2 'the area too far away'
"$bin/pcl_slim_fit" before.pcd before.slim -quiet 1 || complain 'pcl_slim_fit failed'
expect 0 '' after.pcd before.slim out2.pcd
same out.pcd out2.pcd
expect 0 '' before.slim after.pcd surface.vtp
[ -s surface.vtp ] || complain 'no places of a surface'

# Tolerances end the program with status 3, and all is written.
expect 0 '' after.pcd before.pcd -tolerance -.05,.05
expect 3 'not within its tolerance' after.pcd before.pcd t.las -tolerance -.01,.01 -csv t.csv -json r.json
[ -s t.las ] && [ -s t.csv ] || complain 'no outputs beyond a tolerance'
grep -q '"passes": false' r.json || complain 'no verdict in the report'
[ "$(wc -l < t.csv)" -ge 3 ] && [ "$(awk -F, '{ print NF }' t.csv | sort -u)" = 22 ] || complain "t.csv: $(cat t.csv)"
expect 2 'LOW,HIGH' after.pcd before.pcd -tolerance 1
expect 2 'tolerance' after.pcd before.pcd -tolerance 1,-1

# Histogram, section, picture, page.
expect 0 '' after.pcd before.pcd -histogram h.csv -bins 10 -section 0,0,0,0,1,0 -section_file s.svg -unit mm \
  -picture p.png -size 320x240 -page p.html -json r.json
[ "$(wc -l < h.csv)" = 11 ] || complain 'no histogram of ten bins'
awk -F, 'NR > 1 { area += $3 } END { exit !(area > 3.5 && area < 4.2) }' h.csv || complain 'the area of the histogram'
grep -q '<svg' s.svg && grep -q 'before.pcd' s.svg && grep -q ' mm<' s.svg || complain 'no section'
if command -v xmllint > /dev/null; then xmllint --noout s.svg || complain 's.svg is no XML'; fi
head -c 8 p.png | grep -q PNG || complain 'no picture'
grep -q 'level of detection' p.html || complain 'no legend in the page'
expect 0 '' plate.stl before.pcd -picture q.png -page q.html
[ -s q.png ] && [ -s q.html ] || complain 'no drawings of a mesh'
cp -- p.png old.png
expect 0 '' after.pcd before.pcd -unit mm -picture p.png -size 320x240 -threads 1
same p.png old.png

documented pcl_slim_compare slim_deviation slim_fit
expect 2 'no A is given'
expect 2 'no B is given' before.pcd
expect 2 'unexpected argument' before.pcd after.pcd o.pcd more.pcd
expect 2 'No such file' before.pcd missing.pcd o.pcd
expect 2 'truncated' cut.pcd before.pcd o.pcd
expect 1 'no points' before.pcd none.pcd o.pcd
expect 1 'NaN' nan.pcd before.pcd o.pcd
expect 2 '.pcd, .ply, .las or .vtp' before.pcd after.pcd o.xyz
expect 2 'does not exist' before.pcd after.pcd nowhere/o.pcd
expect 2 'does not exist' before.pcd after.pcd -picture nowhere/o.png
expect 2 'overwritten' before.pcd after.pcd after.pcd
expect 2 'share' before.pcd after.pcd o.pcd -json o.pcd
expect 2 '.html' before.pcd after.pcd -page o.txt
expect 2 '.svg' before.pcd after.pcd -section 0,0,0,0,0,1 -section_file o.txt
expect 2 'together' before.pcd after.pcd -section 0,0,0,0,0,1
expect 2 'meets neither' before.pcd after.pcd o.pcd -section 0,0,9,0,0,1 -section_file o.svg
expect 2 'leave -at out' before.pcd after.pcd -smooth 0 -at surface
expect 2 'of one scan' before.pcd after.pcd -frames again.pcd
expect 2 'a number' before.pcd after.pcd -max_distance -1
absent o.pcd o.png o.svg nowhere o.xyz
if [ -c /dev/full ]; then
  echo old > o.pcd
  expect 1 'make room' before.pcd after.pcd o.pcd -json /dev/full
  grep -qx old o.pcd || complain 'o.pcd is not the old one after a report that failed'
  rm -f o.pcd
fi
got=0
"$bin/$program" before.pcd after.pcd o.pcd -quiet 2> err.txt &
pid=$!
sleep 0.05
kill -INT $pid
wait $pid || got=$?
[ "$got" -eq 0 ] || [ "$got" -eq 130 ] || complain "stopped: exit $got"
[ "$got" -eq 0 ] || absent o.pcd
finish
