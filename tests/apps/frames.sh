#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Registered frames of one scene: -frames merges them, and each has its own noise. Arguments: programs'
# folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# frame SEED VIEWPOINT [FIELD VALUE]: 120 x 120 points of a wave, with errors shared by 5 x 5 of them; two sums of
# white noise along rows and columns. FIELD: a field more.
frame() {
  awk -v seed="$1" -v viewpoint="$2" -v field="${3-}" -v value="${4-}" 'BEGIN {
    srand(seed); n = 120; w = 5
    print "VERSION 0.7\nFIELDS x y z" (field ? " " field : "") "\nSIZE 4 4 4" (field ? " 4" : "")
    print "TYPE F F F" (field ? " F" : "") "\nCOUNT 1 1 1" (field ? " 1" : "")
    print "WIDTH " n "\nHEIGHT " n "\nVIEWPOINT " viewpoint " 1 0 0 0\nPOINTS " n * n "\nDATA ascii"
    for (y = 0; y < n + w; ++y) for (x = 0; x < n + w; ++x)
      e[y, x] = sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand())
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) {
      sum = 0
      for (k = 0; k < w * w; ++k) sum += e[y + int(k / w), x + k % w]
      h = 0.05 * sin(6 * 0.01 * x) * cos(5 * 0.01 * y) + 0.004 * sum / w
      printf "%.6f %.6f %.6f%s\n", 0.01 * x, 0.01 * y, h, field ? " " value : ""
    }
  }'
}

# rms FILE FLOATS: RMS height of a binary PCD's points over the wave, in millionths.
rms() {
  tail -c $((14400 * $3 * 4 * $2)) "$1" | od -An -v -tf4 -w$((4 * $2)) | awk '{
    d = $3 - 0.05 * sin(6 * $1) * cos(5 * $2); s += d * d } END { print int(1e6 * sqrt(s / NR)) }'
}

number() { grep -o "\"$2\": [-0-9.e+]*" "$1" | cut -d' ' -f2; }

frame 1 '0.5 0.5 2' > a.pcd
frame 2 '0.6 0.4 2' > b.pcd
frame 3 '0.4 0.4 2' > c.pcd

# Three frames: the noise of one, a third of its leftover error, all points in order, and a sensor for each.
expect 0 '' pcl_slim_smooth a.pcd one.pcd -json one.json
expect 0 '' pcl_slim_smooth a.pcd three.pcd -frames b.pcd,c.pcd -json three.json
grep -q '3 frames, each with its own sensor' out.txt || complain 'frames are not named'
grep -q 'points +- [0-9]* % in each frame' out.txt || complain "$(grep noise out.txt)"
header three.pcd 'FIELDS x y z vp_x vp_y vp_z frame'
header three.pcd 'POINTS 43200'
[ "$(number three.json noise_frames)" -eq 3 ] || complain "$(grep noise_frames three.json)"
[ "$(number three.json frames)" -eq 3 ] || complain "$(grep '"frames"' three.json)"
grep -q '"sensors": "frames"' three.json || complain "$(grep '"sensors"' three.json)"
awk -v a="$(number one.json noise_correlation)" -v b="$(number three.json noise_correlation)" \
  'BEGIN { exit !(b > 0.75 * a && b < 1.33 * a) }' || complain 'the frames do not have the noise of one'
[ "$(rms three.pcd 7 3)" -lt $((8 * $(rms one.pcd 3 1) / 10)) ] ||
  complain "merged: $(rms three.pcd 7 3), alone: $(rms one.pcd 3 1)"

# The merged file alone is the same scan, and threads change nothing.
expect 0 '' pcl_slim_fit a.pcd frames.slim -frames b.pcd,c.pcd -threads 1
expect 0 '' pcl_slim_fit a.pcd threads.slim -frames b.pcd,c.pcd -threads 3
same frames.slim threads.slim
for tool in pcl_slim_mesh pcl_slim_lines pcl_slim_curvature; do
  expect 0 "" $tool a.pcd out.ply -frames b.pcd
done
expect 0 '' pcl_color_splat_sampling a.pcd splats.ply -frames b.pcd
expect 0 '' pcl_slim_sample a.pcd samples.ply -frames b.pcd -spacing 0.05

# Fields of sensors that are all 0 are none: the VIEWPOINT is taken.
for name in a b; do
  sed -e 's/^FIELDS .*/& vp_x vp_y vp_z/; s/^SIZE .*/& 4 4 4/; s/^TYPE .*/& F F F/; s/^COUNT .*/& 1 1 1/' \
    -e '/^DATA/,$ { /^DATA/! s/$/ 0 0 0/ }' $name.pcd > zero_$name.pcd
done
expect 0 '' pcl_slim_fit a.pcd two.slim -frames b.pcd
expect 0 '' pcl_slim_fit zero_a.pcd zero.slim -frames zero_b.pcd
same two.slim zero.slim

# What cannot be merged.
frame 4 '0.5 0.5 2' intensity 7 > other.pcd
printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' > mesh.ply
expect 2 "'other.pcd' has other fields than 'a.pcd'" pcl_slim_fit a.pcd x.slim -frames b.pcd,other.pcd
expect 2 "'mesh.ply' has faces" pcl_slim_fit a.pcd x.slim -frames mesh.ply
expect 2 'nothere.pcd' pcl_slim_fit a.pcd x.slim -frames nothere.pcd
expect 2 'would be overwritten' pcl_slim_smooth a.pcd b.pcd -frames b.pcd
expect 2 'not possible by tiles' pcl_slim_fit a.pcd x.slim -frames b.pcd -tile_points 5000
expect 2 'not possible by tiles' pcl_slim_fit three.pcd x.slim -frame_field frame -tile_points 5000
expect 2 "no field 'sweep'" pcl_slim_fit a.pcd x.slim -frame_field sweep
expect 2 'exclude each other' pcl_slim_fit three.pcd x.slim -frames b.pcd -frame_field frame
expect 2 'exclude each other' pcl_slim_smooth a.pcd x.pcd -frames b.pcd -surface frames.slim
absent x.slim x.pcd

# Frames of one place, and those whose sensors nobody knows, have their own noise, too.
frame 5 '0.5 0.5 2' > again.pcd
frame 6 '0 0 0' > nowhere.pcd
frame 7 '0 0 0' > unknown.pcd
near() {
  [ "$(number "$1" noise_frames)" -eq 2 ] || complain "$(grep noise_frames "$1")"
  awk -v a="$(number one.json noise_correlation)" -v b="$(number "$1" noise_correlation)" \
    'BEGIN { exit !(b > 0.75 * a && b < 1.33 * a) }' || complain "$1: $(grep noise_correlation "$1")"
}
expect 0 '' pcl_slim_fit a.pcd x.slim -frames again.pcd -json again.json
grep -q '2 frames, seen from 1 place' out.txt || complain "$(grep frames out.txt)"
near again.json
expect 0 '' pcl_slim_smooth nowhere.pcd merged.pcd -frames unknown.pcd -json nowhere.json
grep -q '2 frames, whose VIEWPOINTs are 0: no sensor is known' out.txt || complain "$(grep frames out.txt)"
grep -q '"sensors": "none"' nowhere.json || complain "$(grep '"sensors"' nowhere.json)"
near nowhere.json
expect 0 '' pcl_slim_fit nowhere.pcd x.slim -frames unknown.pcd -viewpoint 0.5,0.5,2 -json viewpoint.json
grep -q '"sides_from": "viewpoint"' viewpoint.json || complain "$(grep sides_from viewpoint.json)"
near viewpoint.json

# A merged file has the frames' numbers in a field, which -frame_field reads; a field of that name stays as it is.
frame 6 '0 0 0' frame 1.5 > numbered.pcd
frame 7 '0 0 0' frame 0.5 > other.pcd
expect 0 '' pcl_slim_smooth numbered.pcd out.pcd -frames other.pcd -json numbered.json
near numbered.json
header out.pcd 'FIELDS x y z frame vp_x vp_y vp_z'
{
  sed 's/^WIDTH .*/WIDTH 28800/; s/^HEIGHT .*/HEIGHT 1/; s/^POINTS .*/POINTS 28800/' numbered.pcd
  sed '1,/^DATA/d' other.pcd
} > made.pcd
expect 0 '' pcl_slim_fit made.pcd x.slim -frame_field frame -json field.json
grep -q '2 frames, numbered by field frame' out.txt || complain "$(grep frames out.txt)"
near field.json
sed '$ s/0.5$/nan/' made.pcd > nan.pcd
expect 2 "field 'frame' of point 28799 is not finite" pcl_slim_fit nan.pcd y.slim -frame_field frame
absent y.slim

finish
