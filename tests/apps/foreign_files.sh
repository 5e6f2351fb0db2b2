#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Files as other programs write them: the same points give the same surface, a note says what was made of a file,
# and what cannot be used is refused with a remedy.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_fit

# Points of the sheet z = sin(6 x) cos(5 y) / 10 with noise, four decimals each, and colours.
awk 'BEGIN { srand(7)
  for (i = 0; i < 4000; ++i) {
    x = rand(); y = rand(); z = 0.1 * sin(6 * x) * cos(5 * y) + 0.002 * (rand() - 0.5)
    printf "%.4f %.4f %.4f\n", x, y, z
  } }' > rows
cp rows plain.xyz
expect 0 '' plain.xyz wanted.slim

# reads FILE COLUMNS [OPTION...]: the surface of the plain file, and these columns.
reads() {
  expect 0 '' "$1" got.slim "${@:3}"
  same wanted.slim got.slim
  grep -q "^  columns: $2," out.txt || complain "$1: $(grep columns out.txt)"
}
{ echo '"X","Y","Z"'; tr ' ' ',' < rows; } > quoted.csv
reads quoted.csv 'x y z'
{ echo '"X";"Y";"Z"'; sed 's/ /";"/g; s/^/"/; s/$/"/' rows; } > all_quoted.csv
reads all_quoted.csv 'x y z'
{ printf 'sep=;\r\nX;Y;Z\r\n'; sed 's/ /;/g; s/\./,/g; s/$/\r/' rows; } > spreadsheet.csv
reads spreadsheet.csv 'x y z'
{ echo '# points of site 7 in x y z order'; cat rows; } > comment.txt
reads comment.txt 'x y z'
python3 -c "open('utf16.txt', 'wb').write(open('rows').read().encode('utf-16'))"
reads utf16.txt 'x y z'
{ echo ',"x","y","z","note, if any"'; awk '{ print NR "," $1 "," $2 "," $3 ",\"a, b\"" }' rows; } > table.csv
reads table.csv '- x y z -'
awk '{ print $1, $2, $3, NR % 256, NR % 7, NR % 11, NR % 13 }' rows > irgb.txt
reads irgb.txt 'x y z intensity red green blue' -color 0
awk '{ print NR "," $2 "," $1 "," $3 ",TREE" }' rows > pnezd.csv
reads pnezd.csv '- y x z -' -columns -,y,x,z,-
expect 2 'names 4' pnezd.csv d.slim -columns -,y,x,z
expect 2 'name every column' pnezd.csv d.slim -columns x,y
"$bin/pcl_slim_smooth" plain.xyz plain.pcd -quiet || complain "pcl_slim_smooth fails"
expect 2 'leave -columns out' plain.pcd d.slim -columns x,y,z
expect 2 'leave -columns out' plain.pcd d.slim -columns x,y,z -tile_points 10000
awk '{ print NR, $0 }' rows > numbered.txt
"$bin/pcl_slim_fit" numbered.txt got.slim -quiet 2> err.txt || complain "numbered points are not read"
same wanted.slim got.slim
grep -q 'column 1 counts the points' err.txt || complain "no warning of numbered points: $(cat err.txt)"
[ "$(wc -l < err.txt)" -eq 1 ] || complain "more than a warning: $(cat err.txt)"

# What is no list of points.
printf '1 2 3\n4 5 6\n7 8\0009\n' > zero.txt
expect 2 'line 3 has a byte of 0' zero.txt d.slim
printf 'ncols 2\nnrows 2\nxllcorner 0.0\nyllcorner 0.0\ncellsize 1.0\n1 2\n3 4\n' > grid.asc
expect 2 'gdal_translate' grid.asc d.slim

# PTX: the scanner's place gives the sides.
{ printf '80\n50\n10 20 1.5\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n10 20 1.5 1\n'
  awk 'NR % 40 == 0 { print "0 0 0 0.5"; next } { print $1, $2, $3 - 2, 0.5 }' rows; } > scan.ptx
expect 0 '' scan.ptx got.slim -json ptx.json
grep -q 'points skipped: 100 non-finite' out.txt || complain "directions without points: $(grep skipped out.txt)"
program=pcl_slim_smooth
expect 0 '' scan.ptx smooth.pcd
header smooth.pcd 'VIEWPOINT 10 20 1.5 1 0 0 0'
header smooth.pcd 'HEIGHT 80'

# Degrees.
{ echo 'lon,lat,height'; awk '{ printf "%.9f,%.9f,%.4f\n", 13.4 + $1 * 1e-5, 52.5 + $2 * 1e-5, 80 + $3 }' rows; } > degrees.csv
expect 2 'x and y are degrees' degrees.csv d.pcd
grep -q 'EPSG:32633' err.txt && grep -q -- '-units length' err.txt || complain "no remedy: $(cat err.txt)"
expect 0 '' degrees.csv d.pcd -units length
tail -n +2 degrees.csv | awk -F, '{ print $1, $2, 1000 * $3 }' > degrees.xyz
expect 2 'x and y are degrees' degrees.xyz d.pcd
rm -f d.pcd
# Lengths of different units give no surface, or one that files can store.
for program in pcl_slim_fit pcl_slim_mesh; do
  "$bin/$program" degrees.xyz d.ply -units length -quiet 2> err.txt
  ! grep -q 'surfel' err.txt || complain "$program speaks of the inside: $(cat err.txt)"
done
rm -f d.ply

# Gaussian splats: colours, and what is nearly transparent.
{ printf 'ply\nformat ascii 1.0\nelement vertex 4000\n'
  for name in x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 opacity; do echo "property float $name"; done
  echo end_header
  awk '{ print $0, 0, 0, 0, 1.7724, 0, -1.7724, (NR % 4 == 0) ? -5 : 3 }' rows; } > splats.ply
program=pcl_color_splat_sampling
expect 0 '' splats.ply discs.ply -json splats.json
grep -q '1000 of opacity below 0.1 left out' out.txt || complain "no word of splats: $(cat out.txt)"
grep -q '"colors": true' splats.json || complain "splats have no colours"
grep -q '"points": 3000' splats.json || complain "transparent splats are points"
expect 0 '' splats.ply discs.ply -min_opacity 0 -json splats.json
grep -q '"points": 4000' splats.json || complain "-min_opacity 0 leaves splats out"
expect 0 '' plain.xyz discs.ply -min_opacity .5
grep -q -- '-min_opacity has no effect' out.txt || complain "-min_opacity has an effect"
absent d.slim d.pcd
finish
