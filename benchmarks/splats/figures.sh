#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of benchmarks/README.md: figures.sh BIN DATA OUT, folders of the built programs, of real
# scans and for the pictures. Needs ImageMagick's montage and fontconfig.
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: figures.sh BIN DATA OUT" >&2; exit 2; }
bin=$1 data=$2 out=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p -- "$out" "$work/duck" "$work/lion"
font=$(fc-match -f '%{file}' sans)
eye=0.6672,-0.3336,0.7784
near_eye=1.13,-1.23,1.17,0.67,-0.30,0.745,0,0,1,22
near_head=7.176,0.960,0.808,-0.600,2.777,0.336,-0.198,0.063,0.978,11

count() { sed -n 's/.*"splats": \([0-9]*\).*/\1/p' "$1"; }

# render SPLATS NAME OPTIONS...: NAME.png and NAME.json in the folder of pictures' parts.
# Colours are bare unless light is wanted.
render() {
  local light=(-lighting 0)
  [[ " $* " != *" -lighting "* ]] || light=()
  "$bin/pcl_slim_render" "$1" "$work/$2.png" -json "$work/$2.json" -white 1 -quiet 1 "${light[@]}" "${@:3}"
}

# sheet PICTURE COLUMNS (LABEL NAME)...: parts side by side.
sheet() {
  local picture=$1 columns=$2 parts=()
  shift 2
  while [ $# -gt 0 ]; do
    parts+=(-label "$1" "$work/$2.png")
    shift 2
  done
  montage -font "$font" -pointsize 15 "${parts[@]}" -tile "${columns}x" -geometry +3+3 \
    -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/$picture"
}

"$bin/splat_object" "$work/duck.pcd"
"$bin/splat_quality" "$work/duck.pcd" -save "$work/duck" -focus $eye,0.12
"$bin/splat_quality" "$data/lion_takanawa.pcd" -save "$work/lion"

# Fig. 13: the same number of splats, spread three ways.
for name in all_points uniform geometry_only geometry_and_colour; do
  render "$work/duck/$name.ply" "duck_$name" -size 360x300 -view 20,12
  render "$work/duck/$name.ply" "eye_$name" -size 360x270 -camera $near_eye
done
sheet splats_eye.png 4 \
  "all $(count "$work/duck_all_points.json") points" duck_all_points \
  "uniform: $(count "$work/duck_uniform.json") splats" duck_uniform \
  "geometry only: $(count "$work/duck_geometry_only.json")" duck_geometry_only \
  "geometry and colour: $(count "$work/duck_geometry_and_colour.json")" duck_geometry_and_colour \
  '' eye_all_points '' eye_uniform '' eye_geometry_only '' eye_geometry_and_colour

# A scan: uniform, the budget, the published method.
for name in all_points uniform budget budget_gradient paper; do
  render "$work/lion/$name.ply" "lion_$name" -size 256x256 -camera $near_head
done
sheet splats_lion.png 5 "all $(count "$work/lion_all_points.json") points" lion_all_points \
  "uniform: $(count "$work/lion_uniform.json") splats" lion_uniform \
  "budget: $(count "$work/lion_budget.json")" lion_budget \
  "budget, gradient: $(count "$work/lion_budget_gradient.json")" lion_budget_gradient \
  "paper: $(count "$work/lion_paper.json")" lion_paper

# Fig. 3 and 10: the same splats unfiltered, filtered, lit, and by size.
splats=$work/duck/budget.ply
near_side=-1.35,-2.6,0.9,-0.25,0,0.1,0,0,1,24
render "$splats" unfiltered -size 360x300 -camera $near_side -filtered 0 -aa 1
render "$splats" filtered -size 360x300 -camera $near_side
render "$splats" lit -size 360x300 -camera $near_side -lighting 1
render "$splats" size -size 360x300 -camera $near_side -mode size -filtered 0
sheet splats_modes.png 4 '-filtered 0' unfiltered '-filtered 1' filtered '-lighting 1' lit \
  '-mode size: red small, blue large' size

# Figs. 11 and 12: the two tolerances, one at a time, on the feathers and near the eye. Figs. 7 and 8: the grid, divided
# by shape, and by colour too.
# sample NAME CAMERA OPTIONS...: splats of the duck.
sample() {
  "$bin/pcl_color_splat_sampling" "$work/duck.pcd" "$work/$1.pcd" -rays 0 -quiet 1 "${@:3}"
  render "$work/$1.pcd" "$1" -size 330x275 -camera "$2" -lighting 1
}
thresholds=()
for pair in '.3 .2' '.2 .2' '.1 .2' '.08 .2' '.2 1' '.2 .15' '.2 .1' '.2 .05'; do
  read -r geo color <<< "$pair"
  camera=$near_eye
  [ ${#thresholds[@]} -ge 8 ] || camera=$near_side
  sample "at${geo}_$color" "$camera" -geo "$geo" -color "$color"
  thresholds+=("-geo $geo -color $color: $(count "$work/at${geo}_$color.json")" "at${geo}_$color")
done
sheet splats_thresholds.png 4 "${thresholds[@]}"
for step in 'grid -max_depth 0' 'shape -color 1' 'both -color .1'; do
  read -r name options <<< "$step"
  # shellcheck disable=SC2086
  sample "step_$name" $near_side $options
  render "$work/step_$name.pcd" "step_${name}_size" -size 330x275 -camera $near_side -mode size -filtered 0
done
render "$work/duck/all_points.ply" step_cloud -size 330x275 -camera $near_side -lighting 1
convert -size 330x275 xc:white "$work/step_blank.png"
sheet splats_steps.png 4 "$(count "$work/step_cloud.json") points" step_cloud \
  "uniform grid: $(count "$work/step_grid.json") splats" step_grid \
  "divided by shape: $(count "$work/step_shape.json")" step_shape \
  "by shape and colour: $(count "$work/step_both.json")" step_both \
  '' step_blank 'by size: red small, blue large' step_grid_size 'by size' step_shape_size 'by size' step_both_size

# Fig. 14: a second model, one tolerance of shape, two of colour.
heads=("all $(count "$work/lion_all_points.json") points" lion_near)
bodies=('' lion_whole)
render "$work/lion/all_points.ply" lion_near -size 380x380 -camera $near_head
render "$work/lion/all_points.ply" lion_whole -size 380x300 -view 30,10
for color in .3 .08; do
  "$bin/pcl_color_splat_sampling" "$data/lion_takanawa.pcd" "$work/lion_$color.pcd" -rays 0 -quiet 1 -geo .15 -color $color
  render "$work/lion_$color.pcd" "lion_near$color" -size 380x380 -camera $near_head
  render "$work/lion_$color.pcd" "lion_whole$color" -size 380x300 -view 30,10
  heads+=("-geo .15 -color $color: $(count "$work/lion_near$color.json") splats" "lion_near$color")
  bodies+=('' "lion_whole$color")
done
sheet splats_second.png 3 "${heads[@]}" "${bodies[@]}"

# Noisy points: splats of them as they are, and smoothed first.
"$bin/splat_object" "$work/noisy.pcd" -noise .004
"$bin/pcl_slim_smooth" "$work/noisy.pcd" "$work/smoothed.pcd" -quiet 1
for cloud in noisy smoothed duck; do
  "$bin/pcl_color_splat_sampling" "$work/$cloud.pcd" "$work/${cloud}_splats.pcd" -rays 0 -quiet 1
  render "$work/${cloud}_splats.pcd" "${cloud}_lit" -size 400x330 -camera $near_side -lighting 1
done
sheet splats_smoothed.png 3 "noisy points: $(count "$work/noisy_lit.json") splats" noisy_lit \
  "smoothed first: $(count "$work/smoothed_lit.json")" smoothed_lit "points without noise: $(count "$work/duck_lit.json")" duck_lit
