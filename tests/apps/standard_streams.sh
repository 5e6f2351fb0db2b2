#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Files named -: standard input and output, which has the file's bytes alone; programs in a pipe.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
TMPDIR=$PWD/temporary
export TMPDIR
mkdir "$TMPDIR"

"$bin/pcl_slim_demo_scan" scan.pcd -points 3000 -quiet || complain 'no scan'
"$bin/pcl_slim_fit" scan.pcd scan.slim -quiet || complain 'no surface'

# streamed PROGRAM EXTENSION ARGS...: the bytes of the file, and what is printed on stderr.
streamed() {
  local of=$1 form=$2
  shift 2
  "$bin/$of" "$@" "file$form" -format "${form#.}" > /dev/null 2> err.txt && complain "-format beside a name: $of"
  "$bin/$of" "$@" "file$form" > said.txt || complain "$of fails"
  "$bin/$of" "$@" - -format "${form#.}" > "stream$form" 2> err.txt || complain "$of -: $(cat err.txt)"
  same "file$form" "stream$form"
  grep -q '^> Loading' said.txt && grep -q '^> Loading' err.txt || complain "$of - is silent"
  "$bin/$of" "$@" - -format "${form#.}" -quiet > "stream$form" 2> err.txt
  same "file$form" "stream$form"
  [ ! -s err.txt ] || complain "$of - -quiet: $(cat err.txt)"
}
for form in slim pcd ply; do streamed pcl_slim_fit .$form scan.pcd; done
for form in pcd ply las; do streamed pcl_slim_smooth .$form scan.pcd; done
for form in ply obj stl glb; do streamed pcl_slim_mesh .$form scan.pcd; done
for form in ply pcd svg; do streamed pcl_slim_lines .$form scan.pcd; done
streamed pcl_slim_curvature .ply scan.pcd
streamed pcl_slim_sample .pcd scan.slim -number 300
streamed pcl_color_splat_sampling .ply scan.pcd
streamed pcl_slim_render .ppm scan.slim -size 40x30
streamed pcl_slim_render .html scan.slim
grep -q '^> Saving standard output \|^> Writing standard output ' err.txt ||
  "$bin/pcl_slim_render" scan.slim - -format html 2>&1 > /dev/null | grep -q 'Writing standard output' ||
  complain 'the stream is not named'

# Without -format: the usual one, or that of the scan.
"$bin/pcl_slim_fit" scan.pcd - > a.slim 2> /dev/null
same a.slim scan.slim
"$bin/pcl_slim_smooth" scan.pcd b.pcd -quiet
"$bin/pcl_slim_smooth" scan.pcd - -quiet > c.pcd
same b.pcd c.pcd
"$bin/pcl_slim_demo_scan" - -points 3000 -quiet > d.pcd
same d.pcd scan.pcd
expect 2 'no name to tell its format: give -format, one of pcd ply las vtp' pcl_slim_smooth - - < scan.pcd
"$bin/pcl_slim_smooth" - - -format pcd -quiet < scan.pcd > c.pcd
same b.pcd c.pcd

# Pipes from end to end, as files give them.
"$bin/pcl_slim_mesh" scan.slim mesh.ply -quiet || complain 'no mesh'
"$bin/pcl_slim" fit scan.pcd - -quiet | "$bin/pcl_slim" mesh - out.ply -quiet || complain 'fit | mesh'
same mesh.ply out.ply
"$bin/pcl_slim" fit - - -quiet < scan.pcd | "$bin/pcl_slim" mesh - - -quiet > out.ply || complain '< fit | mesh >'
same mesh.ply out.ply
"$bin/pcl_slim_sample" scan.slim samples.ply -number 300 -quiet
"$bin/pcl_slim" fit scan.pcd - -quiet | "$bin/pcl_slim" sample - - -number 300 -quiet > out.ply || complain 'fit | sample'
same samples.ply out.ply
"$bin/pcl_slim_render" scan.slim picture.ppm -size 40x30 -quiet
"$bin/pcl_slim" fit scan.pcd - -quiet | "$bin/pcl_slim" render - picture2.ppm -size 40x30 -quiet || complain 'fit | render'
same picture.ppm picture2.ppm
"$bin/pcl_slim" fit scan.pcd - -quiet | "$bin/pcl_slim" smooth scan.pcd e.pcd -surface - -quiet || complain '-surface -'
"$bin/pcl_slim_smooth" scan.pcd f.pcd -surface scan.slim -quiet
same e.pcd f.pcd
"$bin/pcl_slim" smooth scan.pcd - -quiet | "$bin/pcl_slim" fit - g.slim -quiet || complain 'smooth | fit'
"$bin/pcl_slim_fit" b.pcd h.slim -quiet
same g.slim h.slim

# Reports: on standard output, and what they name it.
"$bin/pcl_slim_fit" scan.pcd a.slim -json - > report.json 2> err.txt || complain '-json -'
[ "$(value report.json program)" = '"pcl_slim_fit"' ] && [ "$(head -c 1 report.json)" = '{' ] || complain "$(cat report.json)"
"$bin/pcl_slim_fit" scan.pcd - -json report.json -quiet > /dev/null
[ "$(value report.json output)" = '"-"' ] || complain "output: $(value report.json output)"

# What cannot be a stream, or has no reader.
expect 2 'standard output takes one file' pcl_slim_fit scan.pcd - -json -
expect 2 'read once: give - for one file only' pcl_slim_smooth - x.pcd -surface - < scan.pcd
expect 2 'a .pvtp a folder of files' pcl_slim_fit scan.pcd - -format pvtp
expect 2 'takes one picture' pcl_slim_render scan.slim - -turntable 3
expect 2 'is empty' pcl_slim_fit - x.slim < <(true)
got=0
"$bin/pcl_slim_fit" scan.pcd - >&- 2> err.txt || got=$?
[ "$got" -eq 2 ] && grep -q 'standard output is closed' err.txt || complain "closed: exit $got, $(cat err.txt)"
got=0
"$bin/pcl_slim_fit" scan.pcd - -quiet 2> err.txt > /dev/full || got=$?
[ "$got" -eq 1 ] && grep -q 'cannot write standard output' err.txt || complain "full: exit $got, $(cat err.txt)"
{
  got=0
  "$bin/pcl_slim_mesh" scan.slim - -quiet 2> err.txt || got=$?
  echo "$got" > got.txt
} | true
[ "$(cat got.txt)" -eq 1 ] && grep -q 'what read it has ended' err.txt || complain "no reader: $(cat got.txt err.txt)"
expect 1 'NaN\|no points\|finite' pcl_slim_fit - x.slim < <(printf 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nDATA ascii\nnan nan nan\n')
if command -v script > /dev/null; then
  script -qec "'$bin/pcl_slim_fit' scan.pcd -" /dev/null > terminal.txt < /dev/null && complain 'a binary file on a terminal'
  grep -q 'a terminal, which shows no .slim: redirect it' terminal.txt || complain "$(head -c 300 terminal.txt)"
  script -qec "'$bin/pcl_slim_lines' scan.pcd - -format svg -quiet" /dev/null > terminal.txt < /dev/null || complain 'no text on a terminal'
  script -qec "'$bin/pcl_slim_fit' - x.slim" /dev/null > terminal.txt && complain 'a scan from a terminal'
  grep -q 'standard input is a terminal' terminal.txt || complain "$(head -c 300 terminal.txt)"
fi
absent x.slim x.pcd - ./-
[ -z "$(ls -A "$TMPDIR")" ] || complain "temporary files: $(ls -A "$TMPDIR")"

# A signal leaves no temporary file.
mkfifo never.pcd
"$bin/pcl_slim_fit" never.pcd - > /dev/null 2> err.txt &
pid=$!
sleep 0.3
kill -TERM $pid
got=0
wait $pid || got=$?
[ "$got" -eq 143 ] || complain "stopped: exit $got"
[ -z "$(ls -A "$TMPDIR")" ] || complain "temporary files: $(ls -A "$TMPDIR")"

finish
