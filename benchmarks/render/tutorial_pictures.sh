#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of the tutorial and of the programs' pages that need no window: tutorial_pictures.sh BIN DATA OUT,
# folders of the built programs, of real scans and for the pictures. Needs ImageMagick, fontconfig and python3.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
root=$(cd -- "$here/../.." && pwd)
# shellcheck source=benchmarks/render/picture_folders.sh
source "$here/picture_folders.sh"

fit() { "$bin/pcl_slim_fit" "$1" "$2.slim" -quiet 1 "${@:3}"; }
render() { "$bin/pcl_slim_render" "$1" "$2.png" -white 1 -quiet 1 "${@:3}"; }

# sheet PICTURE COLUMNS (LABEL NAME)...: parts side by side.
sheet() {
  local picture=$1 columns=$2 parts=()
  shift 2
  while [ $# -gt 0 ]; do
    parts+=(-label "$1" "$2.png")
    shift 2
  done
  montage -font "$font" -pointsize 15 "${parts[@]}" -tile "${columns}x" -geometry +3+3 \
    "${png[@]}" "$out/$picture"
}

# The amphora: the tutorial's commands, as its test runs them.
(cd -- "$root" && python3 tests/pages_test.py "$bin" "$work" "$data" docs/tutorial.md)
convert tutorial/scan.png "${png[@]}" "$out/demo_scan.png"
convert tutorial/surface.png "${png[@]}" "$out/tutorial_surface.png"
render tutorial/surface.slim hero -size 420x520 -save_camera hero.txt
render tutorial/discs.pcd hero_points -size 420x520 -camera hero.txt -lighting 0 -filtered 0
render tutorial/surface.slim hero_curvature -size 520x520 -mode mean -bar -unit m
sheet demo.png 3 '200,000 noisy points' hero_points 'a surface of 6,484 patches' hero 'its mean curvature' hero_curvature
for name in levels_and_sizes tutorial_smoothing tutorial_curvature tutorial_splats; do
  convert "tutorial/$name.png" "${png[@]}" "$out/$name.png"
done
for mode in shaded normal mean level size; do
  render tutorial/surface.slim $mode -mode $mode -size 420x420 -bar 1 -unit m -camera tutorial/camera.txt
done
render tutorial/splats.pcd lit -mode color -lighting 1 -size 420x420 -camera tutorial/camera.txt
sheet render_modes.png 3 '-mode shaded' shaded '-mode normal' normal '-mode mean' mean '-mode level' level \
  '-mode size' size 'splats, -mode color -lighting 1' lit

# A depth camera's frame, its noise taken as white and as it is.
fit "$data/kinect_mosd_learn13.pcd" kinect_off -correlation off
fit "$data/kinect_mosd_learn13.pcd" kinect
render kinect.slim "$out/kinect_after" -mode shaded -size 640x480 -save_camera camera.txt
render kinect_off.slim "$out/kinect_before" -mode shaded -size 640x480 -camera camera.txt

# Lines in pictures, at several levels of detail too, and a traced picture.
fit "$data/stanford_dragon_res2.ply" dragon
fit "$data/lion_takanawa.pcd" lion
fit "$data/angel_real_scan.ply" angel
fit "$data/armadillo_50k.ply" armadillo
for name in dragon lion angel; do render $name.slim sketch_$name -mode sketch -size 720x600; done
render armadillo.slim sketch_armadillo -mode sketch -size 720x600 -view 180,5
sheet picture_lines.png 2 'dragon' sketch_dragon 'lion' sketch_lion 'angel' sketch_angel 'Armadillo' sketch_armadillo
for lines in crest suggestive; do
  for lod in 0 2 5; do render dragon.slim ${lines}_$lod -lines $lines -lod $lod -size 400x330; done
done
sheet picture_lines_lod.png 3 '-lines crest' crest_0 '-lod 2' crest_2 '-lod 5' crest_5 \
  '-lines suggestive' suggestive_0 '-lod 2' suggestive_2 '-lod 5' suggestive_5
render dragon.slim "$out/raytraced_dragon" -mode raytraced -aa 4 -size 900x640
