#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Turns a scan into a SLIM surface, a report, a picture and a page for browsers in demo_out/.
#   scripts/demo.sh             makes a scan of its own: no download
#   scripts/demo.sh SCAN.pcd    takes yours (.pcd or .ply)
# BIN_DIR in the environment: a folder of built programs; then nothing is built.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

case ${1-} in
  -h | --help) sed -n 's/^# \{0,1\}//; 3,5p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
if [ $# -gt 1 ]; then
  echo "demo.sh takes one scan at most" >&2
  exit 2
fi
scan=
if [ $# -eq 1 ]; then
  if [ ! -r "$1" ] || [ -d "$1" ]; then
    echo "$1 cannot be read: give the path of a .pcd or .ply file" >&2
    exit 2
  fi
  scan=$1
  [ "${scan#-}" = "$scan" ] || scan=./$scan # no option
fi

bin=${BIN_DIR:-$root/build/release/bin}
if [ -z "${BIN_DIR-}" ]; then
  bash "$root/scripts/setup.sh"
  configure
  build pcl_slim_fit pcl_slim_render pcl_slim_demo_scan
fi

out=$root/demo_out
[ "$PWD" != "$root" ] || out=demo_out
mkdir -p -- "$out"
rm -f -- "$out/surface.slim" "$out/fit.json" "$out/surface.png" "$out/surface.html"
echo
if [ -z "$scan" ]; then
  scan=$out/scan.pcd
  "$bin/pcl_slim_demo_scan" "$scan"
fi
"$bin/pcl_slim_fit" "$scan" "$out/surface.slim" -json "$out/fit.json"
"$bin/pcl_slim_render" "$out/surface.slim" "$out/surface.png"
"$bin/pcl_slim_render" "$out/surface.slim" "$out/surface.html"

echo
echo "Scan      $scan"
echo "Surface   $out/surface.slim"
echo "Report    $out/fit.json"
echo "Picture   $out/surface.png"
echo "Page      $out/surface.html   (any browser opens it)"
