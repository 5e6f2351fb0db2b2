#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The picture and the table of Fig. 10 in docs/paper.md, levels of detail: levels.sh BIN OUT, folders of the built
# programs and for picture and table. Needs ImageMagick and fontconfig, and 1 GB of memory.
set -euo pipefail
[ $# -eq 2 ] || { echo "usage: levels.sh BIN OUT" >&2; exit 2; }
bin=$1 out=$2
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p -- "$out"
size="-size 730x650"
# shellcheck disable=SC2086 # an option and its value
render() { "$bin/pcl_slim_render" "$work/statue.slim" $size -white 1 -quiet 1 "$@"; }
field() { sed -n "s/.*\"$1\": \([0-9.e-]*\).*/\1/p" "$2" | head -n 1; }

"$bin/scale_bench" make statue 5000000 0 "$work/statue.ply" > /dev/null
"$bin/pcl_slim_fit" "$work/statue.ply" "$work/statue.slim" -tile_points 0 -degree 2 -lambda 1e-14 -quiet 1 \
  -json "$work/fit.json"
render "$work/whole.png" -save_camera "$work/near.txt"
parts=()
places=([1]=near [2]="2 times as far" [4]="4 times as far" [8]="8 times as far")
names=([0]="every leaf" [1]="-lod 1" [4]="-lod 4")
echo "| $(field leaves "$work/fit.json") leaves | every leaf, ms | 1 pixel | 2 | 4 | 8 |"
echo '| --- | --- | --- | --- | --- | --- |'
for far in 1 2 4 8; do
  # The camera steps back from what it looks at.
  awk -F, -v far=$far '{
    for (i = 1; i <= 3; ++i) printf "%.17g,", $(i + 3) + far * ($i - $(i + 3))
    for (i = 4; i <= 9; ++i) printf "%s,", $i
    print $10
  }' "$work/near.txt" > "$work/camera.txt"
  row="| $far times as far |"
  for detail in 0 1 2 4 8; do
    name=$work/${detail}_$far
    render "$name.png" -lod $detail -camera "$work/camera.txt" -threads 1
    # shellcheck disable=SC2086
    row+=" $("$bin/frame_times" "$work/statue.slim" $size -lod $detail -camera "$work/camera.txt" -repeat 5 -threads 1 |
      awk '{ printf "%.0f", 1000 * $2 }') |"
  done
  echo "$row"
done | tee "$out/fig10.md"
for detail in 0 1 4; do
  for far in 1 2 4 8; do
    name=$work/${detail}_$far
    # Far pictures are enlarged: their middle is shown as large as the near one.
    convert "$name.png" -gravity center -background white -extent $((420 / far))x$((740 / far)) \
      -filter box -resize 200x352! "$name.part.png"
    parts+=(-label "${names[detail]}, ${places[far]}" "$name.part.png")
  done
done
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 13 "${parts[@]}" -tile 4x -geometry +3+3 "$work/all.png"
convert "$work/all.png" -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/paper_fig10.png"
