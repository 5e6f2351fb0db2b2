#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_demo_scan, pcl_slim_fit and pcl_slim_render in a row: exit status, messages, files.
# Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
mkdir -p -- "with space"

# The scan: as many points as asked for, the same bytes for any number of threads.
expect 0 '' pcl_slim_demo_scan scan.pcd -points 8000 -threads 1
expect 0 '' pcl_slim_demo_scan again.pcd -points 8000 -threads 4
expect 0 '' pcl_slim_demo_scan other.pcd -points 8000 -seed 2 -quiet 1
[ ! -s out.txt ] || complain "-quiet 1 prints"
same scan.pcd again.pcd
differ scan.pcd other.pcd
grep -aq '^POINTS 8000$' scan.pcd || complain "not 8000 points"
expect 0 '' pcl_slim_demo_scan grid.pcd -points 2500 -organized 1
grep -aq '^WIDTH 50$' grid.pcd || complain "the grid is not 50 wide"
grep -aq '^HEIGHT 50$' grid.pcd || complain "the grid is not 50 high"
expect 2 'named .pcd' pcl_slim_demo_scan scan.xyz
expect 2 'poinst' pcl_slim_demo_scan typo.pcd -poinst 100
expect 2 'no/such' pcl_slim_demo_scan no/such/scan.pcd
absent typo.pcd
keepsOld kept.pcd pcl_slim_demo_scan -points 2000

# Pictures.
expect 0 '' pcl_slim_fit scan.pcd surface.slim
expect 0 '' pcl_slim_fit scan.pcd surface.pcd
small="-size 96x72 -aa 1"
expect 0 '' pcl_slim_render surface.slim automatic.png $small -json report.json -threads 1
grep -q '^  view: up z, from .*; -up y for the other$' out.txt || complain "the view is not named"
expect 0 '' pcl_slim_render surface.slim shaded.png $small -mode shaded -threads 1
expect 0 '' pcl_slim_render surface.slim "with space/shaded.png" $small -mode shaded -threads 4
same shaded.png "with space/shaded.png"
# Every format keeps all of a surface: borders, which this scan has, and colours.
for format in pcd ply vtp; do
  if [ "$format" = pcd ] || pcl_slim_fit scan.pcd surface.$format -quiet 1 2> none.txt; then
    expect 0 '' pcl_slim_render surface.$format points.png $small -mode shaded
    same shaded.png points.png
  fi
done
# Options that change nothing are named, one line each; those that do are not.
idle() { # idle NAMES ARGS...
  expect 0 '' pcl_slim_render surface.slim idle.png $small "${@:2}"
  found=$(sed -n 's/^  -\([a-z_]*\) has no effect: .*/\1/p' out.txt | tr '\n' ' ')
  [ "$found" = "$1" ] || complain "${*:2}: idle are '$found', not '$1'"
}
idle '' -mode mean -range 5 -bar -unit mm -map perceptual -lighting 0
idle 'range map ' -range 5 -map perceptual
idle 'unit ' -mode mean -unit mm
idle 'lighting ' -mode normal -lighting 0
idle 'lights filtered line_width ' -lights 30,40 -line_width 2 -filtered 0
idle 'line_slope ' -lines crest -line_slope 9 -line_curvature 5 -line_length 4
idle 'lod ' -mode raytraced -lod 2 -lights 30,40
idle 'hole ' -trim 0 -hole 9
idle 'aa ' -mode sketch
# Colours: the scan's, the same for any threads, chosen where there are any; without textures from other formats than
# .slim; traced, too; none without a scan's.
expect 0 '' pcl_slim_render surface.slim color.png $small -mode color -threads 1
differ shaded.png color.png
same automatic.png color.png
expect 0 '' pcl_slim_render surface.slim again.png $small -mode color -threads 3
same color.png again.png
expect 0 '' pcl_slim_render surface.pcd again.png $small -mode color
differ color.png again.png
expect 0 '' pcl_slim_render surface.slim bare.png $small -mode color -lighting 0
differ color.png bare.png
expect 0 '' pcl_slim_fit scan.pcd grey.slim -color 0
[ "$(wc -c < grey.slim)" -lt "$(wc -c < surface.slim)" ] || complain "-color 0 keeps colours"
expect 0 '' pcl_slim_render grey.slim again.png $small
same shaded.png again.png
expect 0 '' pcl_slim_render surface.slim traced_color.png $small -mode raytraced
expect 0 '' pcl_slim_render grey.slim traced_grey.png $small -mode raytraced
differ traced_color.png traced_grey.png
expect 2 'no colours' pcl_slim_render grey.slim none.png $small -mode color
expect 2 'no colours' pcl_slim_render grey.slim none.html -mode color
absent none.png none.html
expect 0 '' pcl_slim_render surface.slim color.html
grep -q '"mode":"color"' color.html || complain "a coloured surface's page does not begin with its colours"
expect 0 '' pcl_slim_render grey.slim grey.html
grep -q '"mode":"shaded"' grey.html || complain "a page of no colours does not begin shaded"
# Modes that are lines over a shaded surface; holes closed without another fit.
# The standard error, with its bar; a page says its range, in colours of the surface.
expect 0 '' pcl_slim_render surface.slim sure.png $small -mode uncertainty -threads 1 -json report.json
grep -q '^  standard error 0 to .*, dark to light$' out.txt || complain "the range of errors is not named"
grep -q '"standard_error"' report.json || complain "no range of errors in the report"
expect 0 '' pcl_slim_render surface.slim again.png $small -mode uncertainty -threads 3
same sure.png again.png
differ sure.png color.png
expect 0 '' pcl_slim_render surface.slim ranged.png $small -mode uncertainty -range 1 -bar -unit m
differ sure.png ranged.png
expect 0 '' pcl_slim_render surface.slim sure.html -mode uncertainty
grep -q 'standard error 0 to ' sure.html || complain "a page of errors does not name their range"
expect 0 '' pcl_slim_render surface.slim crest.png $small -mode crest
expect 0 '' pcl_slim_render surface.slim lines.png $small -mode shaded -lines crest
same crest.png lines.png
expect 0 '' pcl_slim_render surface.slim contours.png $small -mode contours
differ shaded.png contours.png
expect 0 '' pcl_slim_render surface.slim holes.png $small -mode shaded -hole 1 -threads 3
same shaded.png holes.png
expect 0 '' pcl_slim_render surface.slim holes.png $small -mode shaded -hole 12
differ shaded.png holes.png
# A mesh: seen from the same side, in the same modes but those it has not.
expect 0 '' pcl_slim_mesh surface.slim mesh.ply
expect 0 '' pcl_slim_render surface.slim again.png $small
view=$(grep '^  view:' out.txt)
expect 0 'triangles' pcl_slim_render mesh.ply mesh.png $small -json mesh.json -threads 1
grep -q '"triangles": [1-9]' mesh.json || complain "the report lacks triangles"
[ "$(grep '^  view:' out.txt)" = "$view" ] || complain "a mesh is seen from another side"
expect 0 '' pcl_slim_render mesh.ply again.png $small -threads 4
same mesh.png again.png
for mode in shaded mean normal reflection; do
  expect 0 '' pcl_slim_render mesh.ply again.png $small -mode $mode
  differ mesh.png again.png
done
expect 0 '' pcl_slim_render mesh.ply again.png $small -region -1,-1,0.3,1,1,9
differ mesh.png again.png
expect 0 '  -lod has no effect' pcl_slim_render mesh.ply again.png $small -lod 3
expect 2 'levels' pcl_slim_render mesh.ply none.png -mode level
for option in '-mode raytraced' '-lines crest' '-mode sketch'; do
  # shellcheck disable=SC2086
  expect 2 'pictures alone' pcl_slim_render mesh.ply none.png $option
done
expect 2 'pictures alone' pcl_slim_render mesh.ply none.html
absent none.png none.html
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1e400 0\n3 0 1 2\n' > far.off
expect 2 'vertex 2' pcl_slim_render far.off none.png
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' > thin.off
expect 2 'no face has an area' pcl_slim_render thin.off none.png
absent none.png
# A part: framed by itself, the rest left out and counted, the same bytes for any number of threads.
expect 0 '' pcl_slim_render surface.slim part.png $small -mode shaded -region -1,-1,0.3,1,1,9 -json part.json
differ shaded.png part.png
grep -q '"outside_region": [1-9]' part.json || complain "-region leaves nothing out"
expect 0 '' pcl_slim_render surface.slim again.png $small -mode shaded -region -1,-1,0.3,1,1,9 -threads 3
same part.png again.png
expect 0 '' pcl_slim_render surface.slim again.png $small -region -1,-1,0.3,1,1,9 -mode raytraced
expect 2 'give a part of' pcl_slim_render surface.slim none.png $small -region 7,7,7,8,8,8
for box in 0,0,0,1,1 0,0,0,1,1,0 0,0,0,1,1,nan here; do
  expect 2 'lowest and the highest corner' pcl_slim_render surface.slim none.png -region "$box"
done
absent none.png
keepsOld kept.png pcl_slim_render $small surface.slim
expect 2 'overwritten' pcl_slim_render surface.slim kept.png $small -save_camera ./surface.slim
expect 2 'share' pcl_slim_render surface.slim kept.png $small -save_camera cam.txt -json ./cam.txt
expect 2 'does not exist' pcl_slim_render surface.slim kept.png $small -json nowhere/r.json
expect 1 'smaller picture' pcl_slim_render surface.slim kept.png -size 20000x20000 -max_memory 400
absent kept.png cam.txt
for key in program version input points threads total load render peak_rss_mb leaves levels \
  covered_pixels outside_frustum camera; do
  grep -q "\"$key\"" report.json || complain "the report lacks $key"
done
for mode in normal mean gauss kmax kmin level size error reflection; do
  expect 0 '' pcl_slim_render surface.slim "$mode.png" $small -mode "$mode"
  differ shaded.png "$mode.png"
done
expect 0 '' pcl_slim_render surface.slim range.png $small -mode mean -range 3
expect 0 '' pcl_slim_render surface.slim range2.png $small -mode mean -range -3,3
same range.png range2.png
differ mean.png range.png
expect 0 '' pcl_slim_render surface.slim map.png $small -mode mean -map perceptual
differ mean.png map.png
wide="-size 320x240 -aa 1 -mode mean"
expect 0 '' pcl_slim_render surface.slim plain.png $wide
expect 0 '' pcl_slim_render surface.slim bar.png $wide -bar 1
expect 0 '' pcl_slim_render surface.slim unit.png $wide -bar 1 -unit mm
differ plain.png bar.png
differ bar.png unit.png

# Ray tracing: threads change nothing, lights and occlusion do.
traced="-size 96x72 -aa 1 -mode raytraced"
expect 0 '' pcl_slim_render surface.slim traced.png $traced -json traced.json -threads 1
expect 0 '' pcl_slim_render surface.slim traced2.png $traced -threads 3
same traced.png traced2.png
differ shaded.png traced.png
for key in rays_primary rays_shadow rays_occlusion tested_per_ray covered_pixels leaves camera; do
  grep -q "\"$key\"" traced.json || complain "the report lacks $key"
done
for option in '-lights -60,50' '-lights -60,50,0.9:40,10,0.25,3' '-ao 0' '-white 1'; do
  # shellcheck disable=SC2086
  expect 0 '' pcl_slim_render surface.slim traced2.png $traced $option
  differ traced.png traced2.png
done
for lights in 1 1,2,3,4,5 1,2,-1 1,2,1,50 1,2: sun; do
  expect 2 'lights' pcl_slim_render surface.slim none.png $traced -lights "$lights"
done
absent none.png

# Cameras and turntables.
expect 0 '' pcl_slim_render surface.slim top.png $small -view top -save_camera top.txt
expect 0 '' pcl_slim_render surface.slim top2.png $small -camera top.txt
expect 0 '' pcl_slim_render surface.slim top3.png $small -camera "$(cat top.txt)"
same top.png top2.png
same top.png top3.png
expect 0 '' pcl_slim_render surface.slim parallel.png $small -ortho 1 -save_camera parallel.txt
expect 0 '' pcl_slim_render surface.slim parallel2.png $small -camera parallel.txt
same parallel.png parallel2.png
expect 0 '' pcl_slim_render surface.slim turn.png $small -turntable 3
for turn in 000 001 002; do
  [ -s turn_$turn.png ] || complain "no turn_$turn.png"
done
absent turn.png
differ turn_000.png turn_001.png
expect 0 '' pcl_slim_render surface.slim given.png $small -camera top.txt -turntable 2
same top.png given_000.png
for view in front back left right top bottom iso 12.5,-30; do
  expect 0 '' pcl_slim_render surface.slim view.png $small -view "$view" -ortho 1
done
expect 0 '' pcl_slim_render surface.slim a.png $small -camera 0,-1,0.5,0,0,0.2,0,0,1,30
expect 0 '' pcl_slim_render surface.slim b.png $small -camera 0,-1,0.5,0,0,0.2,0,0,1
same a.png b.png

# Mistakes.
# .ppm has the same pixels, uncompressed.
expect 0 '' pcl_slim_render surface.slim a.PPM $small
size=${small#*-size }
size=${size%% *}
head -n 3 a.PPM | cmp -s - <(printf 'P6\n%s %s\n255\n' "${size%x*}" "${size#*x}") || complain "a.PPM has another header"
[ "$(head -n 3 a.PPM | wc -c)" -lt 20 ] && [ "$(wc -c < a.PPM)" -eq $((${size%x*} * ${size#*x} * 3 + $(head -n 3 a.PPM | wc -c))) ] ||
  complain "a.PPM has another size"

rm -f x.png
# Pages: the same bytes for any number of threads; options that mean nothing there are named.
expect 0 '' pcl_slim_render surface.slim page.html -mode mean -range 5 -json page.json -threads 1
expect 0 '' pcl_slim_render surface.slim again.html -mode mean -range 5 -threads 4 -quiet
same page.html again.html
grep -q '"page_bytes": [1-9]' page.json || complain "the report does not have the page's size"
grep -q '"mode":"mean","range":\[-5,5\]' page.html || complain "the page does not open as asked"
expect 0 '' pcl_slim_render surface.slim exact.html -precision 0
differ page.html exact.html
for option in "-size 80x60" "-bar" "-aa 2" "-turntable 3" "-lines crest" "-region 0,0,0,1,1,1"; do
  # shellcheck disable=SC2086 # an option and its value
  expect 2 "${option%% *} means nothing in a page" pcl_slim_render surface.slim none.html $option
done
for mode in raytraced sketch crest contours; do
  expect 2 "mode $mode cannot be shown" pcl_slim_render surface.slim none.html -mode $mode
done
expect 2 'ends in .html' pcl_slim_render surface.slim none.png -precision 640
expect 2 'precision' pcl_slim_render surface.slim none.html -precision 3
expect 2 'ends in .html' pcl_slim_render surface.slim none.png -color_error 2
expect 2 'color_error' pcl_slim_render surface.slim none.html -color_error 33
expect 2 'no/such' pcl_slim_render surface.slim no/such/page.html
absent none.html none.png

expect 2 'missing.slim' pcl_slim_render missing.slim x.png
expect 2 'neither' pcl_slim_render scan.pcd x.png
head -c 2000 surface.slim > cut.slim
expect 2 'truncated' pcl_slim_render cut.slim x.png
expect 2 'named .png' pcl_slim_render surface.slim x.jpg
expect 2 'size' pcl_slim_render surface.slim x.png -size 80
expect 2 'size' pcl_slim_render surface.slim x.png -size 0x80
expect 2 'mode' pcl_slim_render surface.slim x.png -mode shiny
expect 2 'view' pcl_slim_render surface.slim x.png -view 1,2,3
expect 2 'camera' pcl_slim_render surface.slim x.png -camera 1,2,3
expect 2 'missing.txt' pcl_slim_render surface.slim x.png -camera missing.txt
expect 2 'holds no camera' pcl_slim_render surface.slim x.png -camera report.json
expect 2 'range' pcl_slim_render surface.slim x.png -mode mean -range 3,-3
expect 2 'range' pcl_slim_render surface.slim x.png -mode size -range 3
expect 2 'positive' pcl_slim_render surface.slim x.png -mode size -range -3,3
expect 2 'letters' pcl_slim_render surface.slim x.png -unit m2
expect 2 'differ' pcl_slim_render surface.slim x.png -camera 1,2,3,1,2,3,0,0,1
expect 2 'colour' pcl_slim_render surface.slim x.png -colour 1
expect 2 'no/such' pcl_slim_render surface.slim no/such/x.png
absent x.png x.jpg

documented pcl_slim_render
documented pcl_slim_demo_scan tutorial

finish
