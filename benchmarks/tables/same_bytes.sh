#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Whether two builds make the same bytes, on 1 and on 2 threads: surfaces, smoothed clouds, curvatures, splats,
# pictures, meshes, lines and samples of every .pcd and .ply of a folder and of three generated scans; of some of them
# also every output format, every mode of pictures, pages, tiles and kept plans; the texts of -h and the keys of reports.
#   benchmarks/tables/same_bytes.sh DATA_FOLDER BIN_A BIN_B     compares; exits 1 if a line differs
#   benchmarks/tables/same_bytes.sh DATA_FOLDER BIN >SUMS       writes one build's checksums
# BIN is a folder of programs, as build/release/bin, or a file of checksums written before.
# SCANS='bunny|cube' limits it to scans whose names match; THREADS='1 2' may be set.
set -euo pipefail

case ${1-} in
  -h | --help) sed -n '3,/^[^#]/{/^#/s/^# \{0,1\}//p}' "$0"; exit 0 ;;
esac
if [ $# -lt 2 ] || [ $# -gt 3 ] || [ ! -d "$1" ]; then
  echo "same_bytes.sh wants DATA_FOLDER BIN_A [BIN_B]; see same_bytes.sh -h" >&2
  exit 2
fi
data=$1
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
only=${SCANS:-.}

# sum BIN LABEL OUTPUT PROGRAM ARGUMENT...: a line "checksum  label"; a failure is a result as well.
sum() {
  local bin=$1 label=$2 output=$3 program=$4
  shift 4
  rm -f -- "$output"
  if "$bin/$program" "$@" >"$work/log" 2>&1; then
    printf '%s  %s\n' "$(md5sum <"$output" | cut -d' ' -f1)" "$label"
  else
    printf 'exit %d  %s\n' $? "$label"
  fi
}

# Scans of which everything is made: painted and gridded, of a sensor, closed, sharp, with normals.
whole='^scan1$|^scan3$|cube|learn13|bunny_zipper|fandisk_03_noisy'

# report BIN LABEL PROGRAM ARGUMENT...: the keys of a report.
report() {
  local bin=$1 label=$2 program=$3
  shift 3
  rm -f -- "$work/report.json"
  "$bin/$program" "$@" -json "$work/report.json" >"$work/log" 2>&1 || true
  python3 - "$work/report.json" >"$work/keys" <<'END' || true
import json, sys
def keys(value, path=""):
    for key, inner in sorted(value.items()) if isinstance(value, dict) else ():
        yield path + key
        yield from keys(inner, path + key + ".")
print("\n".join(keys(json.load(open(sys.argv[1])))))
END
  printf '%s  %s\n' "$(md5sum <"$work/keys" | cut -d' ' -f1)" "keys of $label"
}

# everything BIN FILE NAME -threads N: each output format, mode and way of the programs; $work/surface.slim is there.
everything() {
  local bin=$1 file=$2 name=$3 slim=$work/surface.slim t=("${@:4}") kind mode
  local label="$3, $5 threads"
  for kind in pcd ply vtp; do
    sum "$bin" "fit .$kind $label" "$work/out.$kind" pcl_slim_fit "$file" "$work/out.$kind" "${t[@]}"
  done
  sum "$bin" "fit -quantize $label" "$work/out.slim" pcl_slim_fit "$file" "$work/out.slim" -quantize .1 "${t[@]}"
  sum "$bin" "fit -tile_points $label" "$work/out.slim" pcl_slim_fit "$file" "$work/out.slim" -tile_points 20000 "${t[@]}"
  rm -rf -- "$work/plan"
  mkdir -- "$work/plan"
  for kind in 0/2 1/2; do
    "$bin/pcl_slim_fit" "$file" "$work/out.slim" -tile_points 20000 -plan "$work/plan" -tiles $kind "${t[@]}" >"$work/log" 2>&1 || true
  done
  sum "$bin" "fit -plan $label" "$work/out.slim" pcl_slim_fit "$file" "$work/out.slim" -tile_points 20000 -plan "$work/plan" "${t[@]}"
  for kind in pcd ply las vtp; do
    sum "$bin" "smooth .$kind $label" "$work/out.$kind" pcl_slim_smooth "$file" "$work/out.$kind" -surface "$slim" "${t[@]}"
    sum "$bin" "curvature .$kind $label" "$work/out.$kind" pcl_slim_curvature "$file" "$work/out.$kind" -surface "$slim" "${t[@]}"
    sum "$bin" "sample .$kind $label" "$work/out.$kind" pcl_slim_sample "$file" "$work/out.$kind" -number 3000 "${t[@]}"
  done
  sum "$bin" "smooth alone $label" "$work/out.pcd" pcl_slim_smooth "$file" "$work/out.pcd" "${t[@]}"
  for kind in ply obj stl glb vtp; do
    sum "$bin" "mesh .$kind $label" "$work/out.$kind" pcl_slim_mesh "$file" "$work/out.$kind" -surface "$slim" "${t[@]}"
  done
  sum "$bin" "mesh -trim 0 -max_triangles $label" "$work/out.ply" pcl_slim_mesh "$slim" "$work/out.ply" -trim 0 -max_triangles 3000 "${t[@]}"
  sum "$bin" "smooth -mesh $label" "$work/out2.ply" pcl_slim_smooth "$work/out.ply" "$work/out2.ply" -mesh 1 "${t[@]}"
  for kind in svg ply pcd; do
    sum "$bin" "lines .$kind $label" "$work/out.$kind" pcl_slim_lines "$file" "$work/out.$kind" -surface "$slim" "${t[@]}"
  done
  for kind in pcd vtp; do
    sum "$bin" "splats .$kind $label" "$work/splats.$kind" pcl_color_splat_sampling "$file" "$work/splats.$kind" "${t[@]}"
  done
  for mode in '-max_splats 2000' '-paper 1' '-colors gradient -radius neighbours'; do
    # shellcheck disable=SC2086
    sum "$bin" "splats $mode $label" "$work/out.ply" pcl_color_splat_sampling "$file" "$work/out.ply" $mode "${t[@]}"
  done
  for mode in normal mean gauss kmax kmin level size error reflection color raytraced crest contours sketch; do
    sum "$bin" "picture $mode $label" "$work/out.png" pcl_slim_render "$slim" "$work/out.png" -size 320x240 -mode $mode "${t[@]}"
  done
  for mode in '-lines all' '-lod 4' '-trim 0 -aa 1' '-hole 8 -ortho 1 -view iso' '-mode mean -bar 1 -sides both' \
    '-ao 0 -white 1 -up z -view 30,20'; do
    # shellcheck disable=SC2086
    sum "$bin" "picture $mode $label" "$work/out.ppm" pcl_slim_render "$slim" "$work/out.ppm" -size 320x240 $mode "${t[@]}"
  done
  sum "$bin" "page $label" "$work/out.html" pcl_slim_render "$slim" "$work/out.html" "${t[@]}"
  sum "$bin" "page of splats $label" "$work/out.html" pcl_slim_render "$work/splats.pcd" "$work/out.html" "${t[@]}"
  sum "$bin" "picture of splats $label" "$work/out.png" pcl_slim_render "$work/splats.pcd" "$work/out.png" -size 320x240 "${t[@]}"
  sum "$bin" "traced splats $label" "$work/out.png" pcl_slim_render "$work/splats.pcd" "$work/out.png" -size 320x240 -mode raytraced "${t[@]}"
  report "$bin" "fit $label" pcl_slim_fit "$file" "$work/out.slim" "${t[@]}"
  report "$bin" "smooth $label" pcl_slim_smooth "$file" "$work/out.pcd" "${t[@]}"
  report "$bin" "curvature $label" pcl_slim_curvature "$file" "$work/out.pcd" -surface "$slim" "${t[@]}"
  report "$bin" "splats $label" pcl_color_splat_sampling "$file" "$work/out.ply" "${t[@]}"
  report "$bin" "mesh $label" pcl_slim_mesh "$slim" "$work/out.ply" "${t[@]}"
  report "$bin" "lines $label" pcl_slim_lines "$file" "$work/out.vtp" -surface "$slim" "${t[@]}"
  report "$bin" "sample $label" pcl_slim_sample "$slim" "$work/out.pcd" -number 2000 "${t[@]}"
  report "$bin" "picture $label" pcl_slim_render "$slim" "$work/out.png" -size 160x120 "${t[@]}"
}

# scan BIN FILE NAME THREADS
scan() {
  local bin=$1 file=$2 name=$3 t=(-threads "$4")
  local label="$3, $4 threads" slim=$work/surface.slim
  sum "$bin" "fit $label" "$slim" pcl_slim_fit "$file" "$slim" "${t[@]}"
  sum "$bin" "smooth $label" "$work/out.pcd" pcl_slim_smooth "$file" "$work/out.pcd" \
    -surface "$slim" -normals 1 "${t[@]}"
  sum "$bin" "curvature $label" "$work/out.pcd" pcl_slim_curvature "$file" "$work/out.pcd" \
    -surface "$slim" "${t[@]}"
  sum "$bin" "picture $label" "$work/out.png" pcl_slim_render "$slim" "$work/out.png" \
    -size 320x240 "${t[@]}"
  sum "$bin" "splats $label" "$work/out.ply" pcl_color_splat_sampling "$file" "$work/out.ply" "${t[@]}"
  sum "$bin" "mesh $label" "$work/out.ply" pcl_slim_mesh "$slim" "$work/out.ply" "${t[@]}"
  sum "$bin" "lines $label" "$work/out.vtp" pcl_slim_lines "$file" "$work/out.vtp" -surface "$slim" "${t[@]}"
  sum "$bin" "sample $label" "$work/out.pcd" pcl_slim_sample "$slim" "$work/out.pcd" -number 5000 "${t[@]}"
  [[ ! $name =~ $whole ]] || everything "$bin" "$file" "$name" "${t[@]}"
  local option
  for option in '-degree 2 -t_mdl 0.01' '-robust 1' '-sharp 1' '-paper 1 -degree 2' '-local_noise 1' \
    '-normals_as_data 1' '-use_normals 0 -degree 3' '-max_surfels 2000'; do
    case $name:$option in
      *cube*:* | *angel*:* | *block*noisy*:* | *bunny*:-robust* | *learn13*:-local* | scan1:*) ;;
      *) continue ;;
    esac
    # shellcheck disable=SC2086
    sum "$bin" "fit $option $label" "$slim" pcl_slim_fit "$file" "$slim" $option "${t[@]}"
  done
}

# generated BIN: the three scans, by one and the same program for both builds.
generated() {
  [ -e "$work/scan3.pcd" ] || {
    "$1/pcl_slim_demo_scan" "$work/scan1.pcd" -points 60000 -quiet 1
    "$1/pcl_slim_demo_scan" "$work/scan2.pcd" -points 100000 -noise 0.004 -seed 5 -quiet 1
    "$1/pcl_slim_demo_scan" "$work/scan3.pcd" -points 60000 -noise 0 -organized 1 -quiet 1
  }
}

# sums BIN: all lines of a build, or those of a file.
sums() {
  if [ -f "$1" ]; then
    grep -E "$only" "$1" || true
    return
  fi
  generated "$1"
  local file name threads program
  for program in "$1"/pcl_*; do
    [[ ! $program =~ _(tests|unit_[a-z]*|example_[a-z0-9_]*|stress|fuzz_[a-z]*)$ ]] || continue
    printf '%s  help of %s\n' "$("$program" -h | md5sum | cut -d' ' -f1)" "$(basename -- "$program")"
  done
  for program in '' '-organized 1 -seed 2'; do
    # shellcheck disable=SC2086
    sum "$1" "demo scan $program" "$work/demo.pcd" pcl_slim_demo_scan "$work/demo.pcd" -points 30000 $program
  done
  for file in "$data"/*.pcd "$data"/*.ply "$work"/scan?.pcd; do
    name=$(basename -- "${file%.*}")
    [[ $name =~ $only ]] || continue
    for threads in ${THREADS:-1 2}; do scan "$1" "$file" "$name" "$threads"; done
  done
}

if [ $# -eq 2 ]; then
  sums "$2"
  exit
fi
sums "$2" >"$work/a"
sums "$3" >"$work/b"
if ! diff "$work/a" "$work/b"; then
  echo "The builds differ in the lines above" >&2
  exit 1
fi
echo "$(wc -l <"$work/a") results are equal, byte for byte"
