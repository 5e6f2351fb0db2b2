#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Remakes the pictures and the table of docs/gallery.md: public scans by pcl_slim, Open3D 0.19, CGAL 6 and CloudCompare 2.13.
#   scripts/gallery.sh DATA OUT [SCAN...]    DATA: a folder of scans (benchmarks/README.md names them); OUT gets
#                                            gallery_NAME.jpg and gallery.md; SCAN: some of those below, else all
# The others are packages of Debian 13, in a system of its own in OUT/debian13 (GALLERY_DEBIAN: another folder): 4 GB, made
# once. Needs root, debootstrap and ImageMagick. An hour on two cores. A run that takes more than GALLERY_LIMIT (180)
# seconds of CPU time is ended and said to be late; runs that OUT has are not repeated. BIN_DIR: a folder of built programs;
# then nothing is built.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
# shellcheck source=scripts/minimal_debian.sh
source "$root/scripts/minimal_debian.sh"
if [ $# -lt 2 ] || [ ! -d "$1" ]; then
  echo "usage: scripts/gallery.sh DATA OUT [SCAN...], DATA a folder of scans" >&2
  exit 2
fi
mkdir -p -- "$2/log"
data=$(cd -- "$1" && pwd) out=$(cd -- "$2" && pwd)
limit=${GALLERY_LIMIT-180}
system=${GALLERY_DEBIAN-$out/debian13}
here=$root/benchmarks/gallery

# Of each scan: what is known of the sides of its surface, the part of the 1000 x 1000 picture that is shown as it is, and
# the view.
declare -A scans=(
  [stanford_bunny_raw_scans]="none 300x300+100+190"
  [lion_takanawa]="none 300x300+100+60"
  [kinect_mosd_learn13]="camera 300x300+220+470 -view 25,25"
  [autzen_stadium]="up 300x300+560+120"
)
order=(stanford_bunny_raw_scans lion_takanawa kinect_mosd_learn13 autzen_stadium)
chosen=("${@:3}")
[ ${#chosen[@]} -gt 0 ] || chosen=("${order[@]}")
# Names of runs, in the order of picture and table.
meshes=(mesh tutorial tuned pivoting cgal_tutorial cgal_scale_space)
declare -A labels=(
  [points]="points" [surface]="pcl_slim, surface" [mesh]="pcl_slim, mesh" [tutorial]="Open3D, Poisson"
  [tuned]="Open3D, Poisson, tuned" [pivoting]="Open3D, ball pivoting" [cgal_tutorial]="CGAL, Poisson"
  [cgal_scale_space]="CGAL, scale space" [normals]="CloudCompare, normals"
)

peers() { in_debian "$system" --mount "$out" /gallery --mount "$here" /peers --mount "$data" /data "$@"; }
# timed RUN COMMAND...: a program of this system. peer RUN COMMAND...: one of Debian 13, where $out is /gallery.
timed() { [ -e "$work/$1.json" ] || python3 "$here/timed.py" "$work/$1.json" "$limit" "${@:2}"; }
peer() { [ -e "$work/$1.json" ] || peers python3 /peers/timed.py "/gallery/$scan/$1.json" "$limit" "${@:2}"; }
finished() { grep -q '"state": "done"' "$work/$1.json"; }

setup() {
  if [ -n "${BIN_DIR-}" ]; then
    bin=$(cd -- "$BIN_DIR" && pwd)
  else
    bash "$root/scripts/setup.sh"
    configure -DPCL_SLIM_BUILD_BENCHMARKS=ON
    build pcl_slim_fit pcl_slim_mesh pcl_slim_render point_discs
    bin=$root/build/release/bin
  fi
  [ -d "$system/usr" ] || quietly "Debian 13" "$out/log/debian.log" make_debian trixie "$system"
  [ -e "$system/usr/bin/CloudCompare" ] ||
    quietly "Open3D, CGAL and CloudCompare" "$out/log/packages.log" in_debian "$system" apt-get install -y -q \
      --no-install-recommends python3-open3d g++ libcgal-dev libeigen3-dev libtbb-dev cloudcompare xvfb xauth
  [ "$out/cgal_peer" -nt "$here/cgal_peer.cpp" ] ||
    quietly "Compiling cgal_peer" "$out/log/cgal_peer.log" peers g++ -O2 -DNDEBUG -DCGAL_EIGEN3_ENABLED \
      -DCGAL_LINKED_WITH_TBB -I/usr/include/eigen3 /peers/cgal_peer.cpp -o /gallery/cgal_peer -ltbb -lgmp -lmpfr
}

# runs SIDES: all programs on one scan. Each that ends in time leaves RUN.ply, pcl_slim's surface surface.slim. Where
# nothing moved the points, pcl_slim reads the scan itself, with what its file says of the sensor.
runs() {
  local sides=$1 own=$data/$scan.pcd
  [ -e "$work/scan.ply" ] || peers python3 /peers/open3d_peer.py prepare "/data/$scan.pcd" "/gallery/$scan/scan.ply"
  case $scan in autzen*) own=$work/scan.ply ;; esac
  timed surface "$bin/pcl_slim_fit" "$own" "$work/surface.slim"
  timed mesh "$bin/pcl_slim_mesh" "$own" "$work/mesh.ply"
  for method in tutorial tuned pivoting; do
    peer $method python3 /peers/open3d_peer.py $method "/gallery/$scan/scan.ply" "/gallery/$scan/$method.ply" "$sides"
  done
  for method in tutorial scale_space; do
    peer cgal_$method /gallery/cgal_peer $method "/gallery/$scan/scan.ply" "/gallery/$scan/cgal_$method.ply"
  done
  # Debian's CloudCompare was built without triangulation, and its -RASTERIZE finds no bounding box: it gives normals.
  peer normals xvfb-run -a CloudCompare -SILENT -AUTO_SAVE OFF -O "/gallery/$scan/scan.ply" -CLEAR_NORMALS \
    -OCTREE_NORMALS auto -ORIENT_NORMS_MST 6 -C_EXPORT_FMT PLY -SAVE_CLOUDS FILE "/gallery/$scan/normals.ply"
}

measures() {
  local truth=() run
  [ "$scan" != stanford_bunny_raw_scans ] || truth=(/data/stanford_bunny_zipper.ply)
  for run in "${meshes[@]}"; do
    ! finished "$run" ||
      peers python3 /peers/open3d_peer.py measure "/gallery/$scan/scan.ply" "/gallery/$scan/$run.ply" \
        "/gallery/$scan/$run.measures.json" ${truth[@]+"${truth[@]}"}
  done
  ! finished normals ||
    peers python3 /peers/open3d_peer.py discs "/gallery/$scan/normals.ply" "/gallery/$scan/scan.ply" "/gallery/$scan/discs.ply"
}

# picture RUN FILE OPTIONS...: tile_RUN.png, the whole picture above a part of it. A run without a file is said to be late.
picture() {
  local run=$1 file=$2 font
  font=$(fc-match -f '%{file}' sans)
  if [ -e "$file" ]; then
    "$bin/pcl_slim_render" "$file" "$work/picture.png" -size 1000x1000 -mode shaded -white 1 -quiet 1 "${@:3}"
    convert \( "$work/picture.png" -resize 300x300 \) \( "$work/picture.png" -crop "$part" +repage \) -append "$work/tile_$run.png"
  else
    convert -size 300x600 xc:white -font "$font" -pointsize 16 -gravity center -annotate 0 'not done in time' "$work/tile_$run.png"
  fi
  tiles+=(-label "${labels[$run]}" "$work/tile_$run.png")
}

pictures() {
  local camera=(-camera "$work/camera.txt") run tiles=()
  "$bin/point_discs" "$work/scan.ply" "$work/points.ply"
  picture surface "$work/surface.slim" -save_camera "$work/camera.txt" -sides both "$@"
  tiles=()
  picture points "$work/points.ply" "${camera[@]}"
  picture surface "$work/surface.slim" "${camera[@]}" -sides both
  for run in "${meshes[@]}"; do picture "$run" "$work/$run.ply" "${camera[@]}" -sides both; done
  picture normals "$work/discs.ply" "${camera[@]}"
  montage -font "$(fc-match -f '%{file}' sans)" -pointsize 15 "${tiles[@]}" -tile 5x -geometry +3+3 "$work/sheet.png"
  convert "$work/sheet.png" -strip -interlace JPEG -sampling-factor 4:2:0 -quality 80 "$out/gallery_$scan.jpg"
}

setup
for scan in "${chosen[@]}"; do
  [ -n "${scans[$scan]-}" ] || {
    echo "unknown scan '$scan'; known are ${order[*]}" >&2
    exit 2
  }
  read -r sides part view <<<"${scans[$scan]}"
  work=$out/$scan
  mkdir -p -- "$work"
  # shellcheck disable=SC2086
  quietly "$scan, runs" "$out/log/$scan.runs.log" runs "$sides"
  quietly "$scan, measures" "$out/log/$scan.measures.log" measures
  # shellcheck disable=SC2086
  quietly "$scan, pictures" "$out/log/$scan.pictures.log" pictures $view
done
python3 "$here/table.py" "$out" "${order[@]}" >"$out/gallery.md"
echo "Pictures and table are in $out"
