#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of docs/tiles.md: tile_pictures.sh BIN DATA OUT, folders of the built programs, of real scans (none is used)
# and for the pictures. Needs ImageMagick, fontconfig, 10 GB of memory for one fit and 2 GB of the disk.
set -euo pipefail
# shellcheck source=benchmarks/render/picture_folders.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/picture_folders.sh"

# render SURFACE PICTURE OPTIONS...
render() { "$bin/pcl_slim_render" "$1.slim" "$2.png" -quiet 1 "${@:3}"; }

# Where four tiles meet: on the axis through the box's middle.
"$bin/scale_bench" make statue 10000000 0.0005 statue.ply
"$bin/pcl_slim_fit" statue.ply tiled.slim -tile_points 2500000 -trim 0 -quiet 1
"$bin/pcl_slim_fit" statue.ply whole.slim -tile_points 0 -trim 0 -quiet 1
for name in tiled whole; do
  render $name $name -size 480x400 -mode mean -range 2 -camera .029,-6,0,.029,0,0,0,0,1,10
done
montage tiled.png whole.png -tile 2x -geometry +2+2 "${png[@]}" "$out/tiles_seam.png"

# As the caption says.
"$bin/scale_bench" make statue 100000000 0.0005 statue.ply
"$bin/pcl_slim_fit" statue.ply statue.slim -max_memory 400 -threads 1 -trim 0 -quiet 1
render statue shaded -size 360x480
render statue level -size 360x480 -mode level
montage shaded.png level.png -tile 2x -geometry +2+2 "${png[@]}" "$out/tiles_100m.png"
