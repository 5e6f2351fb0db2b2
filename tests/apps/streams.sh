#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Inputs that can be read once only: named pipes of every format, /dev/stdin and the output of a command; the
# same bytes as of the file, whatever the pace of the writer.
. "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

"$bin/pcl_slim_demo_scan" scan.pcd -points 4000 -quiet 1 || complain 'no scan'
"$bin/pcl_slim_smooth" scan.pcd scan.ply -quiet 1 || complain 'no .ply'
"$bin/pcl_slim_smooth" scan.pcd scan.las -quiet 1 || complain 'no .las'
"$bin/pcl_slim_fit" scan.pcd scan.slim -quiet 1 || complain 'no .slim'
"$bin/pcl_slim_fit" scan.pcd surfels.pcd -quiet 1 || complain 'no surfels'
"$bin/pcl_slim_mesh" scan.slim mesh.off.ply -quiet 1 || complain 'no mesh'
awk 'BEGIN { for (i = 0; i < 3000; ++i) { a = i * 2.4; z = 1 - (2 * i + 1) / 3000; r = sqrt(1 - z * z)
  printf "%.6f %.6f %.6f\n", r * cos(a), r * sin(a), z } }' > scan.xyz

# piped PROGRAM FILE OUT ARGS...: the same bytes from the file, from a named pipe whose writer writes at
# once, from /dev/stdin and from the output of a command.
piped() {
  local of=$1 file=$2 out=$3 extension=${2##*.}
  shift 3
  expect 0 '' "$of" "$file" "file_$out" -quiet 1 "$@"
  rm -f "pipe.$extension"
  mkfifo "pipe.$extension"
  timeout 60 cat "$file" > "pipe.$extension" &
  expect 0 '' "$of" "pipe.$extension" "pipe_$out" -quiet 1 "$@"
  wait
  same "file_$out" "pipe_$out"
  expect 0 '' "$of" /dev/stdin "pipe_$out" -quiet 1 "$@" < <(cat "$file")
  same "file_$out" "pipe_$out"
  expect 0 '' "$of" <(cat "$file") "pipe_$out" -quiet 1 "$@"
  same "file_$out" "pipe_$out"
}

for form in pcd ply las xyz; do
  piped pcl_slim_fit scan.$form a.slim
done
piped pcl_slim_smooth scan.pcd b.pcd
piped pcl_slim_smooth scan.pcd b.pcd -surface scan.slim
piped pcl_slim_curvature scan.ply c.ply
piped pcl_slim_lines scan.pcd d.ply
piped pcl_color_splat_sampling scan.pcd e.ply
piped pcl_slim_mesh scan.pcd f.ply
piped pcl_slim_mesh surfels.pcd f.ply
piped pcl_slim_sample surfels.pcd g.ply -number 500
piped pcl_slim_render scan.slim h.ppm -size 80x60
piped pcl_slim_render surfels.pcd h.ppm -size 80x60
piped pcl_slim_render mesh.off.ply h.ppm -size 80x60
for of in 'mesh -color 0' 'sample -number 500' 'render -size 80x60'; do  # .slim, with and without its name
  out=k.$([ "${of%% *}" = render ] && echo ppm || echo ply)
  # shellcheck disable=SC2086
  piped pcl_slim_${of%% *} scan.slim $out ${of#* }
done
piped pcl_color_splat_sampling scan.slim k.ply
expect 2 'is a surface, not points' pcl_slim_smooth /dev/stdin k.ply < <(cat scan.slim)

# What is read several times cannot be a pipe.
expect 2 'read once only' pcl_slim_fit <(cat scan.pcd) a.slim -tile_points 20000
expect 2 'is empty' pcl_slim_fit /dev/stdin a.slim < <(true)
expect 2 'is a device' pcl_slim_fit /dev/stdin a.slim < /dev/null

# Names with escape codes do not reach the terminal as such.
cp scan.pcd $'red\e[31m.pcd'
expect 0 '' pcl_slim_fit $'red\e[31m.pcd' a.slim
! grep -q $'\e' out.txt || complain 'an escape code on stdout'
expect 2 'red?\[31m' pcl_slim_fit $'no_red\e[31m.pcd' a.slim
! grep -q $'\e' err.txt || complain 'an escape code on stderr'

finish
