#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_smooth as a user meets it: exit status, messages, and every field that must survive.
# Arguments: programs' folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim_smooth

# rows FILE STEP COUNT TYPE: the last COUNT * STEP bytes, one point a line.
rows() { tail -c $(($2 * $3)) "$1" | od -An -v -t "$4" "-w$2"; }

# The sheet z = sin(6 x) cos(5 y) / 10 over the unit square with noise of .002, and one outlier.
# sheet FILE SIZE OFFSET: x y z of 4 or 8 bytes, and fields this project never heard of.
points=6000
sheet() {
  awk -v size="$2" -v offset="$3" -v n=$points 'BEGIN {
    print "VERSION 0.7\nFIELDS label x y z intensity quality\nSIZE 4 " size, size, size " 2 4"
    print "TYPE U F F F U F\nCOUNT 1 1 1 1 1 1\nWIDTH " n "\nHEIGHT 1\nPOINTS " n "\nDATA ascii"
    srand(7)
    for (i = 0; i < n; ++i) {
      x = rand(); y = rand()
      z = 0.1 * sin(6 * x) * cos(5 * y) + 0.002 * sqrt(-2 * log(1 - rand())) * cos(6.2831853 * rand())
      if (i == 1234) { x = 0.5; y = 0.25; z = 0.75 }
      printf "%d %.9f %.9f %.9f %d %.1f\n", 3 * i, offset + x, offset + y, z, i % 65536, i / 2
    }
  }' > "$1"
}

# errorOf FILE: RMS distance in z from the sheet, of rows of x y z as text.
errorOf() {
  awk -v offset="$1" '{
    x = $1 - offset; y = $2 - offset
    if ($3 > 0.5) next
    d = $3 - 0.1 * sin(6 * x) * cos(5 * y); sum += d * d; ++n
  } END { print sqrt(sum / n) }'
}

sheet near.pcd 4 0
sheet far.pcd 8 4918360.25
badScans near.pcd

# A good run: fields in their order and type, the report, any number of threads.
expect 0 '' near.pcd a.pcd -json a.json
for line in 'FIELDS label x y z intensity quality' 'SIZE 4 4 4 4 2 4' 'TYPE U F F F U F' "POINTS $points"; do
  header a.pcd "$line"
done
for key in program version input output points threads seconds total load fit project save \
  peak_rss_mb surfels leaves degree lambda diagonal uncovered unsupported moved non_finite \
  rms_displacement max_displacement skipped; do
  grep -q "\"$key\"" a.json || complain "no $key in the report"
done
grep -q '^> Projecting \[done, .* ms : .* points\]' out.txt || complain "no Projecting line"
rms=$(sed -n "s/^  the surface is \([^ ]*\) RMS from the points, [^ ]* at most, in the scan's unit$/\1/p" out.txt)
awk -v said="$rms" -v kept="$(value a.json rms_displacement)" 'BEGIN { exit !(said > 0 && (said - kept) ^ 2 < 1e-4 * kept ^ 2) }' ||
  complain "the surface is '$rms' from the points, $(value a.json rms_displacement) in the report"
expect 0 '' near.pcd b.pcd -threads 1 -quiet 1
[ ! -s out.txt ] || complain "-quiet is not quiet"
same a.pcd b.pcd
expect 0 '' near.pcd b.pcd -threads 4
same a.pcd b.pcd
tail -c $((22 * points)) a.pcd > bytes
awk '/^DATA/ { data = 1; next } data { print $1, $5, $6 }' near.pcd > wanted.txt
od -An -v -t u1 -w22 bytes | awk '{
  label = $1 + 256 * ($2 + 256 * ($3 + 256 * $4)); intensity = $17 + 256 * $18
  printf "%d %d %.1f\n", label, intensity, label / 6
}' > kept.txt
same wanted.txt kept.txt
expect 0 '' near.pcd plain.ply
header plain.ply 'property uint label'
header plain.ply 'property ushort intensity'
header plain.ply 'property float quality'

# Doubles: noise shrinks as far away as here, displacement is the noise, the outlier's bits stay.
expect 0 '' far.pcd far_out.pcd -json far.json
header far_out.pcd 'SIZE 4 8 8 8 2 4'
"$bin/pcl_slim_curvature" far.pcd untouched.pcd -quiet 1 || complain "pcl_slim_curvature failed"
rows far_out.pcd 34 $points x1 | awk '{ print substr($0, 13, 72) }' > moved.txt
rows untouched.pcd 62 $points x1 | awk '{ print substr($0, 13, 72) }' > original.txt
[ "$(sed -n 1235p moved.txt)" = "$(sed -n 1235p original.txt)" ] || complain "the outlier moved"
[ "$(paste -d= moved.txt original.txt | awk -F= '$1 == $2' | wc -l)" -eq \
  "$(value far.json unsupported)" ] || complain "as many points keep their bits as have no support"
[ "$(value far.json unsupported)" -ge 1 ] || complain "the outlier is not counted"
[ "$(value far.json unsupported)" -le 20 ] || complain "too many points without support"
for run in a far; do
  awk -v d="$(value $run.json rms_displacement)" 'BEGIN { exit !(d > 0.0018 && d < 0.0022) }' ||
    complain "$run: rms displacement $(value $run.json rms_displacement) for noise of .002"
done
expect 0 '' far.pcd far_xyz.pcd
tail -c $((34 * points)) far_xyz.pcd | od -An -v -t x1 -w34 | awk '{
  for (i = 5; i <= 28; ++i) printf "\\x%s", $i; printf "\n" }' > escaped.txt
while IFS= read -r line; do printf '%b' "$line"; done < escaped.txt > doubles
od -An -v -t f8 -w24 doubles | errorOf 4918360.25 > error.txt
awk '{ exit !($1 < 0.0008) }' error.txt || complain "far: RMS error $(cat error.txt) of .002 is left"

# Organized, with holes: width, height and NaN stay where they are.
awk 'BEGIN {
  print "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 80\nHEIGHT 60"
  print "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4800\nDATA ascii"
  for (v = 0; v < 60; ++v) for (u = 0; u < 80; ++u) {
    x = (u - 40) / 60; y = (v - 30) / 60; z = 2 + 0.2 * sin(3 * x) * cos(2 * y)
    if ((u + v) % 11 == 0) print "nan nan nan", u + 256 * v
    else printf "%.7f %.7f %.7f %d\n", x * z, y * z, z + 0.001 * ((u * 7 + v * 13) % 5 - 2), u + 256 * v
  }
}' > grid.pcd
expect 0 '' grid.pcd grid_out.pcd -normals 1 -json grid.json
header grid_out.pcd 'FIELDS x y z rgb normal_x normal_y normal_z curvature'
header grid_out.pcd 'WIDTH 80'
header grid_out.pcd 'HEIGHT 60'
rows grid_out.pcd 32 4800 f4 | awk '{
  hole = (int((NR - 1) / 80) + (NR - 1) % 80) % 11 == 0
  if (hole != ($1 == "nan" || $1 == "-nan")) exit 1
  if (hole != ($5 == "nan" || $5 == "-nan")) exit 1
  if (!hole && ($5 * $5 + $6 * $6 + $7 * $7 - 1) ^ 2 > 1e-8) exit 1
}' || complain "holes moved, or normals are not unit"
awk '/^DATA/ { data = 1; next } data && /^nan/ { ++n } END { print n }' grid.pcd > holes.txt
[ "$(value grid.json non_finite)" = "$(cat holes.txt)" ] || complain "NaN are not counted"
for form in ply vtp; do
  expect 0 '' grid.pcd grid_out.$form -normals 1
  [ "$(grep -c "^  .$form does not keep the scan's rows; .pcd does\$" out.txt)" = 1 ] ||
    complain "lost rows are not told of .$form"
done

# Curvatures are those of a sphere of radius 5, whose normals point outward. Of its 3000 points 30 fill
# a disc of radius r, r^2 = 4 * 30 / 3000 * 25, whose surface variation is (r / 5)^2 / 24 = .00167.
awk -v n=3000 'BEGIN {
  print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " n "\nHEIGHT 1"
  print "POINTS " n "\nDATA ascii"
  for (i = 0; i < n; ++i) {
    z = 1 - (2 * i + 1) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653
    printf "%.7f %.7f %.7f\n", 5 * r * cos(a), 5 * r * sin(a), 5 * z
  }
}' > sphere.pcd
expect 0 '' sphere.pcd sphere_out.pcd -normals 1 -curvatures 1
header sphere_out.pcd 'FIELDS x y z normal_x normal_y normal_z curvature k1 k2 mean_curvature gaussian_curvature'
rows sphere_out.pcd 44 3000 f4 | awk '{ sum += $7 }
  ($8 - .2) ^ 2 > 1e-5 || ($9 - .2) ^ 2 > 1e-5 || ($10 - .2) ^ 2 > 1e-6 || ($11 - .04) ^ 2 > 1e-6 { print; exit }
  END { if ((sum / 3000 / .00167 - 1) ^ 2 > .01) print "surface variation of", sum / 3000 }' > wrong.txt
[ ! -s wrong.txt ] || complain "not the curvatures of a sphere: $(cat wrong.txt)"
expect 0 '' sphere.pcd plain.pcd -normals 1 -variation 0
header plain.pcd 'FIELDS x y z normal_x normal_y normal_z'
expect 0 '' sphere.pcd bent.pcd -curvatures 1
header bent.pcd 'FIELDS x y z k1 k2 mean_curvature gaussian_curvature'

# Standard errors: of a noisy sphere, 95 % of the points are within 1.96 of theirs.
awk -v n=6000 'BEGIN {
  srand(5)
  print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " n "\nHEIGHT 1"
  print "POINTS " n "\nDATA ascii"
  for (i = 0; i < n; ++i) {
    z = 1 - (2 * i + 1) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653
    s = 5 + .01 * sqrt(-2 * log(1 - rand())) * cos(6.283185 * rand())
    printf "%.7f %.7f %.7f\n", s * r * cos(a), s * r * sin(a), s * z
  }
}' > noisy.pcd
expect 0 '' noisy.pcd sure.pcd -errors 1
header sure.pcd 'FIELDS x y z sigma_position sigma_normal'
rows sure.pcd 20 6000 f4 | awk '{ d = sqrt($1 ^ 2 + $2 ^ 2 + $3 ^ 2) - 5; if (d ^ 2 <= (1.96 * $4) ^ 2) ++good; sum += $4; turn += $5 }
  END { if (good < 5400 || good > 5940 || sum / 6000 > .004 || turn / 6000 > .02) print good, sum / 6000, turn / 6000 }' > wrong.txt
[ ! -s wrong.txt ] || complain "not the errors of a sphere: $(cat wrong.txt)"
expect 2 '-mesh' noisy.pcd no.pcd -mesh 1 -errors 1

# A mesh: faces and unknown properties stay; whole-number coordinates become real ones.
awk 'BEGIN {
  n = 40
  print "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex " n * n
  print "property float x\nproperty float y\nproperty float z\nproperty uchar red"
  print "property uchar green\nproperty uchar blue\nproperty double weird"
  print "element face " 2 * (n - 1) * (n - 1) "\nproperty list uchar int vertex_indices\nend_header"
  srand(3)
  for (j = 0; j < n; ++j) for (i = 0; i < n; ++i)
    printf "%d %d %.6f %d %d 7 %d.25\n", i, j, 3 * sin(i / 9) + 0.1 * (rand() - 0.5), i, j, i * j
  for (j = 0; j < n - 1; ++j) for (i = 0; i < n - 1; ++i) {
    k = j * n + i; print 3, k, k + 1, k + n; print 3, k + 1, k + n + 1, k + n
  }
}' > mesh.ply
expect 0 '' mesh.ply mesh_out.ply -normals 1
for line in 'element face 3042' 'property double weird' 'property uchar green' 'property float nx' \
  'comment made by hand'; do
  header mesh_out.ply "$line"
done
"$bin/pcl_slim_curvature" mesh.ply mesh_k.ply -quiet 1 || complain "pcl_slim_curvature failed"
cmp -s <(tail -c $((13 * 3042)) mesh_out.ply) <(tail -c $((13 * 3042)) mesh_k.ply) || complain "faces changed"
sed 's/property float \([xyz]\)$/property int \1/; s/^\([0-9]* [0-9]* \)\([0-9.-]*\)\(.* 7 \)/\1\n\2\n\3/' mesh.ply |
  awk 'line == 2 { printf "%s\n", $0; line = 0; next }
       line == 1 { printf "%d", int($0 * 10); line = 2; next }
       /^[0-9]+ [0-9]+ $/ { printf "%s", $0; line = 1; next } { print }' > whole.ply
expect 0 '' whole.ply whole_out.pcd
header whole_out.pcd 'SIZE 8 8 8 4 8'
expect 0 '' mesh.ply faceless.pcd -use_normals 0
header faceless.pcd 'FIELDS x y z rgb weird'

# The mesh itself: its faces, fields and comment stay, its edges are measured or as given, and the points' own
# options are refused.
expect 0 '' mesh.ply mesh_m.ply -mesh 1 -json mesh_m.json
cmp -s <(tail -c $((13 * 3042)) mesh_out.ply) <(tail -c $((13 * 3042)) mesh_m.ply) || complain "-mesh changed faces"
for key in faces faces_left_out moved isolated held sharp sharp_share noise lambda rms_displacement smooth; do
  grep -q "\"$key\"" mesh_m.json || complain "no $key in the report of -mesh"
done
[ "$(value mesh_m.json faces)" = 3042 ] || complain "not all faces are counted"
grep -q '^> Smoothing the mesh \[done, .* ms : .* vertices' out.txt || complain "no line on the mesh"
expect 0 '' mesh.ply mesh_t.ply -mesh 1 -threads 3 -quiet
same mesh_m.ply mesh_t.ply
expect 0 '' mesh.ply mesh_s.ply -mesh 1 -sharp 1 -json mesh_s.json
grep -q '"sharp": true' mesh_s.json || complain "-sharp 1 keeps no edges"
expect 0 '' mesh.ply mesh_n.ply -mesh 1 -sharp 0 -normals 1
header mesh_n.ply 'property float nx'
expect 0 '' mesh.ply mesh_p.ply -mesh 1 -paper 1
differ mesh_p.ply mesh_m.ply
expect 1 'no faces' near.pcd d.pcd -mesh 1
expect 2 'exclude each other' mesh.ply d.ply -mesh 1 -use_normals 0
absent d.pcd d.ply

# A surface made before gives the very same points; another object's is refused.
"$bin/pcl_slim_fit" near.pcd surface.slim -quiet 1 || complain "pcl_slim_fit failed"
expect 0 '' near.pcd reused.pcd -surface surface.slim -json reused.json
same a.pcd reused.pcd
grep -q '"surface": "surface.slim"' reused.json || complain "the surface is not reported"
[ "$(value reused.json lambda)" = "$(value a.json lambda)" ] || complain "lambda is not the fit's"
expect 1 'another cloud' grid.pcd d.pcd -surface surface.slim
expect 2 'exclude each other' near.pcd d.pcd -surface surface.slim -degree 2
expect 2 'No such file' near.pcd d.pcd -surface missing.slim
expect 2 'overwritten' near.pcd grid.pcd -surface ./grid.pcd
expect 2 '' near.pcd d.pcd -surface near.pcd
absent d.pcd

for option in '-degree 2' '-t_mdl 0.02' '-compact 1' '-robust 1' '-paper 1' '-lambda 1e-6' \
  '-viewpoint -1,2.5,9' '-estimate_normals 12' '-target_error 0.002' '-max_surfels 400' '-least_radius 0.1' '-seed 5'; do
  # shellcheck disable=SC2086
  expect 0 '' near.pcd c.pcd $option
done
expect 0 '' mesh.ply c.ply -sharp 1

# Help, version, documentation.
expect 0 '' -h
grep -q '^Syntax is: pcl_slim_smooth ' out.txt || complain "no syntax line"
expect 0 '' -version
documented "$program" slim_projection_smoother slim_fit

# Usage errors: status 2, nothing written.
expect 2 'did you mean -normals' near.pcd d.pcd -normal 1
expect 2 '0 or 1' near.pcd d.pcd -normals yes
expect 2 '.pcd, .ply, .las or .vtp' near.pcd d.slim
expect 2 'overwritten' near.pcd ./near.pcd
expect 2 'overwritten' near.pcd d.pcd -json near.pcd
expect 2 'share a file' near.pcd d.pcd -json d.pcd
absent d.slim

# Scans of no use and places that cannot be written: status 2 or 1, nothing left.
refuses near.pcd
keepsOld kept.pcd near.pcd

# What a PLY file contains beside points and faces is not written, and said to be left out.
{
  printf 'ply\nformat ascii 1.0\nelement vertex 900\nproperty float x\nproperty float y\nproperty float z\n'
  printf 'property list uchar int tags\nelement edge 1\nproperty int a\nend_header\n'
  awk 'BEGIN { for (i = 0; i < 900; ++i) print i % 30, int(i / 30), sin(i % 30 / 9), 1, 5; print 7 }'
} > tagged.ply
"$bin/$program" tagged.ply untagged.ply > out.txt 2> err.txt || complain "a file with tags fails"
[ "$(grep -c 'is not written' err.txt)" -eq 2 ] || complain "not said what is left out: $(cat err.txt)"
rm -f untagged.ply

# Points that are no surface are written as they are, with a warning.
noSurfaces
for scan in one line same; do
  got=0
  "$bin/$program" $scan.pcd kept.pcd -quiet -json kept.json > out.txt 2> err.txt || got=$?
  [ "$got" -eq 0 ] || complain "$scan: exit $got"
  [ ! -s out.txt ] || complain "-quiet is not quiet"
  [ "$(grep -c '^warning: .*written as they are' err.txt)" = 1 ] || complain "$scan: $(cat err.txt)"
  grep -q '"warning"' kept.json || complain "$scan: no warning in the report"
  "$bin/$program" $scan.pcd twice.pcd -quiet 2> /dev/null && "$bin/$program" twice.pcd again.pcd -quiet 2> /dev/null
  same twice.pcd again.pcd
  rows kept.pcd 12 "$(grep -a '^POINTS' kept.pcd | cut -d' ' -f2)" f4 | awk '{ print $1 + 0, $2 + 0, $3 + 0 }' > kept.txt
  awk '/^DATA/ { data = 1; next } data { print $1 + 0, $2 + 0, $3 + 0 }' $scan.pcd > wanted.txt
  same kept.txt wanted.txt
done

# Ctrl-C: status 130, nothing left.
points=200000
sheet big.pcd 4 0
interrupted big.pcd stopped.pcd

if [ -n "$data" ] && [ -f "$data/kinect_mosd_learn13.pcd" ]; then
  expect 0 '' "$data/kinect_mosd_learn13.pcd" kinect.pcd -json kinect.json
  [ "$(value kinect.json non_finite)" = 99749 ] || complain "kinect's NaN are not counted"
  header kinect.pcd 'FIELDS label x y z rgba'
  header kinect.pcd 'WIDTH 640'
  expect 0 '' "$data/stanford_bunny_zipper.ply" bunny.ply -json bunny.json
  header bunny.ply 'element face 69451'
  [ "$(($(value bunny.json moved) + $(value bunny.json unsupported)))" = 35947 ] ||
    complain "vertices without faces are lost"
fi

finish
