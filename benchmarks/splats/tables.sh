#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The tables of benchmarks/README.md as Markdown: tables.sh BIN DATA, folders of the built programs and of
# real scans. Scans that are not there are passed over. A few minutes.
set -euo pipefail
[ $# -eq 2 ] || { echo "usage: tables.sh BIN DATA" >&2; exit 2; }
bin=$1 data=$2
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

"$bin/splat_object" "$work/duck.pcd" > "$work/duck.txt"
"$bin/pcl_slim_demo_scan" "$work/amphora.pcd" -quiet 1
eye=$(sed 's/.* at //' "$work/duck.txt")
clouds=("$work/duck.pcd" "$work/amphora.pcd")
for name in lion_takanawa autzen_stadium kinect_mosd_learn13; do
  [ -f "$data/$name.pcd" ] && clouds+=("$data/$name.pcd")
done

for cloud in "${clouds[@]}"; do
  for share in 0.05 0.1; do
    name=$(basename "${cloud%.pcd}")
    "$bin/splat_quality" "$cloud" -share $share -focus "$eye,0.12" > "$work/$name $share.txt"
  done
done

# column K FILE: field K of each method's row, in the order of the methods.
column() { awk -F ' *[|] *' -v k="$1" '/^\| [a-z]/ && !/^\| method/ { print $k }' "$2"; }
# rounded: numbers to two digits behind the point.
rounded() { awk '{ printf "%.2f\n", $1 }'; }
# cells: lines as the cells of one row.
cells() { sed 's/^/ /; s/$/ |/' | tr -d '\n'; }

heading="| cloud | share |$(column 2 "$work/duck 0.05.txt" | cells)"
rule=$(sed 's/[^|]//g; s/|/|---/g; s/---$//' <<< "$heading")

# table K FORM TITLE CLOUD...: field K through FORM.
table() {
  local field=$1 form=$2
  printf '\n%s\n\n%s\n%s\n' "$3" "$heading" "$rule"
  shift 3
  for cloud in "$@"; do
    for share in 0.05 0.1; do
      name=$(basename "${cloud%.pcd}")
      echo "| $name | $share |$(column "$field" "$work/$name $share.txt" | "$form" | cells)"
    done
  done
}

printf 'Delta E, mean / 95th percentile\n\n%s budget / uniform | with gradient |\n%s---|---|\n' \
  "$heading" "$rule"
for cloud in "${clouds[@]}"; do
  for share in 0.05 0.1; do
    name=$(basename "${cloud%.pcd}")
    file="$work/$name $share.txt"
    ratio=$(column 4 "$file" | awk 'NR == 1 { u = $1 } NR == 5 || NR == 6 { printf " %.2f |", $1 / u }')
    echo "| $name | $share |$(paste -d / <(column 4 "$file" | rounded) <(column 5 "$file") | sed 's|/| / |' | cells)$ratio"
  done
done
table 6 cat 'Holes: per cent of inner pixels' "${clouds[@]}"
table 7 cat 'Lost: pixels that only all points cover, per cent' "${clouds[@]}"
table 8 cat 'Extra: pixels that only the splats cover, per cent' "${clouds[@]}"
table 9 rounded "Focus: Delta E about the duck's eye" "$work/duck.pcd"

for cloud in "$work/duck.pcd" "$data/lion_takanawa.pcd"; do
  [ -f "$cloud" ] || continue
  for paper in 0 1; do
    echo
    "$bin/splat_relations" "$cloud" -paper $paper
  done
done

# The same amphora scanned again: pictures of two scans are no closer than that.
for points in 200000 1000000; do
  "$bin/pcl_slim_demo_scan" "$work/first.pcd" -points $points -quiet 1
  "$bin/pcl_slim_demo_scan" "$work/second.pcd" -points $points -seed 2 -quiet 1
  echo
  "$bin/splat_quality" "$work/first.pcd" -share 0.1 -again "$work/second.pcd" |
    grep -E '^[|] (method|uniform|budget|scanned again) |^[|]---' | cut -d '|' -f 1-5 | sed 's/$/|/'
done
