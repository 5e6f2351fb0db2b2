#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_sample as a user meets it: how many points, where, and what is refused.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_sample

# A hemisphere of radius 5 with noise of .01.
awk 'BEGIN { n = 4000; srand(3)
  print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " n "\nHEIGHT 1\nDATA ascii"
  for (i = 0; i < n; ++i) {
    z = (i + .5) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653; s = 5 + .02 * (rand() - .5)
    printf "%.6f %.6f %.6f\n", s * r * cos(a), s * r * sin(a), s * z
  } }' > scan.pcd
badScans scan.pcd

expect 0 '' scan.pcd a.pcd -spacing 0.4 -json a.json
header a.pcd 'FIELDS x y z normal_x normal_y normal_z curvature mean_curvature gaussian_curvature'
n=$(value a.json samples)
[ "$n" -gt 500 ] && [ "$n" -lt 1100 ] || complain "$n samples of spacing .4"
tail -c $((36 * n)) a.pcd | od -An -v -t f4 -w36 | awk '{
  d = sqrt($1 * $1 + $2 * $2 + $3 * $3) - 5
  if (d * d > 1e-3 || $3 < -.3 || ($8 * $8 - .04) ^ 2 > 1e-3 || $7 < 0 || $7 > .05) { print; exit } }' > wrong.txt
[ ! -s wrong.txt ] || complain "no sample of the hemisphere: $(cat wrong.txt)"
expect 0 '' scan.pcd b.pcd -spacing 0.4 -threads 1 -quiet 1
[ ! -s out.txt ] || complain "-quiet is not quiet"
same a.pcd b.pcd
expect 0 '' scan.pcd c.ply -number 777 -json c.json
[ "$(value c.json samples)" = 777 ] || complain "not 777 samples"
header c.ply 'element vertex 777'
expect 0 '' scan.pcd d.las -number 50
[ -s d.las ] || complain "no d.las"

# A surface is sampled as its scan is, in any of its formats.
"$bin/pcl_slim_fit" scan.pcd surface.slim -quiet 1 || complain "pcl_slim_fit failed"
"$bin/pcl_slim_fit" scan.pcd surface.ply -quiet 1 || complain "pcl_slim_fit failed"
expect 0 '' surface.slim e.pcd -spacing 0.4
same a.pcd e.pcd
expect 0 '' surface.ply f.pcd -spacing 0.4 -hole 30 -json f.json
[ "$(value f.json samples)" -gt 500 ] || complain "a surface in a .ply has no samples"

# Colours: of the scan or of its surface; red grows with z here.
awk 'BEGIN { n = 3000
  print "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " n "\nHEIGHT 1\nDATA ascii"
  for (i = 0; i < n; ++i) {
    z = (i + .5) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653
    printf "%.6f %.6f %.6f %d\n", 5 * r * cos(a), 5 * r * sin(a), 5 * z, int(40 + 200 * z) * 65536 + 50
  } }' > colored.pcd
"$bin/pcl_slim_fit" colored.pcd colored.slim -quiet 1 || complain "pcl_slim_fit failed"
expect 0 '' colored.pcd h.pcd -number 400
header h.pcd 'FIELDS x y z normal_x normal_y normal_z curvature mean_curvature gaussian_curvature rgb'
expect 0 '' colored.slim i.pcd -number 400 -threads 1
same h.pcd i.pcd
tail -c 16000 h.pcd | od -An -v -t f4 -w40 | awk '{ print $3 }' > z.txt
tail -c 16000 h.pcd | od -An -v -t u1 -w40 | awk '{ print $37, $38, $39 }' | paste -d' ' z.txt - | awk '{
  # As much as red changes from point to point; not at the rim, where leaves have points on one side.
  d = $4 - (40 + 40 * $1)
  if (($1 > .5 && d * d > 81) || ($2 - 50) ^ 2 > 9 || $3 > 2) { print; exit } }' > wrong.txt
[ ! -s wrong.txt ] || complain "a sample has another colour: $(cat wrong.txt)"
expect 0 '' colored.pcd j.pcd -number 400 -color 0
header j.pcd 'FIELDS x y z normal_x normal_y normal_z curvature mean_curvature gaussian_curvature'

documented pcl_slim_sample slim_projection_smoother slim_fit
expect 2 'give -spacing or -number' scan.pcd g.pcd
expect 2 'exclude each other' scan.pcd g.pcd -spacing 1 -number 5
expect 2 'a number' scan.pcd g.pcd -spacing 0
expect 2 '.pcd, .ply, .las or .vtp' scan.pcd g.slim -number 5
expect 1 'raise the spacing' scan.pcd g.pcd -spacing 1e-6
expect 2 'truncated' cut.pcd g.pcd -number 5
expect 1 'no points' none.pcd g.pcd -number 5
expect 2 'does not exist' scan.pcd nowhere/g.pcd -number 5
absent g.pcd g.slim nowhere
finish
