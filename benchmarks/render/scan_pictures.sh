#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of real scans in docs/ and benchmarks/README.md: scan_pictures.sh BIN DATA OUT, folders of the built
# programs, of real scans and for the pictures. Needs ImageMagick's montage; for windows xvfb-run and xdotool.
set -euo pipefail
# shellcheck source=benchmarks/render/picture_folders.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/picture_folders.sh"

# sheet PICTURE COLUMNS NAME[=LABEL]...: parts side by side.
sheet() {
  local picture=$1 columns=$2 parts=()
  for part in "${@:3}"; do
    label=${part#*=}
    [ "$label" != "$part" ] || label=''
    parts+=(-label "$label" "${part%%=*}.png")
  done
  montage -font "$font" -pointsize 15 "${parts[@]}" -tile "${columns}x" -geometry +2+2 "${png[@]}" "$out/$picture"
}

# scan FILE OPTIONS...: FILE.slim and FILE.png, the defaults' fit from where the program stands.
scan() {
  local name=${1%.*}
  "$bin/pcl_slim_fit" "$data/$1" "$name.slim" -quiet 1
  "$bin/pcl_slim_render" "$name.slim" "$name.png" -size 400x330 -white 1 -quiet 1 "${@:2}"
}

for name in stanford_bunny_raw_scans lion_takanawa lone_star_geyser_tls autzen_stadium \
  terrain_isprs_csite1_utm kinect_mosd_learn13 pcpnet_cube100k; do
  scan $name.pcd
done
for name in stanford_dragon_res2 angel_real_scan stanford_bunny_zipper julius_02_original \
  julius_02_noisy fandisk_03_original fandisk_03_noisy block_04_original block_04_noisy; do
  scan $name.ply
done
scan armadillo_50k.ply -view 200,10
sheet scans.png 3 'stanford_bunny_raw_scans=Bunny, ten raw scans' lion_takanawa=Lion lone_star_geyser_tls=Geyser \
  autzen_stadium=Stadium terrain_isprs_csite1_utm=City kinect_mosd_learn13=Table stanford_dragon_res2=Dragon \
  armadillo_50k=Armadillo angel_real_scan=Angel
sheet scans_more.png 4 'stanford_bunny_zipper=Bunny, zippered' julius_02_original=Julius 'julius_02_noisy=Julius, noisy' \
  fandisk_03_original=Fandisk 'fandisk_03_noisy=Fandisk, noisy' block_04_original=Block 'block_04_noisy=Block, noisy' \
  pcpnet_cube100k=Cube

# window NAME FILE WIDTHxHEIGHT OPTIONS... -- ACTION...: the window with FILE after what xdotool did in it.
cat > window.sh <<'END'
picture=$1 file=$2 size=$3 options=()
shift 3
while [ "$1" != -- ]; do options+=("$1"); shift; done
shift
"$bin/pcl_slim_view" "$file" -size "$size" -quiet 1 "${options[@]}" &
viewer=$!
for ((i = 0; i < 100; ++i)); do
  id=$(xdotool search --onlyvisible --name pcl_slim_view 2> /dev/null | tail -n 1) && [ -n "$id" ] && break
  sleep .1
done
[ -n "$id" ] || exit 1
xdotool windowmove "$id" 0 0
sleep 20
for action in "$@"; do xdotool ${action//WINDOW/$id} 2> /dev/null; sleep 1; done
import -window "$id" "$picture"
kill $viewer
END
window() {
  local try
  # Others that look for a free display at the same moment may take it.
  for try in 1 2 3; do
    if bin=$bin xvfb-run -a -s "-screen 0 1280x1024x24" bash window.sh "$1.png" "${@:2}"; then return; fi
    sleep $((5 * try))
  done
  return 1
}
dragon=stanford_dragon_res2.slim
window mean $dragon 560x420 -mode mean --
window kmin $dragon 560x420 -mode kmin --
window reflection $dragon 560x420 -mode reflection --
window balls $dragon 560x420 -balls 1 --
window size $dragon 560x420 -mode size --
window help $dragon 560x420 -help_overlay 1 --
sheet view_modes.png 3 'mean=-mode mean' 'kmin=-mode kmin' 'reflection=-mode reflection' 'balls=-balls 1' \
  'size=-mode size' 'help=-help_overlay 1'
window cut $dragon 800x600 -view 20,15 -- 'windowfocus WINDOW' 'mousemove 400 300' 'click 5' 'key --window WINDOW k' \
  'mousemove 678 310' 'mousedown 1' 'mousemove 620 306' 'mousemove 520 300' 'mouseup 1' 'mousemove 40 560'
convert cut.png "${png[@]}" "$out/view_cut.png"
window bunny "$data/stanford_bunny_raw_scans.pcd" 560x420 --
window lion "$data/lion_takanawa.pcd" 560x420 --
window angel "$data/angel_real_scan.ply" 560x420 -mode mean -lines crest -- 'mousemove 260 260' \
  'mousedown 1' 'mousemove 275 258' 'mousemove 290 255' 'mousemove 300 255' 'mouseup 1' 'mousemove 250 190'
sheet view_scans.png 3 bunny lion angel

# The example: a PCLVisualizer.
cat > example.sh <<'END'
"$bin/pcl_slim_example_03_pcl_visualizer" stanford_bunny.pcd &
example=$!
for try in $(seq 60); do
  sleep 2
  id=$(xdotool search --onlyvisible --name 'The surface' | tail -n 1) || continue
  [ -n "$id" ] && import -window "$id" pcl_visualizer.png || continue
  # An empty window has one colour.
  [ "$(identify -format %k pcl_visualizer.png)" -lt 1000 ] || break
done
kill $example
[ "$(identify -format %k pcl_visualizer.png)" -ge 1000 ]
END
cp -- "$data/stanford_bunny_raw_scans.pcd" stanford_bunny.pcd
bin=$bin xvfb-run -a -s "-screen 0 1280x1024x24" bash example.sh
convert pcl_visualizer.png "${png[@]}" "$out/pcl_visualizer.png"

# The pipeline of PCL's classes.
xvfb-run -a -s "-screen 0 1600x1200x24" "$bin/pcl_slim_example_06_pipeline_visualizer" \
  "$data/kinect_mosd_learn13.pcd" 2.5 .004 pipeline.png > /dev/null
convert pipeline.png -crop 500x380 +repage pipeline_%d.png
sheet pcl_pipeline.png 3 'pipeline_0=the points, filtered' 'pipeline_1=the surface' 'pipeline_2=splats of the smoothed points'
