#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Frames of one sensor: its noise is measured once and checked on each later frame. Arguments: programs'
# folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# frame SEED NOISE [HEIGHT] [N]: N x N points of a wave, with errors shared by 3 x 3 of them. HEIGHT 1: without rows.
frame() {
  awk -v seed="$1" -v noise="$2" -v flat="${3-}" -v n="${4-130}" 'BEGIN {
    srand(seed); w = 3
    print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1"
    print "WIDTH " (flat ? n * n : n) "\nHEIGHT " (flat ? 1 : n) "\nVIEWPOINT .6 .5 2 1 0 0 0\nPOINTS " n * n "\nDATA ascii"
    for (y = 0; y < n + w; ++y) for (x = 0; x < n + w; ++x)
      e[y, x] = sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand())
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) {
      sum = 0
      for (k = 0; k < w * w; ++k) sum += e[y + int(k / w), x + k % w]
      printf "%.6f %.6f %.6f\n", 0.01 * x, 0.01 * y, 0.05 * sin(6 * 0.01 * x + .3 * seed) * cos(5 * 0.01 * y) + noise * sum / w
    }
  }'
}

# key FILE NAME: values of a report's key, one after the other.
key() { grep -o "\"$2\": [^,]*" "$1" | cut -d' ' -f2 | tr -d '"\n' | sed 's/}$//'; }

frame 1 .004 > a.pcd
frame 2 .004 > b.pcd
frame 3 .004 > c.pcd
frame 4 .006 > noisy.pcd
frame 5 .004 '' 110 > small.pcd
frame 6 .004 1 > flat1.pcd
frame 7 .004 1 > flat2.pcd
mkdir out one three alone

# Each frame by the noise of the one before; the number of threads changes no byte.
expect 0 '' pcl_slim_smooth a.pcd b.pcd c.pcd -out out -json list.json
[ "$(key list.json sensor_noise)" = agreesagrees ] || complain "checks: $(key list.json sensor_noise)"
[ "$(grep -c "the sensor's noise given was used: residuals are" out.txt)" -eq 2 ] || complain "$(cat out.txt)"
expect 0 '' pcl_slim_smooth a.pcd b.pcd c.pcd -out one -threads 1
expect 0 '' pcl_slim_smooth a.pcd b.pcd c.pcd -out three -threads 3
for name in a b c; do
  same out/$name.pcd one/$name.pcd
  same out/$name.pcd three/$name.pcd
done

# The same by hand, through a file; the first frame is as it is alone, and so are all with -same_sensor 0.
expect 0 '' pcl_slim_smooth a.pcd alone/a.pcd -save_noise noise.json
expect 0 '' pcl_slim_smooth b.pcd from.pcd -noise_from noise.json -save_noise again.json
same out/a.pcd alone/a.pcd
same out/b.pcd from.pcd
same noise.json again.json
[ "$(key noise.json columns)" = 130 ] || complain "$(cat noise.json)"
expect 0 '' pcl_slim_smooth b.pcd alone/b.pcd
differ alone/b.pcd out/b.pcd
expect 0 '' pcl_slim_smooth a.pcd b.pcd -out one -same_sensor 0
same one/b.pcd alone/b.pcd

# A frame with more noise is measured, and its noise is that of the next one.
expect 0 '' pcl_slim_smooth noisy.pcd alone/noisy.pcd
expect 0 '' pcl_slim_smooth a.pcd noisy.pcd c.pcd b.pcd -out out -json list.json
[ "$(key list.json sensor_noise)" = differsdiffersagrees ] || complain "checks: $(key list.json sensor_noise)"
grep -q "the sensor's noise given differs: residuals are 1\.[3-6]. of it; measured anew" out.txt || complain "$(cat out.txt)"
same out/noisy.pcd alone/noisy.pcd

# One of another size, and one without rows.
expect 0 '' pcl_slim_smooth small.pcd from.pcd -noise_from noise.json
grep -q "is of frames of 130 x 130 points; measured anew" out.txt || complain "$(cat out.txt)"
expect 0 '' pcl_slim_smooth flat1.pcd flat2.pcd -out out -json list.json
[ -z "$(key list.json sensor_noise)" ] || complain 'noise handed on without rows'
expect 0 '' pcl_slim_smooth flat1.pcd flat2.pcd -out out -json list.json -same_sensor
[ "$(key list.json sensor_noise)" = agrees ] || complain "checks: $(key list.json sensor_noise)"

# Other programs hand it on, too, unless noise is given.
expect 0 '' pcl_slim_fit a.pcd b.pcd -out out -json list.json
[ "$(key list.json sensor_noise)" = agrees ] || complain "checks: $(key list.json sensor_noise)"
expect 0 '' pcl_slim_fit a.pcd b.pcd -out out -json list.json -noise .004
[ -z "$(key list.json sensor_noise)" ] || complain 'noise handed on beside -noise'
expect 0 '' pcl_slim_curvature a.pcd b.pcd -out out -surface out/a.slim

# Files and options that cannot be used: one line, and no output.
rm -f x.pcd
head -c 100 noise.json > cut.json
sed 's/"step": .*/"step": "no",/' noise.json > word.json
sed 's/"correlation": .*/"correlation": 0.5,/' noise.json > small.json
for file in cut.json word.json small.json a.pcd nothere.json; do
  expect 2 "$file" pcl_slim_smooth b.pcd x.pcd -noise_from $file
done
expect 2 'exclude each other' pcl_slim_smooth b.pcd x.pcd -noise_from noise.json -noise .004
expect 2 'exclude each other' pcl_slim_smooth b.pcd x.pcd -save_noise x.json -lambda 1e-6
expect 2 'of one input' pcl_slim_smooth a.pcd b.pcd -out out -save_noise x.json
expect 2 'does not exist' pcl_slim_smooth b.pcd x.pcd -save_noise nowhere/x.json
expect 2 'is IN, too' pcl_slim_smooth b.pcd x.pcd -save_noise b.pcd
absent x.pcd x.json
finish
