#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every program ends with 128 + the signal's number, leaves no file and keeps an older output.
set -uo pipefail
bin=$1
work=$2
cd "$work" || exit 1
rm -rf -- ./* ./.pcl_slim_*
complaints=0
complain() {
  echo "$*" >&2
  complaints=$((complaints + 1))
}

"$bin/pcl_slim_demo_scan" scan.pcd -points 1000000 -noise 0.003 -quiet 1 || exit 1
"$bin/pcl_slim_demo_scan" small.pcd -points 20000 -quiet 1 || exit 1
"$bin/pcl_slim_fit" small.pcd surface.slim -quiet 1 || exit 1

# stops SIGNAL NUMBER OUTPUT PROGRAM ARGUMENT...
stops() {
  local signal=$1 number=$2 output=$3 program=$4 pid status
  shift 4
  echo old >"$output"
  : >log
  "$bin/$program" "$@" >log 2>&1 &
  pid=$!
  # Before its first line a program is still being loaded and knows no signals.
  for ((i = 0; i < 1000; ++i)); do
    [ ! -s log ] || break
    sleep 0.02
  done
  kill "-$signal" $pid || complain "$program had ended before the signal: $(cat log)"
  wait $pid
  status=$?
  [ $status -eq $((128 + number)) ] || complain "$program ended with $status after $signal: $(cat log)"
  grep -qx old "$output" || complain "$program touched its output after $signal"
  [ -z "$(find . -name '.pcl_slim_*')" ] || complain "$program left $(find . -name '.pcl_slim_*')"
}

stops ALRM 14 out.slim pcl_slim_fit scan.pcd out.slim
for signal in 'INT 2' 'TERM 15' 'HUP 1'; do
  # shellcheck disable=SC2086
  {
    stops $signal out.slim pcl_slim_fit scan.pcd out.slim
    stops $signal out.pcd pcl_slim_smooth scan.pcd out.pcd
    stops $signal out.pcd pcl_slim_curvature scan.pcd out.pcd
    stops $signal out.pcd pcl_color_splat_sampling scan.pcd out.pcd -threads 1
    stops $signal out.png pcl_slim_render surface.slim out.png -size 1600x1200 -aa 4
    stops $signal out.pcd pcl_slim_demo_scan out.pcd -points 5000000
  }
done
[ $complaints -eq 0 ]
