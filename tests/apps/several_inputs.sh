#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Several inputs with -out: each has the output that it would have had alone. And places that cannot be written,
# which are found before any work.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

for seed in 1 2 3; do
  "$bin/pcl_slim_demo_scan" s$seed.pcd -points 2500 -seed $seed -quiet || complain 'no scan'
done
"$bin/pcl_slim_smooth" s3.pcd s3.ply -quiet || complain 'no .ply'
head -c 9000 s2.pcd > cut.pcd
mkdir out

# each PROGRAM EXTENSION ARGS...: two inputs at once and each alone.
each() {
  local of=$1 extension=$2
  shift 2
  rm -rf out alone
  mkdir out alone
  expect 0 '' "$of" s1.pcd "$@" s3.ply -out out
  for seed in 1 3; do
    local input
    input=$(ls s$seed.p[cl][dy] | head -n 1)
    [ $seed = 1 ] || input=s3.ply
    local form=${extension:-.${input##*.}}
    "$bin/$of" "$input" "alone/s$seed$form" "$@" > /dev/null || complain "$of: $input fails alone"
    same "alone/s$seed$form" "out/s$seed$form"
  done
  [ "$(ls out | wc -l)" -eq 2 ] || complain "$of made $(ls out)"
}
each pcl_slim_smooth '' -normals -quiet
each pcl_slim_curvature '' -degree 2 -quiet
each pcl_slim_fit .slim -quiet
each pcl_slim_mesh .ply -max_triangles 400 -quiet
each pcl_slim_lines .ply -type ridges -quiet
each pcl_slim_sample .ply -number 300 -quiet
each pcl_color_splat_sampling .ply -rays 0 -quiet
expect 0 '' pcl_slim_fit s1.pcd s3.ply -out=out -format pcd
header out/s1.pcd 'POINTS .*'
expect 0 '' pcl_slim_render out/s1.pcd out/s3.pcd -out out -size 40x30 -format ppm
[ "$(head -c 2 out/s3.ppm)" = P6 ] || complain 'no picture of s3'
[ "$(grep -c '^> Rendering' out.txt)" -eq 2 ] || complain "$(cat out.txt)"

# One input is enough, and reports are one list.
rm -rf out/*
expect 0 '' pcl_slim_smooth s1.pcd -out out
[ -s out/s1.pcd ] || complain 'one input has no output'
expect 0 '' pcl_slim_fit s1.pcd s2.pcd -out out -json list.json
if command -v python3 > /dev/null; then
  python3 -c 'import json
list = json.load(open("list.json"))
assert [r["output"] for r in list] == ["out/s1.slim", "out/s2.slim"], list
assert all(r["program"] == "pcl_slim_fit" and r["points"] == 2500 for r in list), list' || complain 'list.json'
fi

# One that fails is named at the end; the others are done.
rm -rf out/*
got=0
"$bin/pcl_slim_fit" s1.pcd cut.pcd nothere.pcd s2.pcd -out out -quiet -json list.json 2> err.txt || got=$?
[ "$got" -eq 1 ] || complain "failures: exit $got"
[ "$(wc -l < err.txt)" -eq 3 ] || complain "$(cat err.txt)"
[ "$(tail -n 1 err.txt)" = "pcl_slim_fit: 2 of 4 inputs failed: 'cut.pcd', 'nothere.pcd'" ] || complain "$(tail -n 1 err.txt)"
[ "$(echo out/*)" = 'out/s1.slim out/s2.slim' ] || complain "made: $(echo out/*)"
[ "$(grep -c '"program"' list.json)" -eq 2 ] || complain "$(cat list.json)"

# What cannot be is refused before the first input is read.
rm -rf out/*
mkdir other
cp s1.pcd other/
rm -f x.json
expect 2 "'s1.pcd' and 'other/s1.pcd' would both be written to 'out/s1.slim'" pcl_slim_fit s1.pcd other/s1.pcd -out out
expect 2 "'s1.pcd' and 's1.pcd' would both" pcl_slim_smooth s1.pcd s1.pcd -out out
expect 2 "'other/s1.pcd' would be overwritten; give another -out" pcl_slim_smooth s2.pcd other/s1.pcd -out other
expect 2 "'s1.pcd' would be overwritten; give another -out" pcl_slim_smooth s1.pcd s2.pcd -out .
expect 2 "the folder 'nowhere' does not exist; create it first" pcl_slim_smooth s1.pcd s2.pcd -out nowhere
expect 2 'folder' pcl_slim_smooth s1.pcd s2.pcd -out s3.pcd
expect 2 'no IN is given' pcl_slim_smooth -out out
expect 2 'several inputs' pcl_slim_smooth s1.pcd s2.pcd s3.pcd
expect 2 "'scan.xyz' is of a format that is not written: give -format, one of pcd ply las vtp" pcl_slim_smooth s1.pcd scan.xyz -out out
expect 2 '-save_camera is of one input' pcl_slim_render s1.pcd -out out -save_camera x.json
expect 2 '-plan is of one input' pcl_slim_fit s1.pcd -out out -plan other
expect 2 'standard input has no name' pcl_slim_fit s1.pcd - -out out
expect 2 '-format is of -out' pcl_slim_fit s1.pcd x.slim -format slim
expect 2 "give pcd|ply|las|vtp" pcl_slim_smooth s1.pcd -out out -format obj
expect 2 'raise\|exclude' pcl_slim_fit s1.pcd s2.pcd -out out -estimate_normals 2
absent x.json x.slim nowhere
[ -z "$(ls -A out)" ] || complain "left in out: $(ls -A out)"

# A signal ends the input that is worked on and those that follow.
rm -rf out/*
mkfifo never.pcd
"$bin/pcl_slim_fit" s1.pcd never.pcd s2.pcd -out out > /dev/null 2> err.txt &
pid=$!
for _ in $(seq 100); do
  [ ! -e out/s1.slim ] || break
  sleep 0.05
done
sleep 0.2
kill -TERM $pid
got=0
wait $pid || got=$?
[ "$got" -eq 143 ] || complain "stopped: exit $got"
tail -n 1 err.txt | grep -q 'stopped; 1 of 3 inputs are done' || complain "$(cat err.txt)"
[ "$(ls -A out)" = s1.slim ] || complain "left: $(ls -A out)"
sleep 0.2
[ -z "$(pgrep -f "$work/never" || true)" ] || complain 'a process is left'

# Places that cannot be written are found before the scan is read: of one that never comes, too.
early() { # early WORD PROGRAM ARGS...
  local word=$1 got=0
  shift
  timeout 10 "$bin/$1" "${@:2}" > out.txt 2> err.txt || got=$?
  [ "$got" -eq 2 ] || complain "exit $got, not 2 before the work: $* ($(cat err.txt))"
  [ "$(wc -l < err.txt)" -eq 1 ] && grep -q -- "$word" err.txt || complain "no '$word': $* ($(cat err.txt))"
  [ ! -s out.txt ] || complain "work began: $* ($(cat out.txt))"
}
for of in fit:slim smooth:pcd mesh:ply curvature:pcd lines:ply; do
  early "folder 'nowhere' does not exist" pcl_slim_${of%:*} never.pcd nowhere/x.${of#*:}
  early "folder 'nowhere' does not exist" pcl_slim_${of%:*} never.pcd x.${of#*:} -json nowhere/x.json
  early 'it is a folder' pcl_slim_${of%:*} never.pcd x.${of#*:} -json out
done
early "folder 'nowhere' does not exist" pcl_slim_sample never.pcd nowhere/x.ply -number 9
early "folder 'nowhere' does not exist" pcl_color_splat_sampling never.pcd nowhere/x.ply
early "folder 'nowhere' does not exist" pcl_slim_render never.pcd nowhere/x.ppm
early "folder 'nowhere' does not exist" pcl_slim_render never.pcd x.ppm -save_camera nowhere/x
early "folder 'nowhere' does not exist" pcl_slim_render never.pcd nowhere/x.ppm -turntable 3
early '-scratch: the folder .nowhere. does not exist' pcl_slim_fit never.pcd x.slim -scratch nowhere
early '-plan: the folder .nowhere. does not exist' pcl_slim_fit never.pcd x.slim -plan nowhere
early '-plan: the folder .s1.pcd. is a file' pcl_slim_fit never.pcd x.slim -plan s1.pcd
early "folder 'nowhere' does not exist" pcl_slim_demo_scan nowhere/x.pcd
early "folder 'nowhere' does not exist" pcl_slim_benchmark nowhere/x
[ ! -x "$bin/pcl_slim_view" ] || early "folder 'nowhere' does not exist" pcl_slim_view never.pcd -screenshot nowhere/x.png
if [ "$(id -u)" -ne 0 ]; then
  mkdir closed
  chmod 555 closed
  early 'Permission denied' pcl_slim_fit never.pcd closed/x.slim
  early 'read-only' pcl_slim_fit never.pcd x.slim -scratch closed
fi
absent x.slim x.pcd x.ply x.ppm x.json

finish
