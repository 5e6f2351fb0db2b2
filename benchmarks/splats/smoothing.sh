#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Scans before and after pcl_slim_smooth, each point a disc in the plane of its ten nearest neighbours:
# docs/images/smoothing.png. smoothing.sh BIN DATA OUT: folders of the built programs, of real scans
# and for the picture. Needs ImageMagick and fontconfig.
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: smoothing.sh BIN DATA OUT" >&2; exit 2; }
bin=$1 data=$2 out=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p -- "$out"
parts=()

# pair LABEL FILE SMOOTH_OPTIONS VIEWPOINT CAMERA: the scan before and after, seen from one place.
pair() {
  local after=$work/after.${2##*.} state
  # shellcheck disable=SC2086
  "$bin/pcl_slim_smooth" "$data/$2" "$after" -quiet 1 $3
  for state in before after; do
    local file=$after name=$work/${#parts[@]}.png
    [ "$state" = after ] || file=$data/$2
    "$bin/point_discs" "$file" "$work/discs.pcd" -viewpoint "$4"
    "$bin/pcl_slim_render" "$work/discs.pcd" "$name" -size 280x220 -white 1 -lighting 1 \
      -filtered 0 -camera "$5" -quiet 1
    parts+=(-label "$1, $state" "$name")
  done
}

pair bunny stanford_bunny_raw_scans.pcd "" 0,0.15,1 -0.06,0.14,0.35,-0.055,0.135,0,0,1,0,17
pair lion lion_takanawa.pcd "" 7,1,1 7.176,0.960,0.808,-0.600,2.777,0.336,-0.198,0.063,0.978,11
pair 'julius, -sharp 1' julius_02_noisy.ply "-sharp 1" 0,0,-1000 \
  0.5,0.1,-2.4,0.02,0.04,0,0,1,0,25
pair table kinect_mosd_learn13.pcd "" 0,0,0 0,-0.1,0.2,-0.05,-0.02,0.95,0,-1,0,30
pair 'fandisk, -sharp 1' fandisk_03_noisy.ply "-sharp 1" 20,30,20 \
  10,24,10,2.4,15.2,-1.3,0,1,0,19
pair 'block, -sharp 1' block_04_noisy.ply "-sharp 1" 60,30,40 60,40,40,1.7,0,0,0,1,0,24
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 13 "${parts[@]}" -tile 4x -geometry +2+2 \
  "$work/all.png"
convert "$work/all.png" -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/smoothing.png"
