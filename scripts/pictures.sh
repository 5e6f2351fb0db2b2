#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Remakes the pictures of docs/images: scripts/pictures.sh DATA [OUT]. DATA is a folder of scans
# (benchmarks/README.md names them), OUT docs/images if not given. Fifteen minutes on two cores: windows four,
# QSplat three, meshes and levels of detail one each. Needs ImageMagick, fontconfig, rsvg-convert and, for windows, xvfb-run and xdotool. Not among them: web_page and
# web_page_color, photographs of a browser (docs/web_page.md), slim_surface, a drawing, tiles_seam and tiles_100m of
# larger clouds (docs/tiles.md), and pareto_exact, which benchmarks/tables/comparison.sh makes in an hour.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
if [ $# -lt 1 ] || [ $# -gt 2 ] || [ ! -d "$1" ]; then
  echo "usage: scripts/pictures.sh DATA [OUT], DATA a folder of scans" >&2
  exit 2
fi
data=$(cd -- "$1" && pwd) out=${2-$root/docs/images}
mkdir -p -- "$out"
out=$(cd -- "$out" && pwd)
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

bash "$root/scripts/setup.sh"
configure -DPCL_SLIM_BUILD_BENCHMARKS=ON -DPCL_SLIM_BUILD_EXAMPLES=ON
build scale_bench pcl_slim_fit pcl_slim_render pcl_slim_view pcl_slim_smooth pcl_slim_demo_scan pcl_color_splat_sampling \
  pcl_slim_mesh pcl_slim_lines pcl_slim_sample pcl_slim_curvature paper_bench mesh_bench mesh_picture phong_picture \
  qsplat_bench denoise_bench splat_object splat_quality point_discs \
  pcl_slim_example_03_pcl_visualizer pcl_slim_example_06_pipeline_visualizer
bin=$root/build/release/bin
part() { quietly "$1" "$work/$1.log" "${@:2}"; }

part tutorial "$root/benchmarks/render/tutorial_pictures.sh" "$bin" "$data" "$out"
part scans "$root/benchmarks/render/scan_pictures.sh" "$bin" "$data" "$out"
part pages "$root/benchmarks/render/page_pictures.sh" "$bin" "$data" "$out"
part figures "$root/benchmarks/render/figures.sh" "$bin" "$data" "$out"
part levels "$root/benchmarks/paper/levels.sh" "$bin" "$work"
cp -- "$work/paper_fig10.png" "$out"
part meshes "$root/benchmarks/mesh/pictures.sh" "$bin" "$data" "$out"
part smoothing "$root/benchmarks/splats/smoothing.sh" "$bin" "$data" "$out"
part splats "$root/benchmarks/splats/figures.sh" "$bin" "$data" "$out"
part beside "$root/benchmarks/paper/splats_beside.sh" "$bin" "$data" "$out"
part qsplat "$root/benchmarks/qsplat/figures.sh" "$bin" "$work/qsplat" "$out"
for figure in 4 5 6 7 8 21; do part "figure-$figure" "$bin/paper_bench" "$data" "$work" -figure $figure; done
for plot in fig04 fig05 fig06 fig08 fig21_paper; do
  rsvg-convert -z 1.5 "$work/$plot.svg" -o "$out/paper_$plot.png"
done
convert "$work/fig07.png" -crop 320x320 +repage "$work/level_%d.png"
levels=()
for level in 0 1 2 3 4; do levels+=(-label "level $((level + 1))" "$work/level_$level.png"); done
montage -font "$(fc-match -f '%{file}' sans)" -pointsize 15 "${levels[@]}" -tile 5x -geometry +0+2 \
  -define png:color-type=2 -define png:compression-level=9 -define png:exclude-chunks=date,time "$out/paper_fig07.png"
echo "Pictures are in $out"
