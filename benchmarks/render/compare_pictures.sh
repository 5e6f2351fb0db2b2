#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of docs/slim_deviation.md, and of standard errors: compare_pictures.sh BIN DATA OUT, folders of the built programs, of real scans and for
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

# Two halves of one scan: every other point.
"$bin/pcl_slim_curvature" "$data/lion_takanawa.pcd" lion.pcd -quiet  # a file that is not compressed
head=$(sed '/^DATA/q' lion.pcd | wc -c) values=$(sed -n '/^FIELDS/ { s/^FIELDS //p; q }' lion.pcd | wc -w)
tail -c "+$((head + 1))" lion.pcd | od -An -v "-w$((4 * values))" -t f4 |
  awk '{ print $1, $2, $3 > (NR % 2 ? "odd.xyz" : "even.xyz") }'
compare odd.xyz even.xyz -picture halves.png -unit m

# A part as drawn, from its scan.
compare "$data/fandisk_03_original.ply" "$data/fandisk_03_noisy.ply" -faces a -picture part.png

montage -font "$font" -pointsize 15 -label 'a dent of 1.5 mm' dent.png -label 'raw scans from their mesh' bunny.png \
  -label 'half of a scan from the other' halves.png -label 'a drawing from a noisy scan' part.png -tile 2x -geometry +2+2 \
  "${png[@]}" "$out/deviations.png"

# Standard errors of a laser scan's statue and a depth camera's table.
for scan in stanford_bunny_raw_scans kinect_mosd_learn13; do
  "$bin/pcl_slim_fit" "$data/$scan.pcd" $scan.slim -quiet
  "$bin/pcl_slim_render" $scan.slim $scan.png -mode uncertainty -bar -unit m -size 560x420 -white 1 -quiet
done
convert stanford_bunny_raw_scans.png kinect_mosd_learn13.png +append "${png[@]}" "$out/uncertainty.png"
