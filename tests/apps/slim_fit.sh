#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_fit as a user meets it: exit status, messages, files. Arguments: programs' folder, an
# empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_fit
mkdir -p -- "with space"

# cloud FILE TYPE SIZE COUNT OFFSET: a wavy sheet, ascii.
cloud() {
  awk -v type="$2" -v size="$3" -v n="$4" -v offset="$5" 'BEGIN {
    printf "VERSION 0.7\nFIELDS x y z\nSIZE %d %d %d\nTYPE F F F\nCOUNT 1 1 1\nWIDTH %d\nHEIGHT 1\n", size, size, size, n
    printf "POINTS %d\nDATA ascii\n", n
    srand(7)
    for (i = 0; i < n; ++i) {
      if (type == "nan") { print "nan nan nan"; continue }
      x = rand(); y = rand()
      printf "%.9f %.9f %.9f\n", offset + x, offset + y, 0.1 * sin(6 * x) * cos(5 * y)
    }
  }' > "$1"
}

cloud scan.pcd sheet 4 4000 0
cloud far.pcd sheet 8 4000 4918360.25
cloud near.pcd sheet 8 4000 0.25
cloud "with space/scan.pcd" sheet 4 500 0
badScans scan.pcd

# Good runs, every format, and the report.
for extension in pcd ply vtp slim; do
  expect 0 '' scan.pcd "a.$extension" -json "$extension.json"
  [ -s "a.$extension" ] || complain "no a.$extension"
  for key in program version input points threads seconds total load peak_rss_mb surfels leaves \
    levels degree t_mdl lambda diagonal rms_error_over_diagonal uncovered unsupported skipped; do
    grep -q "\"$key\"" "$extension.json" || complain "no $key in $extension.json"
  done
done
surfels=$(grep '"surfels"' slim.json)
for extension in pcd ply vtp; do
  [ "$(grep '"surfels"' $extension.json)" = "$surfels" ] || complain "$extension differs"
done
grep -q '^> Loading scan.pcd \[done, .* ms : 4000 points\]' out.txt || complain "no Loading line"
grep -q '^> Fitting \[done, ' out.txt || complain "no Fitting line"
# A switch alone is 1, wherever it stands; the surface does not depend on it.
for quiet in 'scan.pcd quiet.slim -quiet 1' 'scan.pcd quiet.slim -quiet' '-quiet scan.pcd quiet.slim' \
  'scan.pcd -quiet quiet.slim' 'scan.pcd quiet.slim -quiet -threads 1'; do
  # shellcheck disable=SC2086
  expect 0 '' $quiet
  [ ! -s out.txt ] || complain "$quiet is not quiet"
  same a.slim quiet.slim
done
expect 0 '' scan.pcd quiet.slim -quiet 0 -threads 1
[ -s out.txt ] || complain "-quiet 0 is quiet"
# Rounded .slim files are far smaller, are read again, and come out the same every time.
expect 0 '' scan.pcd rounded.slim -quantize .1
expect 0 '' scan.pcd again.slim -quantize .1 -threads 1
same rounded.slim again.slim
[ "$(stat -c %s rounded.slim)" -lt $(($(stat -c %s a.slim) / 2)) ] || complain "rounded.slim is large"
"$bin/pcl_slim_render" rounded.slim rounded.ppm -size 80x60 -quiet || complain "rounded.slim is not read"
expect 2 'rounds .slim files alone' scan.pcd a.ply -quantize .1
expect 2 'from 0.001 to 1' scan.pcd a.slim -quantize 2
expect 0 '' "with space/scan.pcd" "with space/a.PLY"
expect 0 '' scan.pcd b.slim -threads 1
cmp -s a.slim b.slim || complain "threads change the surface"
for option in '-degree 2' '-t_mdl 0.02' '-compact 1' '-robust 1' '-paper 1' '-lambda 1e-6' \
  '-viewpoint -1,2.5,9' '-estimate_normals 12' '-target_error 0.001' '-max_surfels 400' '-least_radius 0.1' '-seed 5'; do
  # shellcheck disable=SC2086
  expect 0 '' scan.pcd c.slim $option
done

# Coordinates of type double: a far scan gives the surface of the near one, place apart.
expect 0 '' far.pcd far.slim -json far.json
expect 0 '' near.pcd near.slim -json near.json
for key in leaves lambda; do
  f=$(sed -n "s/.*\"$key\": \([^,]*\).*/\1/p" far.json)
  n=$(sed -n "s/.*\"$key\": \([^,]*\).*/\1/p" near.json)
  awk -v f="$f" -v n="$n" 'BEGIN { exit !(f > 0.9 * n && f < 1.1 * n) }' || complain "far $key $f, near $n"
done

# Normals as data: the sheet's own with errors of .05 rad are used, estimated ones are found out.
awk 'BEGIN {
  n = 6000
  print "VERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F"
  print "COUNT 1 1 1 1 1 1\nWIDTH " n "\nHEIGHT 1\nPOINTS " n "\nDATA ascii"
  srand(7)
  for (i = 0; i < n; ++i) {
    x = rand(); y = rand(); for (k = 0; k < 3; ++k) g[k] = rand() + rand() + rand() + rand() - 2
    a = -0.6 * cos(6 * x) * cos(5 * y) + 0.087 * g[0]; b = 0.5 * sin(6 * x) * sin(5 * y) + 0.087 * g[1]
    l = sqrt(a * a + b * b + 1)
    printf "%.7f %.7f %.7f %.7f %.7f %.7f\n", x, y, 0.1 * sin(6 * x) * cos(5 * y) + 0.01 * g[2], a / l, b / l, 1 / l
  }
}' > measured.pcd
expect 0 '' measured.pcd data.slim -normals_as_data 1 -json data.json
awk '/"normal_error"/ { gsub(/[^0-9.]/, ""); found = $0 > 0.05 && $0 < 0.1 } END { exit !found }' data.json ||
  complain "normal_error: $(grep normal_error data.json)"
expect 0 '' measured.pcd again.slim -normals_as_data 1 -normal_error 0.07
expect 0 '' measured.pcd found.slim -estimate_normals 20 -use_normals 0 -normals_as_data 1 -json found.json
grep -q 'follow the points' out.txt || complain "estimated normals pass for data"
grep -q '"normal_error": 0' found.json || complain "estimated normals used: $(grep normal_error found.json)"
expect 1 'no normals' scan.pcd d.pcd -normals_as_data 1
expect 2 'exclude each other' measured.pcd d.pcd -normals_as_data 1 -t_mdl 0.01
expect 2 'ask for that too' measured.pcd d.pcd -normal_error 0.1
absent d.pcd

# Trim maps: a sheet ends, so some of its leaves are open; without maps the file is an older version's.
expect 0 '' measured.pcd open.slim -json open.json
expect 0 '' measured.pcd whole.slim -trim 0 -json whole.json
expect 0 '' measured.pcd wide.slim -hole 20
awk '/"open_leaves"/ { gsub(/[^0-9]/, ""); found = $0 > 0 } END { exit !found }' open.json ||
  complain "no leaf of a sheet is open: $(grep open_leaves open.json)"
# Programs that draw nothing and save no surface make no maps.
for program in pcl_slim_smooth pcl_slim_curvature pcl_slim_lines; do
  expect 0 '' measured.pcd out.ply -json none.json
  grep -q '"open_leaves": 0' none.json || complain "$program makes trim maps"
done
program=pcl_slim_fit
grep -q '"open_leaves": 0' whole.json || complain "open without maps: $(grep open_leaves whole.json)"
[ "$(od -An -tu1 -j8 -N1 open.slim)" -eq 2 ] || complain "maps in a file of version 1"
[ "$(od -An -tu1 -j8 -N1 whole.slim)" -eq 1 ] || complain "a file without maps is not of version 1"
expect 2 'from 2 to 50' measured.pcd d.pcd -hole 1

# Help, version, documentation.
expect 0 '' -h
grep -q '^Syntax is: pcl_slim_fit ' out.txt || complain "no syntax line"
expect 0 '' --help
expect 0 '' -version
documented "$program" slim_fit

awk 'length > 79 && !/^Syntax|^Fits/ { bad = 1 } END { exit bad }' < <("$bin/$program" -h) ||
  complain "the help is wider than 79 columns"

# Two dashes, -name=value and words for 0 and 1 mean the same.
expect 0 '' scan.pcd plain.slim -degree 2 -robust 1 -quiet 1
expect 0 '' scan.pcd dashes.slim --degree 2 --robust=true -quiet on
same plain.slim dashes.slim
expect 0 '' scan.pcd plain.slim -degree 3 -trim 0
expect 0 '' scan.pcd dashes.slim -degree=3 --trim off
same plain.slim dashes.slim
expect 2 'from 1 to 4' scan.pcd d.pcd --degree=7
expect 2 'needs a value\|a whole number' scan.pcd d.pcd -degree=
expect 2 'unknown option' scan.pcd d.pcd --
expect 2 'did you mean -degree' scan.pcd d.pcd --degre=2

# Usage errors: status 2, nothing written.
expect 2 'did you mean -degree' scan.pcd d.pcd -degre 2
expect 2 'from 1 to 4' scan.pcd d.pcd -degree 7
expect 2 'from 1 to 4' scan.pcd d.pcd -degree two
expect 2 'needs a value' scan.pcd d.pcd -degree
expect 2 'given twice' scan.pcd d.pcd -degree 2 -degree 3
expect 2 '0 or 1' scan.pcd d.pcd -sharp yes
expect 2 '0 or 1' scan.pcd d.pcd -sharp 2
expect 2 'given twice' scan.pcd d.pcd -sharp -sharp
expect 2 'no OUT' scan.pcd -sharp 1
expect 2 'X,Y,Z' scan.pcd d.pcd -viewpoint 1,2
expect 2 'exclude each other' scan.pcd d.pcd -penalty 2 -t_mdl 0.01
for pair in '-paper -penalty 2' '-paper -trim 1' '-paper -hole 9'; do
  # shellcheck disable=SC2086
  expect 2 'exclude each other' scan.pcd d.pcd $pair
done
expect 2 'a number from 1e-12 to 1' scan.pcd d.pcd -target_error 1.5
expect 2 'a number' scan.pcd d.pcd -penalty nan
expect 2 'options -noise and -lambda exclude each other; give one' scan.pcd d.pcd -lambda 1e-6 -noise 0.01
expect 2 'exclude each other' scan.pcd d.pcd -noise 0.01 -noise_model .01,0,0
expect 2 'exclude each other' scan.pcd d.pcd -target_error 0.01 -target_distance 0.1
expect 1 'wider than the cloud' scan.pcd d.pcd -noise 1e6
# Noise in the scan's unit is its lambda.
expect 0 '' scan.pcd unit.slim -noise 0.02 -json unit.json
grep -q '  noise 0.02 RMS' out.txt || complain "the noise given is not used: $(cat out.txt)"
expect 0 '' scan.pcd share.slim -lambda "$(value unit.json lambda)" -json share.json
awk -v l="$(value unit.json lambda)" -v d="$(value unit.json diagonal)" \
  'BEGIN { r = l / (0.02 / d) ^ 2; exit !(r > 0.999999 && r < 1.000001) }' || complain "lambda $(value unit.json lambda)"
[ "$(value unit.json leaves)" = "$(value share.json leaves)" ] || complain "-noise is not its lambda"
expect 0 '' scan.pcd most.slim -max_surfels 100000
grep -q -- '-max_surfels 100000 has no effect' out.txt || complain "an idle bound is not told"
expect 0 '' scan.pcd most.slim -max_surfels 300
! grep -q 'has no effect' out.txt || complain "a bound that binds is said to have no effect"
grep -q '  solved: penalty [0-9.e+]*, residual ' out.txt || complain "no penalty: $(cat out.txt)"
for goal in '-max_surfels 100' '-target_error 0.01' '-target_distance 0.01' '-sharp -max_surfels 300'; do
  # The option that the line names, in place of the goal, gives the same bytes.
  # shellcheck disable=SC2086
  expect 0 '' measured.pcd solved.slim $goal
  found=$(sed -n 's/.*; \(-noise_factor [0-9.e+]*\) repeats it$/\1/p' out.txt)
  # shellcheck disable=SC2086
  expect 0 '' measured.pcd repeated.slim ${goal%-[mt]*} $found
  same solved.slim repeated.slim
done
expect 2 'exclude each other' scan.pcd d.pcd -noise_factor 9 -max_surfels 100
expect 0 '' scan.pcd most.slim -max_surfels 100 -json most.json
expect 0 '' scan.pcd least.slim -json least.json
awk -v m="$(value most.json lambda)" -v l="$(value least.json lambda)" 'BEGIN { exit !(m / l > 0.999 && m / l < 1.001) }' ||
  complain "a target changes the noise: $(value most.json lambda), $(value least.json lambda)"
expect 0 '' measured.pcd idle.slim -estimate_normals 12 -use_normals 0
grep -q -- '-use_normals 0 has no effect' out.txt || complain "no note on an idle -use_normals"
# idle OPTIONS: an option that has no effect is named in one line, and only then.
idle() {
  expect 0 '' "${@:2}"
  [ "$(grep -c -- "^  $1 has no effect: " out.txt)" = 1 ] || complain "no note on an idle $1: ${*:2}"
}
idle -local_noise scan.pcd idle.slim -local_noise 1 -correlation 20
for given in '-lambda 1e-6' '-t_mdl 0.002' -paper; do
  # shellcheck disable=SC2086
  idle -local_noise scan.pcd idle.slim -local_noise 0 $given
  # shellcheck disable=SC2086
  idle -correlation scan.pcd idle.slim -correlation off $given
done
idle -sides measured.pcd idle.slim -sides 0
idle -sides scan.pcd idle.slim -sides 0 -viewpoint 1,2,30
idle -use_normals scan.pcd idle.slim -use_normals 0
expect 0 '' scan.pcd idle.slim -local_noise 1 -lambda 1e-6
! grep -q 'has no effect' out.txt || complain "$(cat out.txt)"
expect 0 '' scan.pcd idle.slim -trim 0 -hole 9
grep -q -- '-hole has no effect' out.txt || complain "no note on an idle -hole"
expect 0 '' scan.pcd most.slim -target_error 1 -quiet
expect 2 '.slim' scan.pcd d.obj
expect 2 'share a file' scan.pcd ./scan.pcd
expect 2 'format' scan.abc d.pcd

# Scans of no use and places that cannot be written: status 2 or 1, nothing left.
refuses scan.pcd
keepsOld kept.slim scan.pcd

# A stray among thousands of points at one place, as cameras write them, is a stray all the same.
awk '/^WIDTH/ { print "WIDTH 16001"; next } /^POINTS/ { print "POINTS 16001"; next } { print }
  END { for (i = 0; i < 12000; ++i) print 0, 0, 0; print 1e9, 0, 0 }' scan.pcd > zeros.pcd
expect 0 '' zeros.pcd zeros.slim -json zeros.json
grep -q '"far_away": 1' zeros.json || complain "strays beside zeros: $(grep far_away zeros.json)"
# Two scans a billion times as far apart as they are wide cannot be one surface.
awk '/^WIDTH/ { print "WIDTH 8000"; next } /^POINTS/ { print "POINTS 8000"; next } /^SIZE/ { print "SIZE 8 8 8"; next }
  /^DATA/ { data = 1; print; next } !data { print; next } { print; printf "%.9f %s %s\n", $1 + 1e9, $2, $3 }' scan.pcd > apart.pcd
expect 1 'fit each group by itself' apart.pcd apart.slim
absent apart.slim
expect 1 'too few' one.pcd one.slim -json one.json
noSurfaces
expect 1 'along lines' line.pcd one.slim
expect 1 '1 distinct point ' same.pcd one.slim -quiet
expect 2 'neighbours of 4000 points' scan.pcd one.slim -estimate_normals 4001
absent one.slim one.json

# Coordinates near the largest float, and the smallest: normals are PCL's all the same.
for factor in 2.5e38 1e-33; do
  awk -v f=$factor '/^DATA/ { data = 1; print; next } !data { print; next } { print $1 * f, $2 * f, $3 * f }' \
    scan.pcd > scaled.pcd
  expect 0 '' scaled.pcd scaled.slim -estimate_normals 10
done

# Memory: refused before the work, or obeyed by it; the message names what to raise.
cloud many.pcd sheet 4 300000 0
expect 2 'less than the program itself' scan.pcd d.slim -max_memory 1
sanitized=${PCL_SLIM_SANITIZE:-} # sanitizers take memory of their own and do not bear being short of it
[ -n "$sanitized" ] || expect 1 'above -max_memory' many.pcd d.slim -max_memory "$(peak scan.pcd)"
expect 0 '' scan.pcd d.slim -max_memory 4000 -json d.json
rm -f d.slim
[ -n "$sanitized" ] || shortOfMemory many.pcd d.slim

# Ctrl-C: status 130, nothing left.
cloud big.pcd sheet 4 200000 0
interrupted big.pcd stopped.slim

if [ -n "$data" ] && [ -f "$data/kinect_mosd_learn13.pcd" ]; then
  expect 0 '' "$data/kinect_mosd_learn13.pcd" kinect.slim -json kinect.json
  grep -q '"non_finite": 99749' kinect.json || complain "kinect's NaN are not counted"
  expect 0 '' "$data/stanford_bunny_zipper.ply" bunny.slim -json bunny.json
  grep -q '"without_normal": 1113' bunny.json || complain "vertices without faces are not dropped"
  grep -q '"normals": "mesh"' bunny.json || complain "no normals from the mesh"
fi

finish
