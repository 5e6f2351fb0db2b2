#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pcl_slim_mesh: closed and open scans in every format, the report, colours, mistakes and failures.
program=pcl_slim_mesh
# shellcheck source=tests/support/program_test.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"

# cloud NAME N LIMIT: a sphere of radius 2 up to the height 2 LIMIT, red above and blue below.
cloud() {
  awk -v n="$2" -v limit="$3" 'BEGIN {
    for (i = 0; i < n; ++i) {
      z = 1 - (2 * i + 1) / n; r = sqrt(1 - z * z); a = i * 2.399963229728653
      if (z <= limit) row[count++] = sprintf("%.7f %.7f %.7f %d", 2 * r * cos(a), 2 * r * sin(a), 2 * z,
        z > 0 ? 255 * 65536 : 255)
    }
    print "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1"
    print "WIDTH " count "\nHEIGHT 1\nPOINTS " count "\nDATA ascii"
    for (i = 0; i < count; ++i) print row[i]
  }' > "$1"
}
cloud ball.pcd 6000 1
cloud bowl.pcd 6000 0.5
awk '{ print NF == 4 && $1 ~ /^-?[0-9]/ ? $1 " " $2 " " $3 : $0 }' ball.pcd |
  sed 's/^FIELDS.*/FIELDS x y z/; s/^SIZE.*/SIZE 4 4 4/; s/^TYPE.*/TYPE F F F/; s/^COUNT.*/COUNT 1 1 1/' > plain.pcd

# A closed body.
expect 0 '' ball.pcd a.ply -json a.json
grep -q 'closed, 1 component' out.txt || complain "it does not say that the mesh is closed"
for key in program points threads seconds surfels triangles vertices components border_edges nonmanifold \
  euler dropped tolerance area closed_holes closed_area border_loops sheet_ends longest_loop widest_hole; do
  grep -q "\"$key\"" a.json || complain "no $key in the report"
done
[ "$(value a.json euler)" = 2 ] || complain "Euler characteristic $(value a.json euler)"
[ "$(value a.json border_edges)" = 0 ] || complain "$(value a.json border_edges) border edges"
[ "$(value a.json nonmanifold)" = 0 ] || complain "not manifold"
[ "$(value a.json components)" = 1 ] || complain "$(value a.json components) components"
for property in x nx k1 k2; do header a.ply "property float $property"; done
header a.ply "element face $(value a.json triangles)"
expect 0 '' ball.pcd sure.ply -errors 1
header sure.ply 'property float sigma_position'
expect 2 'name a .ply or .vtp file' ball.pcd sure.obj -errors 1
header a.ply "element vertex $(value a.json vertices)"

# An open one ends where its points do.
expect 0 '' bowl.pcd bowl.ply -json b.json
[ "$(value b.json euler)" = 1 ] || complain "a bowl's Euler characteristic $(value b.json euler)"
[ "$(value b.json border_edges)" -gt 20 ] || complain "a bowl without a border"
grep -q 'open, 1 border loop of' out.txt || complain "it does not say that the mesh is open"
[ "$(value b.json border_loops)" = 1 ] || complain "$(value b.json border_loops) loops of a bowl"
grep -q 'hole.*-watertight 1' out.txt || complain "it does not say what closes the bowl"

# It is closed on request, and by the hole's size where its rim is one in a ball.
expect 0 '' bowl.pcd whole.ply -watertight 1 -json w.json
[ "$(value w.json euler)" = 2 ] || complain "watertight: Euler characteristic $(value w.json euler)"
[ "$(value w.json border_edges)" = 0 ] || complain "watertight: $(value w.json border_edges) border edges"
[ "$(value w.json nonmanifold)" = 0 ] || complain "watertight: not manifold"
grep -q 'closed: 1 border loop by' out.txt || complain "it does not say what was closed"
size=$(awk -v w="$(value b.json widest_hole)" 'BEGIN { print w + 1 }')
expect 0 '' bowl.pcd whole.ply -hole "$size" -json w.json
[ "$(value w.json border_loops)" = 0 ] || complain "-hole $size closes nothing"

# The other formats.
for format in obj stl glb vtp; do expect 0 '' ball.pcd "a.$format" -color 1; done
[ "$(grep -c '^f ' a.obj)" = "$(value a.json triangles)" ] || complain "faces of a.obj"
grep -q '^v .* 0 0 1$' a.obj || complain "no blue in a.obj"
[ "$(stat -c %s a.stl)" = $((84 + 50 * $(value a.json triangles))) ] || complain "size of a.stl"
[ "$(head -c 4 a.glb)" = glTF ] || complain "a.glb is no glTF"
grep -aq 'COLOR_0' a.glb || complain "no colours in a.glb"
grep -aq "NumberOfPolys=\"$(value a.json triangles)\"" a.vtp || complain "polygons of a.vtp"
grep -aq 'Name="k1"' a.vtp || complain "no curvature in a.vtp"
grep -aq 'Name="RGB"' a.vtp || complain "no colours in a.vtp"
expect 0 '' ball.pcd color.ply -color
same a.ply color.ply
expect 0 '' ball.pcd grey.ply -color 0
differ grey.ply color.ply
header color.ply 'property uchar red'

# The same bytes for any number of threads, and from a surface, given as input or beside the scan.
expect 0 '' ball.pcd t1.ply -threads 1 -quiet
[ ! -s out.txt ] || complain "-quiet is not quiet"
expect 0 '' ball.pcd t3.ply -threads 3
same t1.ply t3.ply
"$bin/pcl_slim_fit" ball.pcd surface.slim -quiet || complain "pcl_slim_fit failed"
"$bin/pcl_slim_fit" ball.pcd surface.pcd -quiet || complain "pcl_slim_fit failed"
expect 0 '' surface.slim s1.ply -json s.json
header s1.ply 'property uchar red'
expect 0 '' surface.slim s0.ply -color 0
same grey.ply s0.ply
"$bin/pcl_slim_fit" ball.pcd grey.slim -color 0 -quiet || complain "pcl_slim_fit failed"
expect 0 '' grey.slim s0.ply
same grey.ply s0.ply
[ "$(value s.json euler)" = 2 ] || complain "from a surface: Euler characteristic"
# Textures are in .slim alone.
expect 0 '' surface.pcd s2.ply -color 0
same grey.ply s2.ply
expect 0 '' ball.pcd s3.ply -surface surface.slim -color
same color.ply s3.ply

# Options do what they say.
expect 0 '' ball.pcd fine.ply -tol 0.0005 -json f.json
expect 0 '' ball.pcd coarse.ply -tol 0.05 -json c.json
[ "$(value f.json triangles)" -gt "$(value c.json triangles)" ] || complain "-tol changes nothing"
expect 0 '' ball.pcd noise.ply -tol_noise 2 -json n.json
expect 0 '' bowl.pcd whole.ply -trim 0 -json w.json
[ "$(value w.json vertices)" -gt "$(value b.json vertices)" ] || complain "-trim 0 changes nothing"
expect 0 '' ball.pcd few.ply -max_triangles 500 -json few.json
[ "$(value few.json triangles)" -le 500 ] || complain "$(value few.json triangles) triangles"
[ "$(value few.json euler)" = 2 ] || complain "few triangles: Euler characteristic $(value few.json euler)"
expect 0 '' ball.pcd still.ply -relax 0
differ a.ply still.ply

# Sharp edges: a cube of side 2 with the normals of its faces gets its eight corners.
awk 'BEGIN {
  srand(7); n = 6000
  print "VERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\nCOUNT 1 1 1 1 1 1"
  print "WIDTH " n "\nHEIGHT 1\nPOINTS " n "\nDATA ascii"
  for (i = 0; i < n; ++i) {
    face = i % 3; side = i % 2 ? 1 : -1
    for (a = 0; a < 3; ++a) { p[a] = a == face ? side : 2 * rand() - 1; m[a] = a == face ? side : 0 }
    print p[0], p[1], p[2], m[0], m[1], m[2]
  }
}' > cube.pcd
expect 0 '' cube.pcd round.ply -json r.json
expect 0 '' cube.pcd sharp.ply -sharp 1 -json s.json
for report in r.json s.json; do
  [ "$(value $report euler)" = 2 ] || complain "a cube in $report: Euler characteristic $(value $report euler)"
done
[ "$(value r.json corner_vertices)" = 0 ] || complain "corners without -sharp"
[ "$(value s.json corner_vertices)" -ge 8 ] || complain "$(value s.json corner_vertices) corners of a cube"
expect 0 'needs normals' cube.pcd plain.ply -sharp 1 -use_normals 0

# Help, documentation, mistakes, failures.
documented "$program" mesh slim_fit
badScans ball.pcd
noSurfaces
expect 2 'no OUT' ball.pcd
expect 2 'must be named' ball.pcd d.pcd
expect 2 'exclude each other' ball.pcd d.ply -tol 1 -tol_noise 2
expect 2 'exclude each other' ball.pcd d.ply -surface surface.slim -penalty 2
expect 2 'no colours' plain.pcd d.ply -color
expect 2 'has no colours' grey.slim d.ply -color
expect 2 'leave -surface out' surface.pcd d.ply -surface surface.slim
expect 2 'No such file' missing.pcd d.ply
expect 2 'No such file' missing.slim d.ply
expect 2 'truncated' cut.pcd d.ply
expect 2 '-tol' ball.pcd d.ply -tol -1
expect 2 'did you mean -tol' ball.pcd d.ply -tool 1
expect 1 'allow as many' ball.pcd d.ply -max_triangles 3
expect 1 'NaN' nan.pcd d.ply
expect 1 'no points' none.pcd d.ply
expect 1 '' one.pcd d.ply
expect 1 '' line.pcd d.ply
expect 1 '' same.pcd d.ply
expect 2 'does not exist' ball.pcd nowhere/d.ply
keepsOld kept.ply ball.pcd
absent d.ply d.pcd nowhere
[ -z "$(find . -name '*.part')" ] || complain "temporary files were left behind"

finish
