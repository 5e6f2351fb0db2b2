#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# One scan in every format that programs read: the same points, columns named, fields kept.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_fit

# Points of the sheet z = sin(6 x) cos(5 y) / 10 with noise, six decimals each.
awk 'BEGIN { srand(5)
  for (i = 0; i < 4000; ++i) {
    x = rand(); y = rand(); z = 0.1 * sin(6 * x) * cos(5 * y) + 0.002 * (rand() - 0.5)
    printf "%.6f %.6f %.6f\n", x, y, z
  } }' > rows
{
  printf 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4000\nHEIGHT 1\nDATA ascii\n'
  cat rows
} > scan.pcd
cp rows scan.xyz
{ echo 4000; cat rows; } > scan.pts
{ echo 'X,Y,Z'; tr ' ' ',' < rows; } > scan.csv
sed 's/ /\t/g' rows > scan.txt
sed 's/^/v /' rows > scan.obj
{ echo OFF; echo '4000 0 0'; cat rows; } > scan.off
expect 0 '' scan.pcd wanted.slim
for name in scan.xyz scan.pts scan.csv scan.txt scan.obj scan.off; do
  expect 0 '' $name got.slim -json got.json
  same wanted.slim got.slim
  case $name in
    *.obj | *.off) ! grep -q '"columns"' got.json || complain "$name has columns" ;;
    *)
      grep -q '"columns": "x y z' got.json || complain "$name: no columns in the report"
      grep -q '^  columns: x y z' out.txt || complain "$name: columns are not told"
      ;;
  esac
done
grep -q 'guessed from the numbers' got.json && complain "an OFF file has no columns"
expect 0 '' scan.csv got.slim
grep -q 'as the file names them' out.txt || complain "columns of a header are not guessed"

# An STL file's facets are faces, which give normals.
awk 'BEGIN { print "solid s"; n = 30
  for (j = 0; j < n; ++j) for (i = 0; i < n; ++i) for (k = 0; k < 2; ++k) {
    print "facet normal 0 0 1\nouter loop"
    for (c = 0; c < 3; ++c) {
      x = i + (c == 1 || (c == 2 && k == 0)); y = j + (c == 2 || (c == 1 && k == 1))
      print "vertex", x, y, sin(x / 5)
    }
    print "endloop\nendfacet"
  }
  print "endsolid s" }' > mesh.stl
expect 0 '' mesh.stl mesh.slim -json mesh.json
[ "$(value mesh.json points)" = 961 ] || complain "corners of facets are not joined"
[ "$(value mesh.json normals)" = '"mesh"' ] || complain "no normals of facets"

# A closed mesh inside out is turned outwards; an open one keeps its side.
awk 'BEGIN { n = 24; m = 48; pi = 3.14159265358979
  print "v 0 0 3"; print "v 0 0 -3"
  for (j = 1; j < n; ++j) for (i = 0; i < m; ++i)
    print "v", 3 * sin(pi * j / n) * cos(2 * pi * i / m), 3 * sin(pi * j / n) * sin(2 * pi * i / m), 3 * cos(pi * j / n)
  for (i = 0; i < m; ++i) {
    k = (i + 1) % m
    print "f", 1, 3 + i, 3 + k
    for (j = 0; j < n - 2; ++j) print "f", 3 + j * m + i, 3 + (j + 1) * m + i, 3 + (j + 1) * m + k, 3 + j * m + k
    print "f", 2, 3 + (n - 2) * m + k, 3 + (n - 2) * m + i
  } }' > ball.obj
awk '$1 == "f" { printf "f"; for (k = NF; k > 1; --k) printf " %s", $k; print ""; next } { print }' ball.obj > inside_out.obj
expect 0 '' ball.obj ball.slim
! grep -q 'inside out' out.txt || complain "a mesh is turned that faces outwards"
expect 0 '' inside_out.obj turned.slim
[ "$(grep -c 'closed and inside out' out.txt)" = 1 ] || complain "it does not say that the mesh is turned"
same ball.slim turned.slim
sed '/^f 1 3 4$/d' ball.obj > open.obj
awk '$1 == "f" { printf "f"; for (k = NF; k > 1; --k) printf " %s", $k; print ""; next } { print }' open.obj > open_inside.obj
expect 0 '' open_inside.obj open.slim
! grep -q 'inside out' out.txt || complain "an open mesh is turned"
"$bin/pcl_slim_smooth" inside_out.obj turned.ply -quiet && "$bin/pcl_slim_smooth" ball.obj outside.ply -quiet ||
  complain "pcl_slim_smooth failed"
same outside.ply turned.ply

# Far from the origin a surface and splats of one scan leave the same shift out of their coordinates.
awk '{ print 500000.25 + $1, 4918360.5 + $2, 1700 + $3 }' OFMT=%.6f rows > far.xyz
expect 0 '' far.xyz far.pcd
"$bin/pcl_color_splat_sampling" far.xyz far_splats.pcd -quiet || complain "pcl_color_splat_sampling failed"
grep -a '^# pcl_slim shift' far.pcd > shift.txt
grep -a '^# pcl_slim shift' far_splats.pcd | cmp -s - shift.txt || complain "shifts differ: $(cat shift.txt)"
! grep -q 'shift 0 0 0' shift.txt || complain "floats hold far.xyz no better than its file"
# As in map projections, ParaView and CloudCompare add what the line says.
grep -a '^# pcl_slim shift' far_splats.pcd | awk '{ exit !($4 > 499990 && $4 < 500010) }' || complain "$(cat shift.txt)"

# LAS: smoothed in place, nothing lost; curvatures beside; and on to other programs.
awk '{ print $0, NR % 50, NR % 256, 255 - NR % 256, 7 }' rows > colored.pts
{ echo 'x,y,z,intensity,red,green,blue,gps_time,classification,return_number,number_of_returns'
  awk 'BEGIN { OFS = ","; OFMT = "%.6f" } { print 500000 + $1, 4918360 + $2, $3, NR % 50, NR, 2, 3, 1000 + NR / 8, NR % 20, 1 + NR % 2, 2 }' rows
} > survey.csv
program=pcl_slim_smooth
expect 0 '' survey.csv survey.las -json survey.json
expect 0 '' survey.las again.las -normals -json again.json
[ "$(value again.json normals)" = '"none"' ] || complain "a LAS file without normals has some"
expect 0 '' again.las again.pcd
grep -a -q '^FIELDS x y z intensity return_number .* classification .* gps_time red green blue normal_x' again.pcd ||
  complain "fields of LAS: $(grep -a FIELDS again.pcd)"
program=pcl_slim_curvature
expect 0 '' survey.las curved.las
expect 0 '' curved.las curved.pcd
grep -a -q ' k1 k2 mean_curvature gaussian_curvature' curved.pcd || complain "no curvature in LAS"
program=pcl_color_splat_sampling
expect 0 '' colored.pts splats.pcd -json splats.json
grep -q '"colors": true' splats.json || complain "no colours of a .pts file"
expect 0 '' survey.las splats.pcd -json splats.json
grep -q '"colors": true' splats.json || complain "no colours of a .las file"
expect 2 'name a .pcd, .ply or .vtp' survey.las splats.las

# VTP: from every program, drawn and read by VTK's programs, and back: values pass through bit for bit.
vtp() { # vtp PROGRAM IN ARGS...: what the program writes as .vtp comes back as the .pcd it writes.
  program=$1
  expect 0 '' "$2" out.pcd "${@:3}"
  expect 0 '' "$2" out.vtp "${@:3}"
  grep -aq "NumberOfVerts=\"$(sed -n 's/^POINTS //p' out.pcd | head -n 1)\"" out.vtp || complain "$1: vertices"
  grep -aq 'Normals="Normals"' out.vtp || complain "$1: no normals in $(grep -a '<PointData' out.vtp)"
  [ ! -c /dev/full ] || { ln -s /dev/full full.vtp && expect 1 'make room' "$2" full.vtp "${@:3}" && rm full.vtp; }
  expect 2 'does not exist' "$2" nowhere/out.vtp "${@:3}"
  program=pcl_slim_smooth
  expect 0 '' out.pcd back.pcd
  mv back.pcd wanted.pcd
  expect 0 '' out.vtp back.pcd
  points=$(sed -n 's/^POINTS //p' back.pcd | head -n 1)
  for field in x y z normal_x; do
    column wanted.pcd $field > wanted.txt
    column back.pcd $field > got.txt
    [ -s got.txt ] && cmp -s wanted.txt got.txt || complain "$1: $field differs"
  done
}
column() { # column FILE FIELD: a field of four bytes, in hexadecimal
  awk -v field="$2" '/^SIZE/ { for (i = 2; i <= NF; ++i) size[i] = $i }
    /^FIELDS/ { for (i = 2; i <= NF; ++i) if ($i == field) k = i }
    /^DATA/ { for (i = 2; size[i]; ++i) { if (i < k) at += size[i]; step += size[i] } print at + 0, step; exit }' "$1" > place.txt
  read -r at step < place.txt
  tail -c $((step * points)) "$1" | od -An -v -t x1 "-w$step" | cut -c $((3 * at + 1))-$((3 * at + 12))
}
if "$bin/pcl_slim_fit" scan.pcd probe.vtp -quiet; then
  vtp pcl_slim_smooth colored.pts -normals
  vtp pcl_slim_curvature colored.pts -directions
  vtp pcl_slim_sample scan.pcd -number 500
  vtp pcl_color_splat_sampling colored.pts -colors gradient
  "$bin/pcl_slim_render" out.pcd wanted.png -quiet && "$bin/pcl_slim_render" out.vtp got.png -quiet || complain "pcl_slim_render failed"
  same wanted.png got.png
  program=pcl_slim_smooth
  expect 0 '' ball.obj ball.vtp
  grep -aq 'NumberOfVerts="0".*NumberOfPolys="1152"' ball.vtp || complain "$(grep -a '<Piece' ball.vtp)"
  expect 0 '' ball.obj wanted.ply -mesh
  expect 0 '' ball.vtp got.ply -mesh
  head -c 3000 out.vtp > cut.vtp
  expect 2 "the VTP file" cut.vtp d.pcd
  sed 's/PolyData/Polygons/' out.vtp > foreign.vtp
  expect 2 'PolyData' foreign.vtp d.pcd
  program=pcl_slim_render
  expect 0 'triangles' ball.vtp d.png
fi

# What is not read names the command that converts it; damage is named in one line.
program=pcl_slim_fit
[ ! -e a.laz ] && expect 2 "laspy.read('a.laz').write('a.las')\|No such file" a.laz d.slim
expect 2 "pdal translate 'a.e57' 'a.las'" a.e57 d.slim
head -c 9000 survey.las > cut.las
expect 2 'truncated' cut.las d.slim
head -c 100 survey.las > cut.las
expect 2 'truncated' cut.las d.slim
expect 2 '/dev/stdin' - d.slim
mkfifo pipe.las
cat survey.las > pipe.las &
expect 0 '' pipe.las d.slim
rm d.slim pipe.las
head -n 3000 scan.pts > cut.pts
expect 2 '2999 of 4000' cut.pts d.slim
echo '1 2' >> scan.xyz
expect 2 'line 4001' scan.xyz d.slim
: > empty.las
expect 2 'empty' empty.las d.slim
absent d.slim
finish
