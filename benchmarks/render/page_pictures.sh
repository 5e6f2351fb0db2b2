#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of the pages of meshes, lines, outliers, samples, colours, thin parts and files of points:
# page_pictures.sh BIN DATA OUT, folders of the built programs, of real scans and for the pictures. Needs
# ImageMagick, fontconfig and rsvg-convert.
set -euo pipefail
# shellcheck source=benchmarks/render/picture_folders.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/picture_folders.sh"

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

# Meshes: three scans, and a part with sharp edges.
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

# Lines of a scan.
"$bin/pcl_slim_lines" "$data/stanford_dragon_res2.ply" lines.svg -strength 1 -quiet 1
rsvg-convert -w 1000 -b white lines.svg -o lines.png
convert lines.png "${png[@]}" "$out/lines_dragon.png"

# points NAME KIND: made clouds as text. Numbers are drawn by Park and Miller's generator, so that any awk makes the same.
points() {
  awk -v kind="$2" 'function u() { s = (16807 * s) % 2147483647; return s / 2147483647 }
    function g() { return sqrt(-2 * log(u())) * cos(6.283185307179586 * u()) }
    BEGIN {
      s = 1
      if (kind == "outliers") {
        for (i = 0; i < 50000; ++i) {
          z = 1 - (2 * i + 1) / 50000; a = 2.399963229728653 * i; r = sqrt(1 - z * z)
          printf "%.4f %.4f %.4f\n", r * cos(a) + .005 * g(), r * sin(a) + .005 * g(), z + .005 * g()
        }
        for (i = 0; i < 5555; ++i) printf "%.4f %.4f %.4f\n", 2.4 * u() - 1.2, 2.4 * u() - 1.2, 2.4 * u() - 1.2
      } else if (kind == "blade") {  # 30 degrees, and a ball on its upper face
        for (i = 0; i < 8280; ++i) {
          j = i % 4140; y = 50 * ((.6180339887498949 * j) % 1)
          printf "%.4f %.4f %.4f\n", 80 * (j + .5) / 4140 + .1 * g(), y + .1 * g(), (i < 4140 ? .268 : -.268) * y + .1 * g()
        }
        for (i = 0; i < 2827; ++i) {
          z = 1 - (2 * i + 1) / 2827; a = 2.399963229728653 * i; r = 15 * sqrt(1 - z * z)
          printf "%.4f %.4f %.4f\n", 40 + r * cos(a) + .1 * g(), 26.12 + r * sin(a) + .1 * g(),
            22.53 + 15 * z + .1 * g()
        }
      } else {
        for (i = 0; i < 9800; ++i) {
          j = i % 4900
          printf "%.4f %.4f %.4f\n", 70 * (j + .5) / 4900 + .3 * g(), 70 * ((.6180339887498949 * j) % 1) + .3 * g(),
            3 * (i >= 4900) + .3 * g()
        }
      }
    }' > "$1"
}

# Outliers fitted and left out, seen alike.
points outliers.xyz outliers
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
points plates.xyz plates
slice scanned < plates.xyz
for sides in 0 1; do
  "$bin/pcl_slim_smooth" plates.xyz plates_$sides.pcd -sides $sides -quiet 1
  numbers plates_$sides.pcd | slice plates_$sides
done
sheet thin_plates.png 'the points' scanned 'smoothed, -sides 0' plates_0 'smoothed by default' plates_1

# A blade and a ball on it.
points blade.xyz blade
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
sheet sample.png '35 947 points of a scan' scan_points '6000 points, evenly spread' even_points

# A coloured scan: as clay, in its colours, under two lights.
"$bin/pcl_slim_fit" "$data/lion_takanawa.pcd" lion.slim -quiet 1
"$bin/pcl_slim_render" lion.slim clay.png -size 400x420 -view 30,10 -save_camera clay.txt -quiet 1
for mode in shaded color raytraced; do
  "$bin/pcl_slim_render" lion.slim clay_$mode.png -size 400x420 -white 1 -mode $mode -quiet 1 \
    -camera "$(awk -F, '{ OFS = ","; $10 = 34; print }' clay.txt)"
done
sheet surface_colors.png '-mode shaded' clay_shaded '-mode color' clay_color '-mode raytraced' clay_raytraced

# The demo's scan, and one of .las, as coloured discs.
"$bin/pcl_slim_demo_scan" scan.pcd -quiet 1
"$bin/pcl_color_splat_sampling" scan.pcd splats.pcd -rays 0 -max_splats 60000 -quiet 1
"$bin/pcl_slim_render" splats.pcd demo.png -size 420x420 -mode color -lighting 0 -quiet 1
convert demo.png "${png[@]}" "$out/demo_scan.png"
"$bin/pcl_slim_curvature" "$data/autzen_stadium.pcd" stadium.las -quiet 1
"$bin/pcl_color_splat_sampling" stadium.las stadium.pcd -rays 0 -max_splats 60000 -quiet 1
"$bin/pcl_slim_render" stadium.pcd stadium.png -size 900x560 -mode color -lighting 0 -white 1 -quiet 1
convert stadium.png "${png[@]}" "$out/point_files.png"
