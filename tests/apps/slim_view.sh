#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_view: exit status and messages; pictures where xvfb-run brings an X server.
# Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
if [ ! -x "$bin/pcl_slim_view" ]; then
  echo "pcl_slim_view is not built"
  exit 0
fi
program=pcl_slim_view
"$bin/pcl_slim_demo_scan" scan.pcd -points 8000 > out.txt
"$bin/pcl_slim_fit" scan.pcd surface.slim > out.txt
"$bin/pcl_color_splat_sampling" scan.pcd splats.pcd > out.txt 2> err.txt || true

# Frames of a sensor: a wave that moves on, with noise. The second one's is larger by as much as agrees with the first.
frame() {
  awk -v seed="$1" -v noise="$2" 'BEGIN {
    srand(seed); n = 100
    print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " n "\nHEIGHT " n
    print "VIEWPOINT .5 .5 2 1 0 0 0\nPOINTS " n * n "\nDATA ascii"
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x)
      print .01 * x, .01 * y, .05 * sin(.06 * x + seed) + noise * sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand())
  }'
}
frame 1 .002 > frame1.pcd
frame 2 .0021 > frame2.pcd
mkdir frames
"$bin/pcl_slim_fit" frame1.pcd frame2.pcd -out frames > out.txt
"$bin/pcl_slim_fit" frame2.pcd alone.slim > out.txt

# Mistakes are reported before a window is opened.
unset DISPLAY
expect 2 'missing.slim' missing.slim
expect 2 'missing.pcd' missing.pcd
head -c 2000 surface.slim > cut.slim
expect 2 'truncated' cut.slim
expect 2 'modee' surface.slim -modee mean
expect 2 'mode' surface.slim -mode shiny
expect 2 'lines' surface.slim -lines wavy
expect 2 'lod' surface.slim -lod -1
expect 2 'named .png' surface.slim -screenshot x.jpg
expect 2 'up to eight letters' surface.slim -unit 1/mm
expect 2 'size' surface.slim -size 80
expect 2 'lowest and the highest corner' surface.slim -region 1,2,3
expect 2 'give a part of' surface.slim -region 7,7,7,8,8,8
expect 2 'exclude' surface.slim -camera 0,-1,0,0,0,0,0,0,1 -view top
expect 2 'no/such' surface.slim -screenshot no/such/x.png
expect 1 'X server' surface.slim -screenshot x.png
absent x.png x.jpg
documented pcl_slim_view visualization slim_fit

if ! command -v xvfb-run > /dev/null; then
  echo "no xvfb-run: no pictures are tried"
  finish
  exit 0
fi

# One X server for all pictures, from a number of its own: two that start at once would race for one.
# Without -noreset it would start anew after each picture and refuse the next.
cat > shots.sh << 'END'
# shot FILE.png ARGS...: a picture from a window that no one sees.
shot() {
  local file=$1
  shift
  "$bin/pcl_slim_view" "$@" -screenshot "$file" -size 160x120 -quiet 1 > "$file.txt" 2>&1
}
shot shaded.png surface.slim
shot again.png surface.slim -threads 1
shot mean.png surface.slim -mode mean
shot error.png surface.slim -mode error
shot unit.png surface.slim -mode mean -unit mm
shot bare.png surface.slim -lighting 0
shot card.png surface.slim -backend opengl
shot balls.png surface.slim -balls 1
shot lines.png surface.slim -lines contour -line_width 3
shot sketch.png surface.slim -mode sketch
shot lod.png surface.slim -lod 40
shot top.png surface.slim -view top
shot parallel.png surface.slim -ortho 1
shot frames.png frame1.pcd frame2.pcd
shot last.png frames/frame2.*
shot alone.png alone.slim
"$bin/pcl_slim_view" frame1.pcd missing.pcd -screenshot none.png > missing.out 2> missing.err && echo none >> missing.err
"$bin/pcl_slim_view" frame1.pcd surface.slim -screenshot none.png > model.out 2> model.err && echo none >> model.err
shot part.png surface.slim -region -1,-1,0.3,1,1,9
shot scan.png scan.pcd
if [ -s splats.pcd ]; then
  shot color.png splats.pcd
  shot normal.png splats.pcd -mode normal
fi
END
bin=$bin xvfb-run -a -n 300 -s "-screen 0 640x480x24 -noreset" bash shots.sh
for file in *.png.txt; do
  picture=${file%.txt}
  [ -s "$picture" ] || complain "no $picture: $(head -c 300 "$file")"
  [ ! -s "$file" ] || complain "$picture comes with words: $(head -c 300 "$file")"
done
same shaded.png again.png
[ -s card.png ] && [ "$(wc -c < card.png)" -gt 2000 ] || complain "the card's picture is empty"
# The scan is fitted as pcl_slim_fit does it.
same shaded.png scan.png
# So are frames, each by the noise of the one before.
same frames.png last.png
differ frames.png alone.png
absent none.png
grep -q 'missing.pcd' missing.err || complain "a missing frame: $(cat missing.err)"
grep -q 'surface.slim' model.err || complain "a surface among frames: $(cat model.err)"
differ mean.png unit.png
for other in bare mean error balls lines sketch lod top parallel part; do differ shaded.png $other.png; done
[ ! -s splats.pcd ] || differ color.png normal.png
finish
