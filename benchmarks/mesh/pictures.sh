#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Noisy meshes, smoothed in four ways: docs/images/meshes.png.
# pictures.sh BIN DATA OUT [MESHES]: folders of the built programs, of the pairs, for the picture, and of
# meshes that `mesh_bench -save` kept before. Needs ImageMagick and fontconfig.
set -euo pipefail
[ $# -ge 3 ] || { echo "usage: pictures.sh BIN DATA OUT [MESHES]" >&2; exit 2; }
bin=$1 data=$2 out=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
meshes=${4-$work/meshes}
mkdir -p -- "$out" "$meshes"
[ -n "${4-}" ] || "$bin/mesh_bench" "$data" -filters paper -save "$meshes" > "$work/table.md"
parts=()

# row LABEL PAIR OPTIONS: noisy, by the bilateral filter at its best, and by SLIM surfaces in three ways.
row() {
  local picture
  for picture in "noisy=$data/$2_noisy.ply" "bilateral=$(first "$2 Jones")" \
    "plain projection=$(first "$2 plain projection")" "projected centroids=$meshes/$2 SLIM, -paper 1.ply" \
    "SLIMMeshSmoother=$meshes/$2 SLIM, default.ply"; do
    local name=$work/${#parts[@]}.png
    # shellcheck disable=SC2086
    "$bin/mesh_picture" "${picture#*=}" "$name" -size 300 $3
    parts+=(-label "$1, ${picture%%=*}" "$name")
  done
}
# first NAME: the method's mesh of least distance.
first() {
  local file="$meshes/$1, best RMS.ply"
  [ -f "$file" ] || file="$meshes/$1.ply"
  echo "$file"
}

row julius julius_02 "-eye 0.25,0.06,-1 -up 0,1,0 -middle 0.02,0.02,0 -width 0.55"
row fandisk fandisk_03 "-eye 0.5,0.6,0.7 -up 0,1,0 -middle 2.4,14.5,-1.3 -width 6"
row block block_04 "-eye 1,0.7,0.7 -up 0,1,0 -middle 1.7,0,0 -width 42"
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 13 "${parts[@]}" -tile 5x -geometry +2+2 \
  "$work/all.png"
convert "$work/all.png" -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/meshes.png"
