#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of docs/slim_deviation.md: compare_pictures.sh BIN DATA OUT, folders of the built programs, of real scans and for
# the pictures. Needs ImageMagick and fontconfig.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=benchmarks/render/picture_folders.sh
source "$here/picture_folders.sh"

compare() { "$bin/pcl_slim_compare" "$@" -size 560x420 -white 1 -quiet 1; }

# A dent of known depth.
"$bin/pcl_slim_demo_scan" before.pcd -quiet
"$bin/pcl_slim_demo_scan" after.pcd -seed 2 -dent 0.0015 -quiet
compare after.pcd before.pcd -picture dent.png -view 30,10 -unit m

# Raw scans and the mesh that was made of them.
compare "$data/stanford_bunny_raw_scans.pcd" "$data/stanford_bunny_zipper.ply" -picture bunny.png -unit m

# A noisy scan and its truth.
compare "$data/julius_02_noisy.ply" "$data/julius_02_original.ply" -faces b -picture julius.png

montage -font "$font" -pointsize 15 -label 'a dent of 1.5 mm' dent.png -label 'raw scans from their mesh' bunny.png \
  -label 'a noisy scan from the truth' julius.png -tile x1 -geometry +2+2 "${png[@]}" "$out/deviations.png"
