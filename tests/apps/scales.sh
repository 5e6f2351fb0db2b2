#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Clouds of two scales: strays far from all others, a finely scanned object in a coarse scan, points along lines.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# A coloured part of size 2; strays cost it no discs.
awk 'BEGIN { srand(3)
  for (i = 0; i < 20000; ++i) {
    x = 2 * rand(); y = 2 * rand(); z = 0.1 * sin(6 * x) * cos(5 * y) + 0.002 * (rand() - 0.5)
    print x, y, z, int(x * 4) % 2 ? 200 : 40, int(y * 4) % 2 ? 200 : 40, 90
  } }' > part.txt
program=pcl_color_splat_sampling
splats() { # splats FILE ARGS...: how many discs
  expect 0 '' "$1" discs.ply -rays 0 -json splats.json "${@:2}"
  value splats.json splats
}
alone=$(splats part.txt)
{ cat part.txt; echo '100000 0 0 1 2 3'; } > one.txt
[ "$(splats one.txt)" = "$alone" ] || complain "a stray changes $alone discs to $(value splats.json splats)"
grep -q 'points skipped: 1 far away' out.txt || complain "no word of the stray: $(cat out.txt)"
{ cat one.txt; echo '0 -100000 0 1 2 3'; echo '0 0 90000 1 2 3'; } > three.txt
[ "$(splats three.txt)" = "$alone" ] || complain "three strays change $alone discs to $(value splats.json splats)"
[ "$(splats three.txt -max_splats 2000)" -gt 1900 ] || complain "a budget gives $(value splats.json splats)"
# Nearer ones are points of the cloud, but leave the others their cells.
for far in 10 100 1000; do
  { cat part.txt; echo "$far 0 0 1 2 3"; } > near.txt
  found=$(splats near.txt)
  [ "$found" -gt $((alone * 3 / 4)) ] || complain "$found of $alone discs with a point $far away"
done

# A ball of radius .1 with dents, 2 mm apart and .5 mm noise, on a yard 100 wide, .5 apart and 20 mm noise. The truth
# follows in the same order.
awk 'function gauss() { return sqrt(-2 * log(1 - rand())) * cos(6.28318530718 * rand()) }
  BEGIN { srand(11)
    for (i = 0; i < 30000; ++i) {
      w = 2 * rand() - 1; a = 6.28318530718 * rand(); s = sqrt(1 - w * w)
      r = .1 + .007 * sin(4 * a) * s * s * s * s; e = r + .0005 * gauss()
      printf "%.7f %.7f %.7f %.9f %.9f %.9f\n", e * s * cos(a), e * s * sin(a), 1.3 + e * w, r * s * cos(a), r * s * sin(a), 1.3 + r * w
    }
    for (i = 0; i < 40000; ++i) {
      x = 100 * rand() - 50; y = 100 * rand() - 50
      printf "%.7f %.7f %.7f 0 0 0\n", x, y, .3 * sin(x / 9) * cos(y / 7) + .02 * gauss()
    } }' > both.txt
program=pcl_slim_smooth
expect 0 '' both.txt smooth.ply -columns x,y,z,tx,ty,tz
# rms FILE: of 30,000 points about the dented ball, along its radius.
cat > rms.py << 'PYTHON'
import math, struct, sys
data = open(sys.argv[1], 'rb').read()
at = data.index(b'end_header\n') + 11
header = data[:at].decode()
types = [line.split()[1] for line in header.splitlines() if line.startswith('property')]
step = sum(8 if t == 'double' else 4 for t in types)
size = 8 if types[0] == 'double' else 4
raw = sys.argv[2] == 'raw'
rows = [line.split() for line in open('both.txt')][:30000]
total = 0
for i, row in enumerate(rows):
    p = [float(v) for v in row[:3]] if raw else struct.unpack_from('<3' + ('d' if size == 8 else 'f'), data, at + i * step)
    x, y, z = p[0], p[1], p[2] - 1.3
    r = math.sqrt(x * x + y * y + z * z)
    s = math.hypot(x, y) / r
    total += (r - .1 - .007 * math.sin(4 * math.atan2(y, x)) * s ** 4) ** 2
print(math.sqrt(total / len(rows)))
PYTHON
raw=$(python3 rms.py smooth.ply raw)
smooth=$(python3 rms.py smooth.ply smooth)
awk -v raw="$raw" -v smooth="$smooth" 'BEGIN { exit !(raw > .0004 && smooth < raw) }' ||
  complain "the ball is $smooth from the truth, and $raw before"

# Two lines far apart have so little area that the first spacing finds no place for a sample.
awk 'BEGIN { for (i = 0; i < 20000; ++i) print i, i % 2 ? 0 : 1000, 0 }' > lines.xyz
program=pcl_slim_sample
expect 0 '' lines.xyz lines.pcd -number 50
header lines.pcd 'POINTS 50'
finish
