#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From a scan to pictures of splats: pcl_slim_demo_scan, pcl_color_splat_sampling and pcl_slim_render.
# Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"


expect 0 '' pcl_slim_demo_scan scan.pcd -points 6000
for extension in pcd ply; do
  expect 0 '' pcl_color_splat_sampling scan.pcd "splats.$extension" -max_splats 600 -rays 0
done
expect 0 '' pcl_color_splat_sampling scan.pcd gradient.ply -max_splats 600 -rays 0 -colors gradient
expect 0 '' pcl_slim_fit scan.pcd surface.pcd -color 0

# Both formats contain the same discs; threads change nothing, options do.
small="-size 96x72 -aa 1"
expect 0 '' pcl_slim_render splats.pcd color.png $small -json report.json -threads 1
grep -q '^> Loading splats.pcd \[done, .* splats\]' out.txt || complain "no Loading line"
expect 0 '' pcl_slim_render splats.ply ply.png $small -threads 4 -mode color -lighting 1
same color.png ply.png
for key in program version input points threads total load render peak_rss_mb splats gradient \
  covered_pixels overlap unusable outside_frustum camera; do
  grep -q "\"$key\"" report.json || complain "the report lacks $key"
done
for option in '-filtered 0' '-lighting 0' '-mode shaded' '-mode normal' '-mode size' '-ortho 1' \
  '-sides front' '-view top' '-white 1' '-mode raytraced'; do
  # shellcheck disable=SC2086
  expect 0 '' pcl_slim_render splats.pcd other.png $small $option
  [ "$option" = '-sides front' ] || differ color.png other.png
done
expect 0 '' pcl_slim_render gradient.ply gradient.png $small
differ color.png gradient.png

# Splats of a scan without colours are shaded, not a white silhouette.
awk 'BEGIN { for (i = 0; i < 4000; ++i) { z = 1 - (2 * i + 1) / 4000; r = sqrt(1 - z * z); a = 2.39996 * i
  print r * cos(a), r * sin(a), z } }' > ball.xyz
expect 0 '' pcl_color_splat_sampling ball.xyz ball.pcd -rays 0
expect 0 '' pcl_slim_render ball.pcd automatic.png $small
expect 0 '' pcl_slim_render ball.pcd shaded.png $small -mode shaded
same automatic.png shaded.png

# A file of another program: fields in another order, ascii, no colours; one disc has no place.
cat > foreign.pcd <<'END'
VERSION 0.7
FIELDS radius normal_x normal_y normal_z x y z
SIZE 4 4 4 4 8 8 8
TYPE F F F F F F F
COUNT 1 1 1 1 1 1 1
WIDTH 3
HEIGHT 1
POINTS 3
DATA ascii
0.5 0 0 1 4918360.25 637000.5 1
0.5 0 0 1 4918361.25 637000.5 1
0.5 0 0 1 nan 637000.5 1
END
expect 0 '' pcl_slim_render foreign.pcd foreign.png $small -json foreign.json
grep -q 'left out: 1 ' out.txt || complain "not said that a splat is left out"
grep -q '"splats": 2' foreign.json || complain "not two splats"
differ color.png foreign.png
sed '/nan/d; s/WIDTH 3/WIDTH 0/; s/POINTS 3/POINTS 0/; /^0.5/d' foreign.pcd > none.pcd
expect 0 '' pcl_slim_render none.pcd none.png $small

# Mistakes.
rm -f x.png
# Pages, of none at all too.
expect 0 '' pcl_slim_render gradient.ply page.html -json page.json
grep -q '"kind":"splats"' page.html || complain "page.html is no page of splats"
grep -q '"splats": [1-9]' page.json || complain "page.json does not count the splats"
expect 0 '' pcl_slim_render none.pcd none.html
expect 2 'no curvature' pcl_slim_render splats.pcd x.html -mode mean
absent x.html

expect 2 'no curvature' pcl_slim_render splats.pcd x.png -mode mean
expect 2 'no colours' pcl_slim_render surface.pcd x.png -mode color
expect 2 'neither a surface nor splats' pcl_slim_render scan.pcd x.png
sed 's/normal_y/other/' foreign.pcd > lacking.pcd
expect 2 'normal_y' pcl_slim_render lacking.pcd x.png
expect 2 'lighting' pcl_slim_render splats.pcd x.png -lighting 2
expect 2 'filtered' pcl_slim_render splats.pcd x.png -filtered yes
head -c 3000 splats.ply > cut.ply
expect 2 'cut.ply' pcl_slim_render cut.ply x.png
[ ! -e x.png ] || complain "x.png was left behind"

finish
