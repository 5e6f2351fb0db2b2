#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The picture of Fig. 10 in docs/paper.md, levels of detail: levels.sh BIN DATA OUT, folders of the built programs,
# of real scans and for the picture. Needs ImageMagick and fontconfig.
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: levels.sh BIN DATA OUT" >&2; exit 2; }
bin=$1 data=$2 out=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p -- "$out"
render() { "$bin/pcl_slim_render" "$work/dragon.slim" -size 600x480 -white 1 -quiet 1 "$@"; }

"$bin/pcl_slim_fit" "$data/stanford_dragon_res2.ply" "$work/dragon.slim" -degree 2 -paper 1 -t_mdl 0.01 -quiet 1
render "$work/whole.png" -save_camera "$work/near.txt"
parts=()
for detail in 0 1; do
  for far in 1 4 12; do
    # The camera steps back from what it looks at; the middle of its picture is shown as large.
    awk -F, -v far=$far '{
      for (i = 1; i <= 3; ++i) printf "%.17g,", $(i + 3) + far * ($i - $(i + 3))
      for (i = 4; i <= 9; ++i) printf "%s,", $i
      print $10
    }' "$work/near.txt" > "$work/camera.txt"
    name=$work/${detail}_$far
    render "$name.png" -lod $detail -camera "$work/camera.txt" -repeat 5 -json "$name.json"
    convert "$name.png" -gravity center -crop $((600 / far))x$((480 / far))+0+0 +repage -filter box \
      -resize 300x240 "$name.part.png"
    frame=$(sed -n 's/.*"frame": \([0-9.e-]*\).*/\1/p' "$name.json" | awk '{ printf "%.1f", 1000 * $1 }')
    parts+=(-label "-lod $detail, $far times as far: $frame ms" "$name.part.png")
  done
done
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 13 "${parts[@]}" -tile 3x -geometry +3+3 "$work/all.png"
convert "$work/all.png" -define png:color-type=2 -define png:compression-level=9 "$out/paper_fig10.png"
