#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# -colors of pcl_slim_fit and pcl_slim_mesh, and -surface of pcl_color_splat_sampling, as a user meets
# them: exit status, messages, files. Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# cloud FILE COUNT SEED WIDTH COLOUR: a wavy sheet, WIDTH of it wide along x, of one colour or without
# any, ascii.
cloud() {
  awk -v n="$2" -v seed="$3" -v width="$4" -v colour="$5" 'BEGIN {
    printf "VERSION 0.7\nFIELDS x y z%s\n", colour == "none" ? "" : " rgb"
    printf "SIZE 4 4 4%s\nTYPE F F F%s\n", colour == "none" ? "" : " 4", colour == "none" ? "" : " U"
    printf "COUNT 1 1 1%s\nWIDTH %d\nHEIGHT 1\nPOINTS %d\nDATA ascii\n", colour == "none" ? "" : " 1", n, n
    srand(seed)
    for (i = 0; i < n; ++i) {
      x = width * rand(); y = rand()
      printf "%.9f %.9f %.9f", x, y, 0.1 * sin(6 * x) * cos(5 * y)
      print colour == "none" ? "" : " " colour
    }
  }' > "$1"
}

red=$((200 * 65536)) green=$((200 * 256))
cloud bare.pcd 6000 7 1 none
cloud green.pcd 6000 7 1 $green
cloud red.pcd 9000 8 1 $red
cloud half.pcd 4500 8 0.5 $red
badScans bare.pcd

# Colours of another cloud are on the whole surface, whatever the scan has.
for scan in bare green; do
  expect 0 '' pcl_slim_fit $scan.pcd $scan.slim -colors red.pcd -json $scan.json
  grep -q '^> Loading red.pcd \[done, .* 9000 points\]' out.txt || complain "no line about red.pcd"
  grep -q '^> Painting \[done, .* : 100.0 % of .* leaves' out.txt || complain "not painted: $(grep Painting out.txt)"
  ! grep -q 'other leaves' out.txt || complain "leaves that are not painted"
  for key in colors_from colors_points colors_near painted_leaves load_colors paint; do
    grep -q "\"$key\"" $scan.json || complain "no $key in $scan.json"
  done
done
same bare.slim green.slim
expect 0 '' pcl_slim_fit bare.pcd again.slim -colors red.pcd -threads 1
same bare.slim again.slim

# Half of it: the other leaves are grey, or keep the scan's own colours unless these are left out.
expect 0 '' pcl_slim_fit bare.pcd half.slim -colors half.pcd
grep -q '^  the other leaves are grey$' out.txt || complain "not said that leaves are grey"
expect 0 '' pcl_slim_fit green.pcd own.slim -colors half.pcd
grep -q '^  the other leaves keep the scan.s own colours$' out.txt || complain "own colours not named"
differ half.slim own.slim
expect 0 '' pcl_slim_fit green.pcd grey.slim -color 0 -colors half.pcd
same half.slim grey.slim

# Meshes, of a scan and of a surface: shares of vertices that are red, green and grey.
colours() {
  awk '$1 == "v" { r = 255 * $5; g = 255 * $6; b = 255 * $7; ++n
      if (r > 150 && g < 60) ++red; else if (g > 150 && r < 60) ++green; else if (b > 100) ++grey }
    END { if (n) printf "%d %d %d", 100 * red / n + .5, 100 * green / n + .5, 100 * grey / n + .5 }' mesh.obj
}
near() { # WHAT SHARES RED GREEN GREY, within 12
  # shellcheck disable=SC2086
  set -- "$1" $2 -- "${@:3}"
  awk -v a="$2" -v b="$3" -v c="$4" -v x="$6" -v y="$7" -v z="$8" 'function d(p, q) { return p > q ? p - q : q - p }
    BEGIN { exit !(d(a, x) <= 12 && d(b, y) <= 12 && d(c, z) <= 12) }' || complain "$1: $2 $3 $4 instead of $6 $7 $8"
}
obj() { # ARGS...: makes mesh.obj
  expect 0 '' pcl_slim_mesh "$1" mesh.obj "${@:2}"
}
obj green.pcd -colors red.pcd
near 'red.pcd' "$(colours)" 100 0 0
obj green.pcd -colors half.pcd
near 'half.pcd over green' "$(colours)" 50 50 0
obj bare.pcd -colors half.pcd
near 'half.pcd over nothing' "$(colours)" 50 0 50
obj own.slim
near 'a painted surface' "$(colours)" 50 50 0
obj own.slim -colors red.pcd
near 'a surface painted again' "$(colours)" 100 0 0
obj bare.pcd -surface own.slim -colors red.pcd
near 'a surface with its scan' "$(colours)" 100 0 0

# What cannot be used: one line, status 2, no output.
for program in pcl_slim_fit pcl_slim_mesh; do
  out=x.slim
  [ $program = pcl_slim_fit ] || out=x.ply
  expect 2 'has no colours (rgb, rgba or red green blue); leave -colors out' green.pcd $out -colors bare.pcd
  expect 2 'missing.pcd' green.pcd $out -colors missing.pcd
  awk '/^DATA/ { d = 1; print; next } d { $1 += 50 } { print }' red.pcd > far.pcd
  expect 2 'register both in the same' green.pcd $out -colors far.pcd
  expect 2 'cut.pcd\|empty.pcd' green.pcd $out -colors cut.pcd
  expect 2 'overwritten' green.pcd red.pcd.ply -colors red.pcd.ply
  expect 2 "option -colors got ''" green.pcd $out -colors ''
  absent $out
done
expect 2 'exclude each other' green.pcd x.ply -color 1 -colors red.pcd
unset program
expect 2 '-colors is not possible by tiles' pcl_slim_fit green.pcd x.slim -colors red.pcd -tile_points 3000

# Splats of a surface: as many samples as IN has points, its colours, without holes.
for threads in 1 2; do
  expect 0 '' pcl_color_splat_sampling bare.pcd splats$threads.pcd -surface own.slim -threads $threads -json splats.json
done
same splats1.pcd splats2.pcd
[ "$(value splats.json samples)" = 6000 ] || complain "$(value splats.json samples) samples instead of 6000"
awk -v h="$(value splats.json holes)" 'BEGIN { exit !(h == 0) }' || complain "holes: $(value splats.json holes)"
grep -q '"colors": true' splats.json || complain "splats without the surface's colours"
expect 0 '' pcl_color_splat_sampling own.slim itself.pcd -json itself.json
[ "$(value itself.json samples)" = 6000 ] || complain "a surface gives $(value itself.json samples) samples"
same splats1.pcd itself.pcd
for extension in pcd ply vtp; do # the same surface, with a gradient for a texture
  expect 0 '' pcl_slim_fit green.pcd own.$extension -colors half.pcd
  expect 0 '' pcl_color_splat_sampling own.$extension x.pcd -max_splats 500 -json x.json
  [ "$(value x.json splats)" -le 500 ] || complain "more than 500 splats"
  expect 0 '' pcl_color_splat_sampling half.pcd x.pcd -surface own.$extension -json x.json
  [ "$(value x.json samples)" = 4500 ] || complain "$(value x.json samples) samples instead of 4500"
  rm -f x.pcd
done
expect 0 '' pcl_slim_fit bare.pcd shape.slim
expect 0 '' pcl_color_splat_sampling shape.slim shape.pcd
grep -q 'the surface has no colours' out.txt || complain "not said that the surface has no colours"
expect 2 'is a surface itself' pcl_color_splat_sampling own.slim x.pcd -surface own.slim
expect 2 'its own normals: leave -viewpoint out' pcl_color_splat_sampling own.slim x.pcd -viewpoint 0,0,9
expect 2 'exclude each other' pcl_color_splat_sampling bare.pcd x.pcd -surface own.slim -estimate_normals 9
expect 2 '-min_component is of surfaces' pcl_color_splat_sampling bare.pcd x.pcd -min_component 9
expect 2 'missing.slim' pcl_color_splat_sampling bare.pcd x.pcd -surface missing.slim
expect 2 'bare.pcd' pcl_color_splat_sampling bare.pcd x.pcd -surface bare.pcd
expect 2 'finite\|point' pcl_color_splat_sampling nan.pcd x.pcd -surface own.slim
expect 2 'overwritten' pcl_color_splat_sampling bare.pcd own.pcd -surface own.pcd
absent x.pcd x.slim

finish
