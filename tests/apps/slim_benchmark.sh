#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_benchmark: exit status, messages, files, options as documented.
# Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_benchmark
mkdir -p -- pairs
unset DISPLAY

small=(-points 2000 -shapes sphere,cube -noises 0.005 -degrees 2 -kappas 0 -t_mdls 0.01
  -mls_orders 2 -mls_neighbours 30,60 -normal_neighbours 20)

# Per scene 2 x 3 + 1 SLIM runs, 2 of MLS, 1 of normals; tables, and no chart without an X server.
expect 0 '' both "${small[@]}"
grep -q 'xvfb-run' out.txt both.png 2> /dev/null || grep -q 'without VTK' out.txt ||
  complain "nothing is said of the chart: $(tail -1 out.txt)"
[ ! -e both.png ] || complain "a chart without an X server"
[ "$(wc -l < both.csv)" -eq 21 ] || complain "$(wc -l < both.csv) lines in both.csv"
[ "$(awk -F, 'NF != 16' both.csv | wc -l)" -eq 0 ] || complain "rows of both.csv differ in length"
[ "$(grep -c '^| .*none' both.md)" -ge 2 ] || complain "no ratios in both.md"

# Errors depend on the input alone.
expect 0 '' again "${small[@]}" -threads 1 -chart 0 -quiet
[ ! -s out.txt ] || complain "-quiet says: $(cat out.txt)"
diff <(cut -d, -f1-7,11-14 both.csv) <(cut -d, -f1-7,11-14 again.csv) > /dev/null ||
  complain "errors change with the threads"

# A pair of files, point by point.
noisyPlane pairs
expect 0 '' pair -pairs pairs -methods slim -degrees 1 -kappas 0 -t_mdls 0
grep -q '^plane,900,0,1,slim,default,0,' pair.csv || complain "no plane in pair.csv"
expect 0 '' file -input pairs/plane_noisy.ply -truth pairs/plane_original.ply -methods mls \
  -mls_orders 1 -mls_neighbours 20
grep -q '^plane_noisy,900,0,1,mls,order 1 k 20,0,' file.csv || complain "no MLS in file.csv"

head -c 3000 pairs/plane_noisy.ply > short.ply
printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' > one.ply

# A mesh as truth, with another number of points than the scan.
{
  printf 'ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n'
  printf 'property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n'
  printf '%s\n' '-1 -1 0' '31 -1 0' '31 31 0' '-1 31 0' '3 0 1 2' '3 0 2 3'
} > square.ply
expect 0 '' mesh -input pairs/plane_noisy.ply -truth square.ply -methods slim -degrees 1 -kappas 0 \
  -t_mdls 0 -chart 0
grep -q '^plane_noisy,900,0,1,slim,default,0,' mesh.csv || complain "no plane in mesh.csv"
grep -q 'off by 0.0[0-9]* RMS' mesh.md || complain "the input's error is not in mesh.md"

rm -f -- ./*.csv ./*.md
expect 2 'or a mesh' x -input pairs/plane_noisy.ply -truth one.ply
expect 2 'OUT_PREFIX'
expect 2 'OUT_PREFIX' -quiet 1
expect 2 'unknown option' x -claims rims
expect 2 'tea' x -shapes tea
expect 2 'noises' x -noises 1,a
expect 2 'whole numbers' x -degrees 5
expect 2 'methods' x -methods apss
expect 2 'give some' x -shapes ,
expect 2 'truth' x -input pairs/plane_noisy.ply
expect 2 'missing.ply' x -input missing.ply -truth missing.ply
expect 2 'original' x -pairs .
expect 2 'leave it out' x -pairs pairs -noises 0
expect 2 'exclude' x -pairs pairs -input a.ply
expect 2 'short.ply' x -input short.ply -truth pairs/plane_original.ply
expect 2 'no/such' no/such/x "${small[@]}"
[ -z "$(find . -name '*.csv' -o -name '*.md' -o -name '*.png')" ] || complain "files left behind"

documented "$program"

finish
