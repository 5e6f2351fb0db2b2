#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the programs on a small scan under valgrind's memcheck: tests/valgrind.sh [BIN].
# Any invalid access, use of uninitialised memory or definite leak ends it with status 1.
set -euo pipefail
bin=$(cd -- "${1:-build/release/bin}" && pwd)
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
cd -- "$work"

# Highway reads the processor's clock when it is loaded, by an instruction that valgrind 3.19 does not
# know; nothing here uses what it measures.
echo 'unsigned long timer() __asm__("_ZN3hwy8platform15TimerResolutionEv"); unsigned long timer() { return 1; }' |
  c++ -x c++ - -shared -fPIC -o timer.so

checked() {
  echo "$*"
  if ! LD_PRELOAD=$work/timer.so valgrind --quiet --error-exitcode=9 --leak-check=full \
    --show-leak-kinds=definite --errors-for-leak-kinds=definite --track-origins=yes \
    "$bin/$1" "${@:2}" > log 2>&1; then
    cat log >&2
    exit 1
  fi
}

"$bin/pcl_slim_demo_scan" -points 8000 scan.pcd -quiet
checked pcl_slim_fit scan.pcd surface.slim
checked pcl_slim_smooth scan.pcd smooth.pcd
checked pcl_slim_curvature scan.pcd curvature.pcd
checked pcl_slim_lines scan.pcd lines.vtp
checked pcl_slim_render surface.slim picture.png -size 160x120
checked pcl_slim_render surface.slim traced.png -size 160x120 -mode raytraced
checked pcl_color_splat_sampling scan.pcd splats.ply
echo "no error, no leak"
