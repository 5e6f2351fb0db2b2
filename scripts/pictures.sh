#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Remakes the pictures of docs/images: scripts/pictures.sh DATA [OUT [STAGE...]]. DATA is a folder of scans
# (benchmarks/README.md names them), OUT docs/images if not given. Stages:
#   tutorial scans pages compare figures levels meshes smoothing splats beside qsplat paper     by default, fifteen minutes on two
#                       cores: windows four, QSplat three, meshes and levels of detail one each
#   python              those of docs/python.md, by the examples of python/
#   web                 photographs of a browser; needs node and Chromium
#   tiles               a statue of 10 and of 100 million points; ten minutes, 2 GB on the disk
#   pareto              the chart of SLIM beside MLS: an hour
# Needs ImageMagick, fontconfig, python3, rsvg-convert and, for windows, xvfb-run and xdotool. slim_surface.png is a drawing.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
if [ $# -lt 1 ] || [ ! -d "$1" ]; then
  echo "usage: scripts/pictures.sh DATA [OUT [STAGE...]], DATA a folder of scans" >&2
  exit 2
fi
data=$(cd -- "$1" && pwd) out=${2-$root/docs/images}
mkdir -p -- "$out"
out=$(cd -- "$out" && pwd)
stages=("${@:3}")
[ ${#stages[@]} -gt 0 ] ||
  stages=(tutorial scans pages compare figures levels meshes smoothing splats beside qsplat paper)
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

bash "$root/scripts/setup.sh"
configure -DPCL_SLIM_BUILD_BENCHMARKS=ON -DPCL_SLIM_BUILD_EXAMPLES=ON
build scale_bench pcl_slim_fit pcl_slim_render pcl_slim_view pcl_slim_smooth pcl_slim_demo_scan pcl_color_splat_sampling \
  pcl_slim_mesh pcl_slim_lines pcl_slim_sample pcl_slim_compare pcl_slim_curvature paper_bench mesh_bench mesh_picture phong_picture \
  qsplat_bench denoise_bench splat_object splat_quality point_discs pcl_slim_benchmark \
  pcl_slim_example_03_pcl_visualizer pcl_slim_example_06_pipeline_visualizer
bin=$root/build/release/bin
here=$root/benchmarks
part() { quietly "$1" "$work/$1.log" "${@:2}"; }

for stage in "${stages[@]}"; do
  case $stage in
    tutorial) part tutorial "$here/render/tutorial_pictures.sh" "$bin" "$data" "$out" ;;
    scans) part scans "$here/render/scan_pictures.sh" "$bin" "$data" "$out" ;;
    pages) part pages "$here/render/page_pictures.sh" "$bin" "$data" "$out" ;;
    compare) part compare "$here/render/compare_pictures.sh" "$bin" "$data" "$out" ;;
    figures) part figures "$here/render/figures.sh" "$bin" "$data" "$out" ;;
    levels)
      part levels "$here/paper/levels.sh" "$bin" "$work"
      cp -- "$work/paper_fig10.png" "$out"
      ;;
    meshes) part meshes "$here/mesh/pictures.sh" "$bin" "$data" "$out" ;;
    smoothing) part smoothing "$here/splats/smoothing.sh" "$bin" "$data" "$out" ;;
    splats) part splats "$here/splats/figures.sh" "$bin" "$data" "$out" ;;
    beside) part beside "$here/paper/splats_beside.sh" "$bin" "$data" "$out" ;;
    qsplat) part qsplat "$here/qsplat/figures.sh" "$bin" "$work/qsplat" "$out" ;;
    paper)
      for figure in 4 5 6 7 8 21; do part "figure-$figure" "$bin/paper_bench" "$data" "$work" -figure $figure; done
      for plot in fig04 fig05 fig06 fig08 fig21_paper; do
        rsvg-convert -z 1.5 "$work/$plot.svg" -o "$out/paper_$plot.png"
      done
      convert "$work/fig07.png" -crop 320x320 +repage "$work/level_%d.png"
      levels=()
      for level in 0 1 2 3 4; do levels+=(-label "level $((level + 1))" "$work/level_$level.png"); done
      montage -font "$(fc-match -f '%{file}' sans)" -pointsize 15 "${levels[@]}" -tile 5x -geometry +0+2 \
        -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time \
        "$out/paper_fig07.png"
      ;;
    web) part web "$here/render/web_pictures.sh" "$bin" "$data" "$out" ;;
    python)
      build _pcl_slim
      part python "$root/python/examples/pictures.sh" "$root/build/release/python" "$out"
      ;;
    tiles) part tiles "$here/render/tile_pictures.sh" "$bin" "$data" "$out" ;;
    pareto)
      BIN_DIR=$bin part pareto "$here/tables/comparison.sh" "$data" "$work/comparison" timed
      cp -- "$work/comparison/timed.png" "$out/pareto_exact.png"
      ;;
    *)
      echo "unknown stage '$stage'; the head of scripts/pictures.sh lists them" >&2
      exit 2
      ;;
  esac
done
echo "Pictures are in $out"
