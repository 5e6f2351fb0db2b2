#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_color_splat_sampling as a user meets it: exit status, messages, files. Arguments: programs'
# folder, an empty folder to work in, folder of real scans (may be empty).
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_color_splat_sampling
mkdir -p -- "with space"

# cloud FILE SIZE COUNT OFFSET KIND: a wavy sheet, half red and half blue, ascii.
cloud() {
  awk -v size="$2" -v n="$3" -v offset="$4" -v kind="$5" 'BEGIN {
    printf "VERSION 0.7\nFIELDS x y z%s\n", kind == "plain" ? "" : " rgb"
    printf "SIZE %d %d %d%s\nTYPE F F F%s\n", size, size, size, kind == "plain" ? "" : " 4", kind == "plain" ? "" : " U"
    printf "COUNT 1 1 1%s\nWIDTH %d\nHEIGHT 1\nPOINTS %d\nDATA ascii\n", kind == "plain" ? "" : " 1", n, n
    srand(7)
    for (i = 0; i < n; ++i) {
      x = rand(); y = rand()
      colour = x + 0.4 * y < 0.7 ? 230 * 65536 + 40 * 256 + 20 : 20 * 65536 + 30 * 256 + 210
      printf "%.9f %.9f %.9f", offset + x, offset + y, 0.1 * sin(6 * x) * cos(5 * y)
      print kind == "plain" ? "" : " " colour
    }
  }' > "$1"
}

cloud scan.pcd 4 6000 0 coloured
cloud plain.pcd 4 6000 0 plain
cloud far.pcd 8 6000 4918360.25 coloured
cloud near.pcd 8 6000 0.25 coloured
cloud "with space/scan.pcd" 4 500 0 coloured
badScans scan.pcd

# Good runs, both formats, and the report.
for extension in pcd ply; do
  expect 0 '' scan.pcd "a.$extension" -json "$extension.json"
  [ -s "a.$extension" ] || complain "no a.$extension"
  for key in program version input points threads seconds total load sample peak_rss_mb splats holes \
    overlap skipped non_finite; do
    grep -q "\"$key\"" "$extension.json" || complain "no $key in $extension.json"
  done
  grep -a -q 'pcl_slim kind splats' "a.$extension" || complain "a.$extension does not say it holds splats"
done
grep -a -q '^FIELDS x y z normal_x normal_y normal_z rgba radius confidence curvature$' a.pcd ||
  complain "the fields are not PointSurfel's"
[ "$(value pcd.json splats)" = "$(value ply.json splats)" ] || complain "pcd and ply differ"
awk -v h="$(value pcd.json holes)" 'BEGIN { exit !(h <= 0.0001) }' || complain "holes: $(value pcd.json holes)"
for rays in 10000 300; do # a sample unless more are wanted
  [ "$rays" = 10000 ] || expect 0 '' scan.pcd a.pcd -rays "$rays" -json pcd.json
  cast=$(value pcd.json cast) sparse=$(value pcd.json sparse) rough=$(value pcd.json rough)
  [ $((cast + sparse + rough)) = "$rays" ] || complain "$cast + $sparse + $rough rays, not $rays"
done
awk -v o="$(value pcd.json overlap)" 'BEGIN { exit !(o > 1 && o < 3.2) }' || complain "overlap"
grep -q '^> Sampling \[done, .* splats\]' out.txt || complain "no Sampling line"
expect 0 '' scan.pcd b.pcd -threads 1 -quiet 1
[ ! -s out.txt ] || complain "-quiet is not quiet"
cmp -s a.pcd b.pcd || complain "threads change the splats"
expect 0 '' "with space/scan.pcd" "with space/a.PLY"
for option in '-initial 12' '-geo 0.1' '-color 0.05' '-min_points 8' '-max_depth 0' '-max_splats 300' \
  '-target_error 3' '-paper 1' '-colors gradient' '-colors own' '-radius neighbours' '-radius corner' \
  '-remove_noise 0' '-viewpoint -1,2.5,9' '-estimate_normals 8' '-use_normals 0' '-rays 0'; do
  # shellcheck disable=SC2086
  expect 0 '' scan.pcd c.pcd $option -json c.json
  case $option in
    '-max_splats 300') [ "$(value c.json splats)" -le 300 ] || complain "more than 300 splats" ;;
    '-colors gradient') grep -a -q 'curvature red_x red_y red_z green_x' c.pcd || complain "no gradient" ;;
    '-rays 0') ! grep -q '"holes"' c.json || complain "holes without rays" ;;
  esac
done
expect 0 '' scan.pcd fine.pcd -color 0.02 -json fine.json
expect 0 '' scan.pcd coarse.pcd -color 1 -json coarse.json
[ "$(value fine.json splats)" -gt "$(value coarse.json splats)" ] || complain "colour divides nothing"
expect 0 '' plain.pcd d.pcd -json plain.json
grep -q 'no colours' out.txt || complain "not said that there are no colours"

# Colours of any type are the same colours.
channels() { # FILE TYPE WHITE
  {
    printf 'ply\nformat ascii 1.0\nelement vertex 6000\nproperty float x\nproperty float y\nproperty float z\n'
    printf "property $2 red\nproperty $2 green\nproperty $2 blue\nend_header\n"
    awk -v white="$3" 'seen { c = $4; r = int(c / 65536); g = int(c / 256) % 256; b = c % 256; f = white / 255
      print $1, $2, $3, r * f, g * f, b * f }
      /^DATA/ { seen = 1 }' scan.pcd
  } > "$1"
}
for type in 'uchar 255' 'ushort 65535' 'float 1' 'double 255'; do
  # shellcheck disable=SC2086
  channels "${type% *}.ply" $type
  expect 0 '' "${type% *}.ply" "${type% *}.pcd"
  ! grep -q 'no colours' out.txt || complain "no colours of type ${type% *}"
  same uchar.pcd "${type% *}.pcd"
done

# Coordinates of type double: a far scan gives the splats of the near one, place apart.
expect 0 '' far.pcd far.pcd.ply -json far.json
expect 0 '' near.pcd near.ply -json near.json
grep -a -q 'pcl_slim shift 4918360' far.pcd.ply || complain "a far scan is not shifted"
awk -v f="$(value far.json splats)" -v n="$(value near.json splats)" \
  'BEGIN { exit !(f > 0.97 * n && f < 1.03 * n) }' || complain "far and near differ"

# A sensor that is nowhere is none: normals are estimated and seen from 0.
sed 's/^VIEWPOINT.*//; s/^POINTS/VIEWPOINT nan nan nan 1 0 0 0\nPOINTS/' scan.pcd > nowhere.pcd
expect 0 '' nowhere.pcd nowhere_out.pcd -use_normals 0
sed 's/^VIEWPOINT.*//; s/^POINTS/VIEWPOINT 0 0 0 1 0 0 0\nPOINTS/' scan.pcd > origin.pcd
expect 0 '' origin.pcd origin_out.pcd -use_normals 0
same nowhere_out.pcd origin_out.pcd

# Help, documentation, usage errors: status 2, nothing written.
documented "$program" color_octree_splat_sampler
expect 2 'did you mean -color' scan.pcd e.pcd -colour 2
expect 2 'a number' scan.pcd e.pcd -geo nan
expect 2 'exclude each other' scan.pcd e.pcd -max_splats 10 -target_error 2
for pair in '-max_splats 10 -initial 5' '-max_splats 10 -geo .2' '-target_error 3 -color .1' \
  '-paper -radius corner' '-paper -min_points 3'; do
  # shellcheck disable=SC2086
  expect 2 'exclude each other' scan.pcd e.pcd $pair
done
expect 2 'mean' scan.pcd e.pcd -colors pretty
expect 2 'name a .pcd, .ply or .vtp' scan.pcd e.las
expect 2 'share a file' scan.pcd scan.pcd
absent e.pcd e.las

# Scans of no use and places that cannot be written: status 2 or 1, nothing left.
refuses scan.pcd
keepsOld kept.pcd scan.pcd
expect 0 '' one.pcd one.ply -json one.json
[ "$(value one.json splats)" = 1 ] || complain "one point is not one splat"

if [ -n "$data" ] && [ -f "$data/kinect_mosd_learn13.pcd" ]; then
  expect 0 '' "$data/kinect_mosd_learn13.pcd" kinect.pcd -json kinect.json
  grep -q '"non_finite": 99749' kinect.json || complain "kinect's NaN are not counted"
  awk -v s="$(value kinect.json single_points)" 'BEGIN { exit !(s < 20000) }' || complain "kinect shatters"
  expect 0 '' "$data/autzen_stadium.pcd" autzen.ply -max_splats 20000 -json autzen.json
  awk -v s="$(value autzen.json splats)" 'BEGIN { exit !(s > 19000 && s <= 20000) }' || complain "autzen's budget"
fi

finish
