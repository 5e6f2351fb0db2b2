#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fits every .pcd and .ply of a folder with the defaults, at degree 2, and meshes in paper mode as
# well, and writes reports, pictures and the tables of benchmarks/README.md.
#   benchmarks/tables/scan_table.sh DATA_FOLDER OUT_FOLDER
# The programs are those of build/release/bin, or of the folder named by BIN_DIR. Needs python3.
# THREADS (2) and REPEATS (3: the fastest fit is reported) may be set.
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
program=pcl_slim_fit
source "$here/data_arguments.sh"
[ $# -eq 2 ] || usage "$script takes two folders; see $script -h"
threads=${THREADS:-2}
repeats=${REPEATS:-3}
shopt -s nullglob
scans=("$data"/*.pcd "$data"/*.ply)
[ ${#scans[@]} -gt 0 ] || usage "$data has no .pcd or .ply scan"

# fit SCAN NAME OPTION...: report NAME.N.json of each repeat, surface NAME.slim, output NAME.log.
fit() {
  local scan=$1 name=$2 repeat
  shift 2
  rm -f -- "$out/$name".*json "$out/$name.slim" "$out/$name.log"
  for ((repeat = 1; repeat <= repeats; ++repeat)); do
    "$bin/pcl_slim_fit" "$scan" "$out/$name.slim" -json "$out/$name.$repeat.json" \
      -threads "$threads" "$@" >"$out/$name.log" 2>&1 || return
  done
}

failures=0
for scan in "${scans[@]}"; do
  name=$(basename -- "$scan")
  echo "$name" >&2
  if ! fit "$scan" "$name.default"; then
    echo "  failed: $(tail -n 1 -- "$out/$name.default.log")" >&2
    failures=$((failures + 1))
    continue
  fi
  fit "$scan" "$name.degree2" -degree 2 || failures=$((failures + 1))
  "$bin/pcl_slim_render" "$out/$name.default.slim" "$out/$name.png" -size 400x320 -white 1 \
    -threads "$threads" -quiet 1 || failures=$((failures + 1))
  grep -q '"normals": "mesh"' "$out/$name.default.1.json" || continue
  for degree in 1 2 3; do
    fit "$scan" "$name.paper$degree" -paper 1 -t_mdl 0.02 -degree "$degree" ||
      failures=$((failures + 1))
  done
done

python3 "$here/scan_table.py" "$out" | tee "$out/tables.md"
[ "$failures" -eq 0 ] || { echo "$failures runs failed; their .log files say why" >&2; exit 1; }
