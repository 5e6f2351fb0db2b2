#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of docs/figures.md: figures.sh BIN DATA OUT, folders of the built programs, of real scans and
# for the pictures. Needs ImageMagick's montage, fontconfig and, for balls, xvfb-run.
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: figures.sh BIN DATA OUT" >&2; exit 2; }
bin=$1 data=$2 out=$3
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p -- "$out"
font=$(fc-match -f '%{file}' sans)
dragon=$data/stanford_dragon_res2.ply
bunny=$data/stanford_bunny_zipper.ply
sphere_eye=0,-4.2,0,0,0,0,0,0,1,30

# fit SCAN NAME OPTIONS...: NAME.slim and the report of the fit.
fit() {
  "$bin/pcl_slim_fit" "$1" "$work/$2.slim" -json "$work/$2.fit.json" -quiet 1 "${@:3}"
}

leaves() { sed -n 's/.*"leaves": \([0-9]*\).*/\1/p' "$work/$1.fit.json" | head -n 1; }

# render NAME PICTURE OPTIONS...: a part of a sheet, of NAME.slim.
render() {
  "$bin/pcl_slim_render" "$work/$1.slim" "$work/$2.png" -json "$work/$2.json" -white 1 -quiet 1 \
    "${@:3}"
}

# unity NAME PICTURE OPTIONS...: the same by the derivatives of NAME.slim's partition of unity.
unity() { "$bin/unity_picture" "$work/$1.slim" "$work/$2.png" -white 1 "${@:3}"; }

# near NAME FOV: the camera of "$work/NAME.txt" with a narrower field of view.
near() { awk -F, -v fov="$2" '{ OFS = ","; $10 = fov; print }' "$work/$1.txt"; }

# sheet PICTURE COLUMNS (LABEL NAME)...: parts side by side.
sheet() {
  local picture=$1 columns=$2 parts=()
  shift 2
  while [ $# -gt 0 ]; do
    parts+=(-label "$1" "$work/$2.png")
    shift 2
  done
  montage -font "$font" -pointsize 15 "${parts[@]}" -tile "${columns}x" -geometry +3+3 \
    -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/$picture"
}

# add_bar PICTURE HEIGHT NAME OPTIONS...: the colours with their numbers to the right of a sheet, as NAME.slim has them with
# these options, drawn from where nothing is seen of it.
add_bar() {
  render "$3" bar -size "90x$2" -bar 1 -unit m -camera 0,0,1000,0,0,2000,0,1,0 "${@:4}"
  convert "$out/$1" "$work/bar.png" -background white -gravity north +append \
    -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/$1"
}

# Fig. 1: balls by size, shading, mean curvature of cubics.
fit "$dragon" balls -degree 3
render balls fig1_shaded -size 420x340 -save_camera "$work/dragon.txt"
render balls fig1_mean -size 420x340 -mode mean -range 300 -camera "$work/dragon.txt"
xvfb-run -a -s "-screen 0 640x480x24" "$bin/pcl_slim_view" "$work/balls.slim" -balls 1 \
  -camera "$work/dragon.txt" -size 420x340 -screenshot "$work/fig1_balls.png" -quiet 1
sheet figure_1.png 3 "$(leaves balls) balls, coloured by size" fig1_balls 'shaded' fig1_shaded \
  'mean curvature' fig1_mean
add_bar figure_1.png 340 balls -mode mean -range 300

# Fig. 2: a sphere of few leaves, and what it mirrors.
awk 'BEGIN {
  n = 30000; g = 2.39996322972865332
  print "VERSION .7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F"
  print "COUNT 1 1 1 1 1 1\nWIDTH " n "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " n "\nDATA ascii"
  for (i = 0; i < n; ++i) {
    z = 1 - 2 * (i + .5) / n; r = sqrt(1 - z * z)
    printf "%.7f %.7f %.7f %.7f %.7f %.7f\n", r * cos(g * i), r * sin(g * i), z, r * cos(g * i), r * sin(g * i), z
  }
}' > "$work/sphere.pcd"
for kind in 1:128 1:450 2:105; do
  name=sphere_${kind/:/_}
  fit "$work/sphere.pcd" "$name" -degree "${kind%:*}" -compact 1 -max_surfels "${kind#*:}"
  render "$name" "${name}_shaded" -size 280x280 -camera $sphere_eye
  render "$name" "${name}_lines" -size 280x280 -camera $sphere_eye -mode reflection
done
sheet figure_2.png 3 "$(leaves sphere_1_128) linear leaves" sphere_1_128_shaded \
  "$(leaves sphere_1_450) linear" sphere_1_450_shaded \
  "$(leaves sphere_2_105) quadratic" sphere_2_105_shaded \
  '' sphere_1_128_lines '' sphere_1_450_lines '' sphere_2_105_lines

# Silhouettes: where the outlines of these spheres run beside the exact circle, a quarter of the width enlarged.
radius=$(awk 'BEGIN { s = 1 / 4.2; print 560 * s / sqrt(1 - s * s) / (2 - sqrt(3)) }')
circle="circle 559.5,559.5 559.5,$(awk -v r="$radius" 'BEGIN { print 559.5 - r }')"
convert -size 1120x1120 xc:black -fill white +antialias -draw "$circle" "$work/exact.png"
outlines=()
for name in sphere_1_128 sphere_1_450 sphere_2_105; do
  render $name ${name}_outline -size 1120x1120 -camera $sphere_eye -aa 1 -ao 0
  convert "$work/${name}_outline.png" -fill black +opaque white -negate "$work/${name}_mask.png"
  off=$(compare -metric AE "$work/${name}_mask.png" "$work/exact.png" null: 2>&1 || true)
  convert "$work/${name}_outline.png" -fill none -stroke '#d03020' -strokewidth 2 \
    -draw "$circle" -crop 280x280+60+100 +repage "$work/${name}_outline.png"
  kind=quadrics
  [ "${name:7:1}" = 2 ] || kind=planes
  outlines+=("$(leaves $name) $kind: off by $(awk -v a="$off" -v r="$radius" \
    'BEGIN { printf "%.2f", 100 * a / (6.2832 * r * r) }') %" "${name}_outline")
done
sheet figure_2_outlines.png 3 "${outlines[@]}"

# Figs. 2 and 11: a mesh with interpolated normals beside quadratics of its vertices, one camera.
fit "$dragon" phong -degree 2
for part in "fig2 $work/dragon.txt -mode reflection" "fig2_near $(near dragon 9) -mode reflection" \
  "fig11 $work/dragon.txt LINES" "fig11_near $(near dragon 9) LINES"; do
  read -r name camera options <<< "$part"
  # Twice the size, halved: what the two differ in is no stair of a pixel.
  # shellcheck disable=SC2086
  render phong ${name}_slim -size 940x760 -aa 1 -line_width 3.2 -camera "$camera" ${options/LINES/-mode contours}
  # shellcheck disable=SC2086
  "$bin/phong_picture" "$dragon" "$work/phong.slim" "$work/${name}_mesh.png" -size 940x760 \
    -line_width 3.2 -camera "$camera" ${options/LINES/-suggestive 1}
  mogrify -filter box -resize 50% "$work/${name}_slim.png" "$work/${name}_mesh.png"
done
for name in fig2 fig11; do
  sheet "figure_${name#fig}_mesh.png" 2 "$(sed -n '/^element face/ { s/.* //p; q }' "$dragon") triangles, interpolated normals" \
    ${name}_mesh \
    "$(leaves phong) quadratic leaves" ${name}_slim '' ${name}_near_mesh '' ${name}_near_slim
done

# Fig. 12: the larger principal curvature of quadratics and cubics.
for degree in 2 3; do
  fit "$dragon" dragon_$degree -degree $degree
  render dragon_$degree kmax_$degree -size 470x380 -mode kmax -range 400 -camera "$work/dragon.txt"
  render dragon_$degree ridges_$degree -size 470x380 -lines crest -camera "$work/dragon.txt"
done
sheet figure_12.png 2 "k_max, $(leaves dragon_2) quadratic leaves" kmax_2 \
  "k_max, $(leaves dragon_3) cubic leaves" kmax_3 'ridges (blue) and ravines (red), quadratic' ridges_2 \
  'ridges and ravines, cubic' ridges_3
add_bar figure_12.png 380 dragon_3 -mode kmax -range 400

# Fig. 13: suggestive contours, shading and crest lines of cubics.
fit "$data/armadillo_50k.ply" armadillo -degree 3
for part in 'contours -mode sketch -lines suggestive -line_slope 6' 'shaded -mode shaded' \
  'crest -mode sketch -lines crest -line_curvature 1'; do
  read -r name options <<< "$part"
  # shellcheck disable=SC2086
  render armadillo armadillo_$name -size 1320x1560 -line_width 4 -view 180,5 $options
  mogrify -filter box -resize 33.3333% "$work/armadillo_$name.png"
done
sheet figure_13.png 3 'suggestive contours' armadillo_contours "$(leaves armadillo) cubic leaves" armadillo_shaded \
  'ridges (blue) and ravines (red)' armadillo_crest

# Figs. 15 and 16: equation 8, left against right.
for degree in 2 3; do
  fit "$bunny" bunny_$degree -degree $degree
  render bunny_$degree bunny -size 360x340 -save_camera "$work/bunny.txt"
  shaded=(-size 360x340 -ao 0 -camera "$(near bunny 9)")
  mean=(-size 360x340 -mode mean -range 200 -camera "$(near bunny 14)")
  render bunny_$degree shaded_blended_$degree "${shaded[@]}"
  render bunny_$degree mean_blended_$degree "${mean[@]}"
  unity bunny_$degree shaded_unity_$degree "${shaded[@]}"
  unity bunny_$degree mean_unity_$degree "${mean[@]}"
done
sheet figure_15.png 4 'quadratic, blended gradients' shaded_blended_2 \
  'quadratic, partition of unity' shaded_unity_2 'cubic, blended gradients' shaded_blended_3 \
  'cubic, partition of unity' shaded_unity_3
sheet figure_16.png 4 'quadratic, blended Hessians' mean_blended_2 \
  'quadratic, partition of unity' mean_unity_2 'cubic, blended Hessians' mean_blended_3 \
  'cubic, partition of unity' mean_unity_3
add_bar figure_16.png 340 bunny_3 -mode mean -range 200

# Fig. 17: one T, three degrees, by the paper's rules.
for degree in 1 2 3; do
  fit "$dragon" same_t_$degree -degree $degree -paper 1 -t_mdl .02
  render same_t_$degree same_t_$degree -size 450x380 -camera "$work/dragon.txt"
done
sheet figure_17.png 3 "$(leaves same_t_1) linear leaves" same_t_1 "$(leaves same_t_2) quadratic" same_t_2 \
  "$(leaves same_t_3) cubic" same_t_3

# Fig. 22: few quadratics against many planes, near by.
"$bin/paper_bench" "$data" "$work" -figure hand > /dev/null
fit "$work/hand.ply" few -degree 2 -paper 1 -max_surfels 1900
fit "$work/hand.ply" many -degree 1 -paper 1 -max_surfels 25000
for name in few many; do
  render $name ${name}_whole -size 330x360 -view 180,10 -save_camera "$work/hand.txt"
  render $name ${name}_near -size 330x360 -camera "$(near hand 9)"
  render $name ${name}_lines -size 330x360 -camera "$(near hand 9)" -mode reflection
done
sheet figure_22.png 3 "$(leaves few) quadratic leaves" few_whole 'near by' few_near 'reflection lines' few_lines \
  "$(leaves many) linear leaves" many_whole 'near by' many_near 'reflection lines' many_lines

# The same with a scan.
fit "$bunny" bunny_few -degree 2 -paper 1 -max_surfels 1900
fit "$bunny" bunny_many -degree 1 -paper 1 -max_surfels 25000
for name in bunny_few bunny_many; do
  render $name ${name}_whole -size 330x300 -camera "$work/bunny.txt"
  render $name ${name}_near -size 330x300 -camera "$(near bunny 11)"
  render $name ${name}_lines -size 330x300 -camera "$(near bunny 11)" -mode reflection
done
sheet figure_22_scan.png 3 "$(leaves bunny_few) quadratic leaves" bunny_few_whole 'near by' bunny_few_near \
  'reflection lines' bunny_few_lines "$(leaves bunny_many) linear leaves" bunny_many_whole 'near by' bunny_many_near \
  'reflection lines' bunny_many_lines
