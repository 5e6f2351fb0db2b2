#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of the tutorial and of the programs' pages that need no window: tutorial_pictures.sh BIN DATA OUT,
# folders of the built programs, of real scans and for the pictures. Needs ImageMagick and fontconfig.
set -euo pipefail
# shellcheck source=benchmarks/render/picture_folders.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/picture_folders.sh"

fit() { "$bin/pcl_slim_fit" "$1" "$2.slim" -quiet 1 "${@:3}"; }
render() { "$bin/pcl_slim_render" "$1" "$2.png" -white 1 -quiet 1 "${@:3}"; }
discs() { "$bin/pcl_color_splat_sampling" "$1" "$2.pcd" -quiet 1 -rays 0 "${@:3}"; }

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

# The amphora: surface, levels, sizes, curvature, smoothing, splats.
"$bin/pcl_slim_demo_scan" scan.pcd > /dev/null
fit scan.pcd surface
render surface.slim "$out/demo" -size 800x600
"$bin/pcl_slim_smooth" scan.pcd smooth.pcd -normals 1 -quiet 1
discs scan.pcd splats -max_splats 20000
discs scan.pcd before -geo .02 -color 1 -remove_noise 0
discs smooth.pcd after -geo .02 -color 1 -remove_noise 0
render surface.slim shaded -mode shaded -size 420x420 -save_camera amphora.txt
for mode in normal mean level size; do
  render surface.slim $mode -mode $mode -size 420x420 -bar 1 -unit m -camera amphora.txt
done
render splats.pcd color -mode color -lighting 0 -size 420x420 -camera amphora.txt
render splats.pcd lit -mode color -lighting 1 -size 420x420 -camera amphora.txt
render splats.pcd splat_size -mode size -size 420x420 -bar 1 -unit m -camera amphora.txt
for name in before after; do render $name.pcd $name -mode shaded -size 420x420 -camera amphora.txt; done
sheet levels_and_sizes.png 2 'level of each ball' level 'its size: red small, blue large' size
sheet tutorial_curvature.png 2 'the surface' shaded 'mean curvature: red bulges, blue hollows' mean
sheet tutorial_smoothing.png 2 'before' before 'after' after
sheet tutorial_splats.png 2 '20 000 splats in their colours' color 'by size: red small, blue large' splat_size
sheet render_modes.png 3 '-mode shaded' shaded '-mode normal' normal '-mode mean' mean '-mode level' level \
  '-mode size' size 'splats, -mode color -lighting 1' lit

# A depth camera's frame, its noise taken as white and as it is.
fit "$data/kinect_mosd_learn13.pcd" kinect_off -correlation off
fit "$data/kinect_mosd_learn13.pcd" kinect
render kinect.slim "$out/kinect_after" -size 640x480 -save_camera camera.txt
render kinect_off.slim "$out/kinect_before" -size 640x480 -camera camera.txt

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
