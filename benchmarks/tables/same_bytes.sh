#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Whether two builds make the same bytes: surfaces, smoothed clouds, curvatures, splats and pictures of
# every .pcd and .ply of a folder and of three generated scans, on 1 and on 2 threads.
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
  local file name threads
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
