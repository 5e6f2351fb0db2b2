#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What a frame of splats costs, and how far it is from all points' picture, over their number, as Markdown: frames.sh BIN,
# the folder of the built programs. The duck of splat_object, 1000 x 1000 pixels, one ray a pixel, one thread, best of five.
# Needs ImageMagick.
set -euo pipefail
[ $# -eq 1 ] || { echo "usage: frames.sh BIN" >&2; exit 2; }
bin=$1
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
# A place of the object and one of the eye: X,Y,Z of the camera, of what it looks at, of up, and the field of view.
declare -A cameras=([whole]='3.2,-8.8,2.6,0.05,-0.12,0.18,0,0,1,17' [near]='1.13,-1.23,1.17,0.67,-0.30,0.745,0,0,1,22')

# frame NAME PLACE: NAME_PLACE.png, and its milliseconds.
frame() {
  for _ in 1 2 3 4 5; do
    "$bin/pcl_slim_render" "$work/$1" "$work/$1_$2.png" -size 1000x1000 -camera "${cameras[$2]}" -white 1 -aa 1 -lighting 0 \
      -threads 1 -quiet 1 -json "$work/frame.json"
    sed -n 's/.*"render": \([0-9.e-]*\).*/\1/p' "$work/frame.json"
  done | sort -g | awk 'NR == 1 { printf "%.0f", 1000 * $1 }'
}
# off NAME PLACE: root mean square difference to the picture of all, in 8-bit steps.
off() {
  compare -metric RMSE "$work/$1_$2.png" "$work/all_points.ply_$2.png" null: 2>&1 |
    sed 's/.*(\(.*\))/\1/' | awk '{ printf "%.1f", 255 * $1 }' || true
}

"$bin/splat_object" "$work/duck.pcd" > /dev/null
"$bin/splat_quality" "$work/duck.pcd" -save "$work" > /dev/null
echo '| splats | whole duck: ms a frame | colour off | near the eye: ms | colour off |'
echo '| --- | --- | --- | --- | --- |'
for name in all_points.ply 160000 80000 40000 20000 10000 5000; do
  [ $name = all_points.ply ] || {
    "$bin/pcl_color_splat_sampling" "$work/duck.pcd" "$work/$name.pcd" -rays 0 -quiet 1 -max_splats $name
    name+=.pcd
  }
  row=" $(frame $name whole) | $(off $name whole) | $(frame $name near) | $(off $name near) |"
  echo "| $(sed -n 's/.*"splats": \([0-9]*\).*/\1/p' "$work/frame.json" | head -n 1) |$row"
done
