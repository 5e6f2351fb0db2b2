#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Scans whose points were seen from many places: fields vp_x vp_y vp_z, and a trajectory with the
# points' times. Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# drive KIND: a road and house walls on both sides of two streets at a right angle, scanned on a drive
# through both. Fields: KIND own: vp_x vp_y vp_z, else a time; and the side that was seen: 1 along y, 2
# along x, 3 up, negative against it.
drive() {
  awk -v own="$([ "$1" = own ] && echo 1)" -v n=24000 'BEGIN {
    srand(3)
    print "VERSION 0.7\nFIELDS x y z " (own ? "vp_x vp_y vp_z" : "gps_time") " side"
    print "SIZE 4 4 4 " (own ? "4 4 4" : "8") " 4\nTYPE F F F " (own ? "F F F" : "F") " F"
    print "COUNT 1 1 1 " (own ? "1 1 1" : "1") " 1\nWIDTH " n "\nHEIGHT 1\nPOINTS " n "\nDATA ascii"
    for (i = 0; i < n; ++i) {
      t = 80 * (i + 0.5) / n
      first = t < 40; px = first ? t : 40; py = first ? 0 : t - 40
      k = int(3 * rand()); noise = 0.02 * (rand() - 0.5)
      along = 8 * (rand() - 0.5)
      across = k == 0 ? 12 * (rand() - 0.5) : k == 1 ? 6 + noise : -6 + noise
      z = k == 0 ? noise : 6 * rand()
      side = k == 0 ? 3 : (k == 1 ? -1 : 1) * (first ? 1 : 2)
      x = first ? px + along : 40 + across
      y = first ? across : py + along
      # The crossing has no walls.
      if (k > 0 && (first ? x > 33 : y < 7)) { x = 33 * rand(); y = 5 * (rand() - 0.5); z = noise; side = 3; px = x; py = 0; t = x }
      if (own) printf "%.4f %.4f %.4f %.4f %.4f 2 %d\n", x, y, z, px, py, side
      else printf "%.4f %.4f %.4f %.6f %d\n", x, y, z, 1000000000 + t, side
    }
  }'
}

# right FILE STEP SIDE NORMAL: thousandths of the points of a binary PCD whose normal is on the side seen;
# floats a point, and the columns of the side and of normal_x.
right() {
  tail -c $((24000 * 4 * $2)) "$1" | od -An -v -tf4 -w$((4 * $2)) | awk -v side="$3" -v n="$4" '{
    s = $side; a = s < 0 ? -s : s
    v = a == 1 ? $(n + 1) : a == 2 ? $n : $(n + 2)
    good += (s < 0 ? -v : v) > 0 } END { print int(1000 * good / NR) }'
}

atLeast() { [ "$1" -ge "$2" ] || complain "$3: $1 of 1000 normals are right, not $2"; }

drive own > own.pcd
drive timed > timed.pcd
{
  echo '# timestamp tx ty tz qx qy qz qw'
  awk 'BEGIN { for (t = 0; t <= 80; t += 2)
    printf "%d %g %g 2 0 0 0 1\n", 1000000000 + t, t < 40 ? t : 40, t < 40 ? 0 : t - 40 }'
} > drive.txt
{
  echo 'time,x,y,z'
  awk 'BEGIN { print "80,40,40,2\n40,40,0,2\n0,0,0,2" }'
} > drive.csv

# Own places: fields, TUM, CSV with an offset; the same sides, by the votes of beams on the graph of leaves.
expect 0 '' pcl_slim_smooth own.pcd smooth_own.pcd -normals 1 -json own.json
header smooth_own.pcd 'FIELDS x y z vp_x vp_y vp_z side normal_x normal_y normal_z curvature'
atLeast "$(right smooth_own.pcd 11 7 8)" 999 fields
grep -q "each point's own sensor, from fields vp_x vp_y vp_z" out.txt || complain 'fields are not named'
expect 0 '' pcl_slim_smooth timed.pcd smooth_tum.pcd -normals 1 -trajectory drive.txt -json tum.json
atLeast "$(right smooth_tum.pcd 10 6 7)" 999 TUM
grep -q "each point's own sensor, from drive.txt" out.txt || complain 'the trajectory is not named'
expect 0 '' pcl_slim_smooth timed.pcd smooth_csv.pcd -normals 1 -trajectory drive.csv -time_field gps_time \
  -time_offset -1000000000
same smooth_tum.pcd smooth_csv.pcd
for report in own.json tum.json; do
  grep -q '"sides_from": "sensors"' $report || complain "$report: $(grep sides_from $report)"
  [ "$(value $report overlap_edges)" -gt 0 ] || complain "$report: $(grep overlap_edges $report)"
done
grep -q '"sensors": "fields"' own.json || complain "$(grep '"sensors"' own.json)"
grep -q '"sensors": "trajectory"' tum.json || complain "$(grep '"sensors"' tum.json)"

# The same through PLY and LAS, whose extra bytes store the places and whose own field the times.
for form in ply las; do
  expect 0 '' pcl_slim_smooth own.pcd own.$form
  expect 0 '' pcl_slim_smooth own.$form smooth.$form -normals 1 -json $form.json
  grep -q '"sensors": "fields"' $form.json || complain "$form: $(grep '"sensors"' $form.json)"
  grep -q '"sides_from": "sensors"' $form.json || complain "$form: $(grep sides_from $form.json)"
done
header smooth.ply 'property float vp_z'
grep -aq vp_z smooth.las || complain 'smooth.las has no vp_z'
expect 0 '' pcl_slim_smooth timed.pcd timed.las
expect 0 '' pcl_slim_smooth timed.las smooth.las -trajectory drive.txt -json las.json
grep -q '"sensors": "trajectory"' las.json || complain "$(grep '"sensors"' las.json)"

# One place does not do; it wins all the same where it is given.
expect 0 '' pcl_slim_smooth own.pcd one.pcd -normals 1 -viewpoint 0,0,2 -json one.json
[ "$(right one.pcd 11 7 8)" -lt 950 ] || complain 'a single place orients the streets'
grep -q '"sides_from": "viewpoint"' one.json || complain "$(grep sides_from one.json)"

# Surfaces, noise along the beam, estimated normals, splats.
expect 0 '' pcl_slim_fit own.pcd own.slim -noise_model 0.005,0,0 -threads 1
expect 0 '' pcl_slim_fit own.pcd two.slim -noise_model 0.005,0,0 -threads 2
same own.slim two.slim
expect 0 '' pcl_slim_fit timed.pcd timed.slim -estimate_normals 12 -trajectory drive.txt -json estimated.json
grep -q '"sides_from": "normals"' estimated.json || complain "$(grep sides_from estimated.json)"
expect 0 '' pcl_color_splat_sampling timed.pcd splats.pcd -trajectory drive.txt

# What cannot be done is said in one line; nothing is written.
printf '999999990 0 0 2\n1000000010 10 0 2\n' > short.txt
sed '/^DATA/q' timed.pcd | sed 's/gps_time/when/' > when.pcd
sed '1,/^DATA/d' timed.pcd >> when.pcd
printf '1 2 3\n' > odd.txt
expect 2 'give the whole trajectory' pcl_slim_fit timed.pcd no.slim -trajectory short.txt
expect 2 'time_field' pcl_slim_fit when.pcd no.slim -trajectory drive.txt
expect 0 '' pcl_slim_fit when.pcd when.slim -trajectory drive.txt -time_field when
expect 2 "no field 'clock'" pcl_slim_fit timed.pcd no.slim -trajectory drive.txt -time_field clock
expect 2 "trajectory 'odd.txt'" pcl_slim_fit timed.pcd no.slim -trajectory odd.txt
expect 2 'No such file' pcl_slim_fit timed.pcd no.slim -trajectory missing.txt
expect 2 'need -trajectory' pcl_slim_fit timed.pcd no.slim -time_offset 3
expect 2 'exclude each other' pcl_slim_fit timed.pcd no.slim -trajectory drive.txt -viewpoint 0,0,2
expect 2 'overwritten' pcl_slim_fit timed.pcd no.slim -trajectory drive.txt -json drive.txt
expect 2 'by tiles' pcl_slim_fit timed.pcd no.slim -trajectory drive.txt -tile_points 10000
expect 2 'by tiles' pcl_slim_fit own.pcd no.slim -tile_points 10000
expect 0 '' pcl_slim_fit own.pcd tiles.slim -tile_points 10000 -viewpoint 0,0,2
sed 's/^\([^ ]* [^ ]* [^ ]*\) [^ ]* [^ ]* 2 /\1 nan 0 2 /' own.pcd > nowhere.pcd
expect 1 'sensor of point' pcl_slim_fit nowhere.pcd no.slim
expect 0 '' pcl_slim_fit nowhere.pcd somewhere.slim -viewpoint 0,0,2
absent no.slim
head -1 drive.txt | grep -q timestamp || complain 'the trajectory was changed'

finish
