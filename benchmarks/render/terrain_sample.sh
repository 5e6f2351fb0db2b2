#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Some points of a scan at random, x y z as text on stdout: terrain_sample.sh BIN SCAN COUNT. BIN is the folder of the
# built programs, which read the scan whatever its format.
set -euo pipefail
[ $# -eq 3 ] || { echo "usage: terrain_sample.sh BIN SCAN COUNT" >&2; exit 2; }
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
copy=$(mktemp --suffix=.ply)
trap 'rm -f -- "$copy"' EXIT
# The points do not move; the .ply has seven floats more.
"$1/pcl_slim_curvature" "$2" "$copy" -quiet 1
count=$(sed -n '/^element vertex/ { s/.* //p; q }' "$copy")
tail -c $((count * 40)) "$copy" | od -An -v -w40 -tf4 | awk '{ print $1, $2, $3 }' | "$here/made_points.sh" random "$3"
