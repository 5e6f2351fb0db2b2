#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of the pages of meshes, lines, outliers, samples, colours, thin parts and files of points:
# page_pictures.sh BIN DATA OUT, folders of the built programs, of real scans and for the pictures. Needs
# ImageMagick, fontconfig and rsvg-convert.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=benchmarks/render/picture_folders.sh
source "$here/picture_folders.sh"

# sheet PICTURE (LABEL NAME)...: parts side by side; parts without labels have none below.
sheet() {
  local picture=$1 parts=()
  shift
  while [ $# -gt 0 ]; do
    [ -z "$1" ] || parts+=(-label "$1")
    parts+=("$2.png")
    shift 2
  done
  montage -font "$font" -pointsize 15 "${parts[@]}" -tile x1 -geometry +2+2 "${png[@]}" "$out/$picture"
}

# Meshes: three scans, a part with sharp edges, and the holes in a base.
mesh() { "$bin/pcl_slim_mesh" "$data/$1" "$2.ply" -quiet 1 "${@:3}"; }
draw() { "$bin/mesh_picture" "$1.ply" "$1.png" "${@:2}"; }
mesh stanford_dragon_res2.ply dragon
draw dragon -eye 0.3,0.15,1 -up 0,1,0 -middle -0.006,0.125,-0.005 -width 0.225 -size 440
mesh lion_takanawa.pcd lion
draw lion -eye 1,-0.25,0.15 -up 0,0,1 -middle -2.9,3.85,-1.15 -width 6.6 -size 440
mesh kinect_mosd_learn13.pcd kinect
draw kinect -eye 0,-0.25,-1 -up 0,-1,0 -middle -0.05,-0.06,0.95 -width 1.2 -size 440
sheet mesh_scans.png 'Dragon' dragon 'Lion' lion 'Table, one Kinect frame' kinect
mesh fandisk_03_noisy.ply rounded
mesh fandisk_03_noisy.ply noisy -sharp 1
mesh fandisk_03_original.ply original -sharp 1
for name in rounded noisy original; do
  draw $name -eye 0.5,0.6,0.7 -up 0,1,0 -middle 2.4,14.5,-1.3 -width 5.6 -size 420
done
sheet mesh_sharp.png 'with noise' rounded 'with noise, -sharp 1' noisy 'without noise, -sharp 1' original
for name in open watertight; do
  mesh stanford_bunny_zipper.ply $name -watertight "$([ $name = open ] && echo 0 || echo 1)"
  draw $name -eye 0.1,-1,0.35 -up 0,0,1 -middle -0.017,0.034,0.027 -width 0.17 -size 440
done
sheet mesh_watertight.png 'by default' open '-watertight 1' watertight

# Lines of a scan.
"$bin/pcl_slim_lines" "$data/stanford_dragon_res2.ply" lines.svg -strength 1 -quiet 1
rsvg-convert -w 1000 -b white lines.svg -o lines.png
convert lines.png "${png[@]}" "$out/lines_dragon.png"

# Outliers fitted and left out, seen alike.
"$here/made_points.sh" outliers > outliers.xyz
for keep in 1 0; do
  "$bin/pcl_slim_fit" outliers.xyz outliers_$keep.slim -outliers $keep -quiet 1
  "$bin/pcl_slim_render" outliers_$keep.slim outliers_$keep.png -size 420x420 -white 1 -quiet 1 \
    -camera 2.6,-4.6,1.9,0,0,0,0,0,1,42
done
sheet outliers.png '-outliers 1' outliers_1 'by default' outliers_0

# Two plates seen from their edge: a slice of their points.
# slice NAME: NAME.png of lines x y z.
slice() {
  awk '
    BEGIN { print "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"500\" height=\"160\"><g fill=\"#1f4e79\">" }
    $1 > 34 && $1 < 37 && $2 > 8 && $2 < 62 {
      printf "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"3\"/>\n", 30 + 8.15 * ($2 - 8), 105 - 16.7 * $3
    }
    END { print "</g></svg>" }' > "$1.svg"
  rsvg-convert -b white "$1.svg" -o "$1.png"
}
# numbers FILE: the points of a binary PCD of x y z, one a line.
numbers() {
  local head size
  head=$(sed '/^DATA/q' "$1" | wc -c) size=$(sed -n '/^SIZE/ { s/.* //p; q }' "$1")
  tail -c "+$((head + 1))" "$1" | od -An -v "-w$((3 * size))" -t "f$size"
}
"$here/made_points.sh" plates > plates.xyz
slice scanned < plates.xyz
for sides in 0 1; do
  "$bin/pcl_slim_smooth" plates.xyz plates_$sides.pcd -sides $sides -quiet 1
  numbers plates_$sides.pcd | slice plates_$sides
done
sheet thin_plates.png 'the points' scanned 'smoothed, -sides 0' plates_0 'smoothed by default' plates_1

# A blade and a ball on it.
"$here/made_points.sh" blade > blade.xyz
for sides in 0 1; do
  "$bin/pcl_slim_fit" blade.xyz blade_$sides.slim -sides $sides -quiet 1
  "$bin/pcl_slim_render" blade_$sides.slim blade_$sides.png -size 560x400 -white 1 -quiet 1 -view 60,5 -up z
done
sheet thin_blade.png '-sides 0' blade_0 'by default' blade_1

# A noisy cow of the denoising protocol.
"$bin/denoise_bench" "$data/denoise" -meshes cow -points 50000 -noise 0.03 -jets 0 -mls 0 -bounds 0 -save . > /dev/null
"$bin/point_discs" cow_50000_0.03.xyz cow_discs.pcd -radius 0.004
"$bin/pcl_slim_render" cow_discs.pcd cow_points.png -size 420x330 -white 1 -mode color -lighting 0 -filtered 0 \
  -view 60,10 -up y -quiet 1
mogrify -level 50%,100% cow_points.png
for sides in 0 1; do
  "$bin/pcl_slim_fit" cow_50000_0.03.xyz cow_$sides.slim -sides $sides -quiet 1
  "$bin/pcl_slim_render" cow_$sides.slim cow_$sides.png -size 420x330 -white 1 -quiet 1 -view 60,10 -up y
done
sheet thin_cow.png 'the points' cow_points '-sides 0' cow_0 'by default' cow_1

# A chair of it, whose thinnest parts are two deviations of the noise thick.
"$bin/denoise_bench" "$data/denoise" -meshes chair -points 50000 -noise 0.01 -jets 0 -mls 0 -bounds 0 -save . > /dev/null
"$bin/pcl_slim_fit" chair_50000_0.01.xyz chair.slim -quiet 1
for sides in front auto; do
  "$bin/pcl_slim_render" chair.slim chair_$sides.png -size 420x420 -white 1 -quiet 1 -view 25,15 -up y -sides $sides
done
sheet thin_chair.png '-sides front' chair_front 'by default' chair_auto

# Points spread evenly: those of a scan, and 6000 on its surface, as small discs.
bunny=$data/stanford_bunny_zipper.ply
"$bin/pcl_slim_sample" "$bunny" even.pcd -number 6000 -quiet 1
"$bin/point_discs" "$bunny" scan_discs.pcd -radius 0.00025
"$bin/point_discs" even.pcd even_discs.pcd -radius 0.0006
for name in scan even; do
  "$bin/pcl_slim_render" ${name}_discs.pcd ${name}_points.png -size 500x480 -white 1 -mode color -lighting 0 \
    -filtered 0 -view 0,5 -up y -quiet 1
  mogrify -level 60%,100% ${name}_points.png
done
# count FILE: the points of a file that its header announces.
count() { sed -n '/^POINTS\|^element vertex/ { s/.* //p; q }' "$1"; }
sheet sample.png "$(count "$bunny") points of a scan" scan_points "$(count even.pcd) points, evenly spread" even_points

# A coloured scan: as clay, in its colours, under two lights.
"$bin/pcl_slim_fit" "$data/lion_takanawa.pcd" lion.slim -quiet 1
"$bin/pcl_slim_render" lion.slim clay.png -mode shaded -size 400x420 -view 30,10 -save_camera clay.txt -quiet 1
for mode in shaded color raytraced; do
  "$bin/pcl_slim_render" lion.slim clay_$mode.png -size 400x420 -white 1 -mode $mode -quiet 1 \
    -camera "$(awk -F, '{ OFS = ","; $10 = 34; print }' clay.txt)"
done
sheet surface_colors.png '-mode shaded' clay_shaded '-mode color' clay_color '-mode raytraced' clay_raytraced

# A scan of .las as coloured discs.
"$bin/pcl_slim_curvature" "$data/autzen_stadium.pcd" stadium.las -quiet 1
"$bin/pcl_color_splat_sampling" stadium.las stadium.pcd -rays 0 -max_splats 60000 -quiet 1
"$bin/pcl_slim_render" stadium.pcd stadium.png -size 900x560 -mode color -lighting 0 -white 1 -quiet 1
convert stadium.png "${png[@]}" "$out/point_files.png"

# A wood from the air: trees and ground as one noise, and apart.
"$here/terrain_sample.sh" "$bin" "$data/terrain_isprs_csite1_utm.pcd" 40000 > terrain.xyz
"$bin/pcl_slim_fit" terrain.xyz trees_as_noise.slim -sides 0 -quiet 1
"$bin/pcl_slim_fit" terrain.xyz trees_kept.slim -quiet 1
for name in trees_as_noise trees_kept; do
  "$bin/pcl_slim_render" $name.slim $name.png -size 640x356 -view 25,25 -up z -quiet 1
  convert $name.png "${png[@]}" "$out/$name.png"
done
