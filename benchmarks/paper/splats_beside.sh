#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The picture and the table of Fig. 18 in docs/paper.md, a scan with gaps as discs and as leaves: splats_beside.sh BIN
# DATA OUT, folders of the built programs, of real scans and for picture and table. Needs ImageMagick and fontconfig.
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: splats_beside.sh BIN DATA OUT" >&2; exit 2; }
bin=$1 data=$2 out=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p -- "$out"
"$bin/paper_bench" "$data" "$work" -figure 18
# count NAME: the primitives of the lion's row.
count() { awk -F ' *[|] *' -v name="$1" '$2 == "lion_takanawa" && $3 == name { print $4 }' "$work/fig18.md"; }
mogrify -filter box -resize 50% "$work"/fig18_*.png
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 15 \
  -label 'the points' "$work/fig18_points.png" \
  -label "$(count 'QSplat, as many') discs" "$work/fig18_discs.png" \
  -label "$(count 'QSplat, as many floats') discs" "$work/fig18_floats.png" \
  -label "$(count 'quadratic leaves') quadratic leaves" "$work/fig18_leaves.png" \
  -tile 4x -geometry +2+2 "$work/all.png"
convert "$work/all.png" +dither -colors 255 -define png:compression-level=9 -define png:exclude-chunks=date,time \
  "PNG8:$out/paper_fig18.png"
cat -- "$work/fig18.md"
