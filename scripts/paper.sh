#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Remakes the figures and tables of docs/paper.md: scripts/paper.sh DATA OUT. DATA is a folder of scans
# (benchmarks/README.md names them), OUT gets tables and pictures. Half an hour on two cores: twenty minutes of it the
# studies of paper_bench, most of them the sweeps of Fig. 21 and of ellipsoidal supports.
# Needs ImageMagick, fontconfig and, for some pictures, rsvg-convert and xvfb-run.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
if [ $# -ne 2 ] || [ ! -d "$1" ]; then
  echo "usage: scripts/paper.sh DATA OUT, DATA a folder of scans" >&2
  exit 2
fi
mkdir -p -- "$2"
data=$(cd -- "$1" && pwd) out=$(cd -- "$2" && pwd)

bash "$root/scripts/setup.sh"
configure -DPCL_SLIM_BUILD_BENCHMARKS=ON
build scale_bench pcl_slim_fit pcl_slim_render pcl_slim_view pcl_slim_smooth pcl_slim_demo_scan pcl_color_splat_sampling paper_bench mesh_bench \
  mesh_picture phong_picture rays_bench rays_model qsplat_bench splat_object splat_quality splat_relations lines_bench
bin=$root/build/release/bin
part() { quietly "$1" "$out/log/$1.log" "${@:2}"; }

part studies "$bin/paper_bench" "$data" "$out"
for plot in fig04 fig05 fig06 fig08 fig21 fig21_paper; do
  command -v rsvg-convert > /dev/null && rsvg-convert "$out/$plot.svg" -o "$out/$plot.png"
done
mkdir -p -- "$out/meshes"
part meshes "$bin/mesh_bench" "$data" -filters paper -save "$out/meshes"
cp -- "$out/log/meshes.log" "$out/fig20.md"
part mesh-pictures "$root/benchmarks/mesh/pictures.sh" "$bin" "$data" "$out" "$out/meshes"
part pictures "$root/benchmarks/render/figures.sh" "$bin" "$data" "$out"
part levels "$root/benchmarks/paper/levels.sh" "$bin" "$out"
part beside "$root/benchmarks/paper/splats_beside.sh" "$bin" "$data" "$out"
part qsplat "$root/benchmarks/qsplat/figures.sh" "$bin" "$out/qsplat" "$out"
part splat-pictures "$root/benchmarks/splats/figures.sh" "$bin" "$data" "$out"
part splat-tables "$root/benchmarks/splats/tables.sh" "$bin" "$data"
part lines "$bin/lines_bench" -turned
echo "Tables and pictures are in $out, what the programs printed in $out/log"
