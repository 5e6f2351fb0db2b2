#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fits by tiles: the same bytes whatever the memory, the threads and the form of the file; what cannot be
# done is refused in one line, and nothing is left.
. "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_fit

"$bin/pcl_slim_demo_scan" scan.pcd -points 200000 -quiet 1 || complain 'no scan'
expect 0 '' scan.pcd tiles.slim -tile_points 20000 -threads 1 -json tiles.json
[ "$(value tiles.json count)" -ge 10 ] || complain "$(value tiles.json count) tiles"
[ "$(value tiles.json uncovered)" -le 20 ] || complain "$(value tiles.json uncovered) points are uncovered"

# The amphora's ornament is of limited height: detail, which resembles noise that neighbours share.
[ "$(value tiles.json noise_correlation)" = 1.0 ] || complain "$(value tiles.json noise_correlation) points share noise"

expect 0 '' scan.pcd two.slim -tile_points 20000 -threads 2 -json two.json
same tiles.slim two.slim
[ "$(value two.json at_once)" -eq 2 ] || complain "$(value two.json at_once) tiles at once by two threads"
expect 0 '' scan.pcd few.slim -tile_points 150000 -threads 2 -json two.json
[ "$(value two.json at_once)" -eq 1 ] || complain "$(value two.json at_once) of few tiles at once"
for limit in 300 200; do
  expect 0 '' scan.pcd limited.slim -tile_points 20000 -threads 1 -max_memory $limit
  same tiles.slim limited.slim
done
mkdir scratch
expect 0 '' scan.pcd scratch.slim -tile_points 20000 -scratch scratch
same tiles.slim scratch.slim
[ -z "$(ls -A scratch)" ] || complain "scratch folder has $(ls -A scratch)"

# In pieces for ParaView, whose place nothing is in before they are all there.
expect 0 '' scan.pcd pieces.pvtp -tile_points 20000 -scratch scratch
[ "$(ls pieces | wc -l)" -eq $(($(value tiles.json count) + 1)) ] || complain "pieces: $(ls pieces)"
[ -z "$(ls -A scratch)" ] || complain "pieces: scratch folder has $(ls -A scratch)"
expect 1 'in the place of the folder' scan.pcd scan.pcd.pvtp -tile_points 20000
absent scan.pcd.pvtp

head -c 900000 scan.pcd > cut.pcd

# The surface in other forms.
for form in pcd ply vtp; do
  expect 0 '' scan.pcd tiles.$form -tile_points 20000
done

# What tiles cannot do.
for option in '-paper 1' '-target_error 0.01' '-target_distance 0.1' '-max_surfels 50' '-estimate_normals 10'; do
  # shellcheck disable=SC2086
  expect 2 'by tiles' scan.pcd refused.slim -tile_points 20000 $option
done
expect 2 '10000 or more' scan.pcd refused.slim -tile_points 20
expect 2 'create it first' scan.pcd refused.slim -tile_points 20000 -scratch nowhere
expect 2 'max_memory' scan.pcd refused.slim -tile_points 200000 -max_memory 5
expect 2 'truncated' cut.pcd refused.slim -tile_points 20000
expect 2 'No such file\|check the name' missing.pcd refused.slim -tile_points 20000
head -c 30 /dev/zero > odd.f32
expect 2 'multiple' odd.f32 refused.slim
absent refused.slim

# A fit that is divided, and one that is killed: the same bytes.
mkdir job
expect 0 '' scan.pcd parts.slim -tile_points 20000 -plan job -tiles 0:0
absent parts.slim
expect 0 '' scan.pcd parts.slim -tile_points 20000 -plan job -tiles 5:8 -threads 1
expect 0 '' scan.pcd parts.slim -tile_points 20000 -plan job -tiles 2:5 -threads 2
expect 2 'no range' scan.pcd parts.slim -tile_points 20000 -plan job -tiles 5:999
expect 2 'needs -plan' scan.pcd parts.slim -tile_points 20000 -tiles 0:1
absent parts.slim
expect 0 '' scan.pcd parts.slim -tile_points 20000 -plan job -json parts.json
[ "$(value parts.json kept)" -eq 6 ] || complain "$(value parts.json kept) tiles were kept"
same tiles.slim parts.slim
[ -z "$(ls -A job)" ] || complain "the plan's folder has $(ls -A job)"
"$bin/$program" scan.pcd killed.slim -tile_points 20000 -plan job -threads 1 -quiet &
pid=$!
for ((i = 0; i < 500; ++i)); do
  [ ! -e job/tile-1 ] || break
  sleep 0.01
done
kill -KILL $pid
wait $pid 2> /dev/null
absent killed.slim
expect 0 '' scan.pcd killed.slim -tile_points 20000 -plan job
same tiles.slim killed.slim

# What a folder keeps has checksums: what is damaged or cut off is made again.
expect 0 '' scan.pcd damaged.slim -tile_points 20000 -plan job -tiles 0:2
cp -r job whole
for kind in value nan cut tile plan; do
  rm -rf job damaged.slim
  cp -r whole job
  case $kind in
    value) printf '\0\0\200\77' | dd of=job/points bs=1 seek=240000 conv=notrunc status=none ;;
    nan) printf '\0\0\300\177' | dd of=job/points bs=1 seek=240000 conv=notrunc status=none ;;
    cut) truncate -s -1000 job/points ;;
    tile) printf 'x' | dd of=job/tile-0 bs=1 seek=3000 conv=notrunc status=none ;;
    plan) truncate -s -100 job/plan ;;
  esac
  "$bin/$program" scan.pcd damaged.slim -tile_points 20000 -plan job -quiet 2> err.txt ||
    complain "$kind damaged: $(head -c 300 err.txt)"
  same tiles.slim damaged.slim
  [ $kind = tile ] || [ $kind = plan ] || grep -q 'made again' err.txt || complain "$kind damaged: no warning"
done
expect 2 "-plan: the folder 'nowhere' does not exist" scan.pcd damaged.slim -tile_points 20000 -plan nowhere

for share in 0/3 2/3 1/3; do
  expect 0 '' scan.pcd shared.slim -tile_points 20000 -plan job -tiles $share -threads 1
done
absent shared.slim
expect 0 '' scan.pcd shared.slim -tile_points 20000 -plan job -json parts.json
[ "$(value parts.json kept)" -eq "$(value tiles.json count)" ] || complain 'shares left tiles out'
same tiles.slim shared.slim
expect 2 'no range' scan.pcd parts.slim -tile_points 20000 -plan job -tiles 3/3

# Ranks of an MPI job, where there is one: the same bytes, no folder shared, and a rank that fails ends the job.
# ranks N ARGUMENT...: runs the program on N ranks; the status is in got.
ranks() {
  local n=$1
  shift
  got=0
  mpirun --oversubscribe -n "$n" "$@" > out.txt 2> err.txt || got=$?
}
# ends PATTERN STATUS...: the job said PATTERN once, ended with one of the statuses, and left no ranks.slim.
ends() {
  local pattern=$1
  shift
  [[ " $* " == *" $got "* ]] && [ "$(grep -c "$pattern" err.txt)" -eq 1 ] ||
    complain "'$pattern': exit $got: $(head -c 400 err.txt)"
  absent ranks.slim
}
if [ -x "$bin/pcl_slim_fit_mpi" ] && command -v mpirun > /dev/null; then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
  mpi=$bin/pcl_slim_fit_mpi
  for n in 1 2 3 4; do
    ranks $n "$mpi" scan.pcd ranks.slim -tile_points 20000 --scratch=scratch -quiet -json ranks.json
    [ $got -eq 0 ] || complain "$n ranks: $(head -c 300 err.txt)"
    same tiles.slim ranks.slim
    rm -f ranks.slim
    [ -z "$(ls -A scratch)" ] || complain "ranks left $(ls -A scratch)"
    for key in uncovered leaves halo_points passes; do
      [ "$(value ranks.json $key)" = "$(value tiles.json $key)" ] || complain "$n ranks: $key $(value ranks.json $key)"
    done
  done
  python3 -c 'import json; ranks = json.load(open("ranks.json"))["ranks"]
assert len(ranks) == 4 and sum(r["points"] for r in ranks) == 200000, ranks
assert all(0 < r["halo_bytes_sent"] < r["bytes_sent"] for r in ranks), ranks' || complain 'figures of the ranks'
  mkdir of_ranks
  ranks 3 "$mpi" scan.pcd of_ranks/pieces.pvtp -tile_points 20000 -quiet
  diff -r pieces of_ranks/pieces > out.txt || complain "pieces of ranks: $(head -c 300 out.txt)"
  ranks 3 "$mpi" cut.pcd ranks.slim -tile_points 20000
  ends 'truncated' 2
  ranks 3 "$mpi" scan.pcd ranks.slim -tile_points 20000 -plan job
  ends "unknown option '-plan'" 2
  ranks 3 "$mpi" scan.pcd ranks.slim -tile_points 0
  ends '10000 or more' 2
  ranks 3 "$mpi" scan.pcd ranks.slim -tile_points 200000 -max_memory 30
  ends 'max_memory' 2
  # One rank's disk is full: not that of the others. Files of OpenMPI's shared memory are none of the test.
  printf '#!/bin/bash\n[ "$OMPI_COMM_WORLD_RANK" != 1 ] || ulimit -f 400\nexec "$@"\n' > full.sh
  chmod +x full.sh
  OMPI_MCA_btl=tcp,self OMPI_MCA_btl_tcp_if_include=lo ranks 3 ./full.sh "$mpi" scan.pcd ranks.slim -tile_points 20000 -quiet
  ends 'scratch file' 1
  # A rank is killed, the first and another, while tiles are fitted; then the job is interrupted.
  "$bin/pcl_slim_demo_scan" many.pcd -points 1500000 -quiet 1
  for victim in 0 2 INT; do
    rm -f rank.pid
    mpirun --oversubscribe -n 3 bash -c "[ \$OMPI_COMM_WORLD_RANK != ${victim/INT/0} ] || echo \$\$ > rank.pid
      exec '$mpi' many.pcd ranks.slim -tile_points 100000 -quiet" > out.txt 2> err.txt &
    pid=$!
    for ((i = 0; i < 500; ++i)); do
      [ ! -s rank.pid ] || break
      sleep 0.01
    done
    sleep 0.7
    start=$SECONDS
    if [ $victim = INT ]; then kill -INT $pid; else kill -KILL "$(cat rank.pid)"; fi
    got=0
    wait $pid || got=$?
    [ $got -ne 0 ] || complain "a job whose rank was ended ($victim) says it is done"
    [ $((SECONDS - start)) -le 10 ] || complain "$((SECONDS - start)) s after $victim was ended"
    absent ranks.slim
  done
fi

# Points brought onto a surface in pieces: the same points, order and fields within rounding.
# nearly A B: the same header, and floats that differ by rounding.
nearly() {
  python3 - "$1" "$2" <<'END' || complain "$1 and $2 differ"
import array, sys

def load(path):
    data = open(path, "rb").read()
    mark = b"DATA binary\n" if path.endswith("pcd") else b"end_header\n"
    at = data.index(mark) + len(mark)
    # A .ply has bytes among its floats: the length counts there.
    return data[:at], array.array("f", data[at:]) if path.endswith("pcd") else data[at:]

(head, a), (other, b) = load(sys.argv[1]), load(sys.argv[2])
path = sys.argv[1]
far = sum(not (x == y or path.endswith("ply") or abs(x - y) <= 1e-4 * max(1, abs(x)) or (x != x and y != y)) for x, y in zip(a, b))
sys.exit(head != other or len(a) != len(b) or far > 1e-4 * len(a))
END
}
# Of a surface in blocks only those near the points are read: the same bytes as with all of it, which the
# .pcd has. A -max_memory little above what the points take divides the work: the same but for rounding.
python3 - scan.pcd part.pcd <<'END'
import struct, sys
data = open(sys.argv[1], "rb").read()
at = data.index(b"DATA binary\n") + 12
rows = [data[k:k + 16] for k in range(at, len(data), 16)]
rows = [row for row in rows if struct.unpack("<f", row[8:12])[0] > 0.45]
head = data[:at].replace(b" 200000", b" %d" % len(rows))
open(sys.argv[2], "wb").write(head + b"".join(rows))
END
count=$(value tiles.json count)
for program in pcl_slim_smooth pcl_slim_curvature; do
  expect 0 '' part.pcd near.pcd -surface tiles.slim -json near.json
  expect 0 '' part.pcd whole.pcd -surface tiles.pcd
  same near.pcd whole.pcd
  expect 0 '' part.pcd whole.pcd -surface pieces.pvtp
  same near.pcd whole.pcd
  [ "$(value near.json read)" -le $((count / 2)) ] || complain "$(value near.json read) of $count blocks for a part"
  expect 0 '' scan.pcd near.pcd -surface tiles.slim -tile_points 30000 -threads 1
  expect 0 '' scan.pcd whole.pcd -surface tiles.pcd -tile_points 30000 -threads 2
  same near.pcd whole.pcd
  expect 2 'MB or more' scan.pcd refused.pcd -surface tiles.slim -tile_points 30000 -max_memory 20
  # Where the program's libraries take more than the points, as on Debian 14, any limit that it starts with is enough.
  grep -q 'the program itself takes' err.txt && continue
  least=$(grep -o 'takes [0-9]* MB' err.txt | tr -dc 0-9)
  # What a process takes varies by a megabyte with the pages of its libraries that are in memory.
  rm -f divided.pcd
  for ((limit = least + 1; limit < least + 8; ++limit)); do
    "$bin/$program" scan.pcd divided.pcd -surface tiles.slim -tile_points 30000 -threads 1 \
      -max_memory $limit -quiet > out.txt 2> err.txt && break
    grep -q 'MB or more' err.txt || complain "$(cat err.txt)"
  done
  nearly near.pcd divided.pcd
  differ near.pcd divided.pcd
done
program=pcl_slim_render
box='-region -1,-1,0.3,1,1,0.38'
near='-camera 0.45,-0.4,0.7,0,0,0.45,0,0,1,6'
for view in "$box" "$near" "$box -mode raytraced" "$box $near"; do
  # shellcheck disable=SC2086
  expect 0 '' tiles.slim near.png -size 160x120 $view -json near.json
  # shellcheck disable=SC2086
  expect 0 '' tiles.pcd whole.png -size 160x120 $view
  same near.png whole.png
  [ "$(value near.json read)" -lt "$count" ] || complain "$(value near.json read) blocks for $view"
done
# Far away the levels above the tiles stand for all of them.
far='-camera 30,-52,32,0,0,0.3,0,0,1,5 -size 320x240 -lod 4'
# shellcheck disable=SC2086
expect 0 '' tiles.slim far.png $far -json near.json
# shellcheck disable=SC2086
expect 0 '' tiles.pcd whole.png $far -json whole.json
[ "$(value near.json read)" -le $((count / 4)) ] || complain "$(value near.json read) blocks for a view from afar"
seen=$(value near.json covered_pixels) all=$(value whole.json covered_pixels)
[ $((100 * seen)) -gt $((95 * all)) ] && [ $((100 * seen)) -lt $((105 * all)) ] || complain "$seen pixels of $all from afar"
# A view of the program's own choice is taken from those levels: they are read first, and few blocks besides.
expect 0 '' tiles.slim far.png -size 160x120 -lod 24 -json near.json
expect 0 '' tiles.pcd whole.png -size 160x120 -lod 24 -json whole.json
[ "$(value near.json read)" -le $((count / 2)) ] || complain "$(value near.json read) blocks for a view of all"
seen=$(value near.json covered_pixels) all=$(value whole.json covered_pixels)
[ $((100 * seen)) -gt $((90 * all)) ] && [ $((100 * seen)) -lt $((110 * all)) ] || complain "$seen pixels of $all of all"
expect 2 'nothing lies in' tiles.slim refused.png -region 5,5,5,6,6,6
absent refused.png
printf 'VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 1\nHEIGHT 30000\nDATA binary\n' > nans.pcd
head -c 480000 /dev/zero | tr '\0' '\377' >> nans.pcd
for program in pcl_slim_smooth pcl_slim_curvature; do
  for form in pcd ply; do
    switch=-curvatures
    [ $program = pcl_slim_smooth ] || switch=-directions
    expect 0 '' scan.pcd whole.$form -surface tiles.slim $switch
    expect 0 '' scan.pcd pieces.$form -surface tiles.slim -tile_points 30000 $switch
    nearly whole.$form pieces.$form
  done
  expect 0 '' scan.pcd fitted.pcd -tile_points 30000 -threads 1
  expect 0 '' scan.pcd again.pcd -tile_points 30000 -threads 2 -max_memory 300
  same fitted.pcd again.pcd
  expect 2 'NaN' nans.pcd refused.pcd -surface tiles.slim -tile_points 20000
  expect 2 'cannot be written in pieces' scan.pcd refused.las -surface tiles.slim -tile_points 30000
  expect 2 'cannot be written in pieces' scan.pcd refused.vtp -surface tiles.slim -tile_points 30000
  absent refused.pcd refused.las refused.vtp
done
program=pcl_slim_smooth
expect 2 'not possible by tiles' scan.pcd refused.pcd -mesh 1 -tile_points 30000
# In pieces a point's neighbours are not at hand, and so no curvature as PCL's classes read it.
expect 0 '' scan.pcd pieces.pcd -surface tiles.slim -tile_points 30000 -normals 1
header pieces.pcd 'FIELDS x y z rgb normal_x normal_y normal_z'
program=pcl_slim_fit

# A disk that is full, or as much as ulimit grants.
got=0
(ulimit -f 500 && exec "$bin/$program" scan.pcd full.slim -tile_points 20000 -quiet) 2> err.txt || got=$?
[ $got -eq 1 ] || complain "a full disk: exit $got"
grep -q 'scratch file' err.txt || complain "a full disk: $(cat err.txt)"
absent full.slim

# Ctrl-C.
"$bin/$program" scan.pcd stopped.slim -tile_points 20000 -scratch scratch -quiet 2> err.txt &
pid=$!
sleep 0.3
kill -INT $pid
got=0
wait $pid || got=$?
[ $got -eq 130 ] || [ $got -eq 0 ] || complain "stopped: exit $got"
[ $got -eq 0 ] || absent stopped.slim
[ -z "$(ls -A scratch)" ] || complain "stopped: scratch folder has $(ls -A scratch)"
finish
