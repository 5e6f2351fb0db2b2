#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The rows and pictures of benchmarks/README.md: figures.sh PROGRAMS FOLDER [PICTURES].
# Needs ImageMagick's montage and fontconfig.
set -euo pipefail
bin=$1
work=$2
pictures=${3-$work}
mkdir -p -- "$work"

"$bin/rays_model" "$work/points.ply" -points 1000000
for noise in 1e-7 1e-8 1.44e-9; do
  "$bin/pcl_slim_fit" "$work/points.ply" "$work/$noise.slim" -degree 2 -lambda $noise -quiet 1
done

echo "| renderer | primitives | depth / L | normal, degrees | shade | pixels missed | ms |"
echo "|---|---|---|---|---|---|---|"
for noise in 1e-7 1e-8 1.44e-9; do
  "$bin/qsplat_bench" "$work/$noise.slim"
  "$bin/qsplat_bench" "$work/$noise.slim" -per_leaf 1.714 | head -n 1
done
echo "six times nearer:"
"$bin/qsplat_bench" "$work/1e-8.slim" -zoom 6 -pictures "$work/near"
"$bin/qsplat_bench" "$work/1e-8.slim" -zoom 6 -per_leaf 1.714 | head -n 1
for name in exact qsplat slim; do
  convert "$work/near_$name.png" -crop 420x420+90+90 +repage "$work/near_$name.png"
done
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 15 -label 'the surface' "$work/near_exact.png" \
  -label 'QSplat' "$work/near_qsplat.png" -label 'quadratic leaves' "$work/near_slim.png" -tile 3x -geometry 300x300+2+2 -depth 8 \
  -define png:compression-level=9 -define png:exclude-chunks=date,time "PNG24:$pictures/qsplat_near.png"
"$bin/rays_bench" "$work/1.44e-9.slim" -repeat 3
