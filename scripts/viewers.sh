#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws each documented pair of file and viewer on a virtual screen:
#   scripts/viewers.sh [BIN [OUT]]    BIN: the programs' folder; OUT: where OUT/VIEWER_FILE.png go
# Needs Xvfb and python3; of pcl_viewer (pcl-tools), meshlab, CloudCompare (cloudcompare) and paraview those that are
# installed are tried (VIEWERS: only these), the last two with xdotool, which answers them. Exits 1 where a viewer
# shows the same with a file as without; whether it shows the right thing is for the eye. MeshLab gets no .obj: Debian
# 12's, 2020.09, aborts at every one.
set -uo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
bin=$(cd -- "${1-$root/build/release/bin}" && pwd) || exit 2
out=${2-viewers_out}
mkdir -p -- "$out" && cd -- "$out" || exit 2
seconds=${VIEWER_SECONDS-15} # that a viewer gets until it has drawn
failures=0

"$bin/pcl_slim_demo_scan" scan.pcd -points 60000 -quiet || exit 1
for format in pcd ply vtp; do "$bin/pcl_slim_fit" scan.pcd surface.$format -quiet || exit 1; done
for format in ply obj stl vtp; do "$bin/pcl_slim_mesh" scan.pcd mesh.$format -quiet || exit 1; done
for format in pcd ply vtp; do "$bin/pcl_color_splat_sampling" scan.pcd splats.$format -quiet || exit 1; done
"$bin/pcl_slim_curvature" scan.pcd curved.vtp -quiet || exit 1

# shoot PICTURE COMMAND...: what the screen shows after some seconds, as a picture.
shoot() {
  local picture=$1 display=$((90 + RANDOM % 900)) frame server viewer
  shift
  frame=$(mktemp -d)
  Xvfb ":$display" -screen 0 1024x768x24 -fbdir "$frame" > /dev/null 2>&1 &
  server=$!
  sleep 1
  # ParaView waits for Apply unless its settings say otherwise.
  mkdir -p -- "$frame/.config/ParaView"
  echo '{"settings": {"GeneralSettings": {"AutoApply": 1}}}' \
    > "$frame/.config/ParaView/ParaView-UserSettings.json"
  DISPLAY=:$display QT_QPA_PLATFORM=xcb HOME=$frame "$@" > /dev/null 2>&1 &
  viewer=$!
  sleep "$seconds"
  # CloudCompare asks about columns, ParaView greets.
  local key=
  [ "$1" = CloudCompare ] && key=Return
  [ "$1" = paraview ] && key=Escape
  if [ -n "$key" ] && command -v xdotool > /dev/null; then
    DISPLAY=:$display xdotool key "$key"
    sleep "$seconds"
  fi
  python3 - "$frame/Xvfb_screen0" "$picture" << 'PYTHON'
import struct, sys, zlib
data = open(sys.argv[1], 'rb').read()
head = struct.unpack('>25I', data[:100])  # an XWD header
width, height, line, colors = head[4], head[5], head[12], head[19]
start = head[0] + 12 * colors
def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
rows = bytearray()
for y in range(height):
    row = data[start + y * line:start + y * line + 4 * width]
    rgb = bytearray(3 * width)
    rgb[0::3], rgb[1::3], rgb[2::3] = row[2::4], row[1::4], row[0::4]
    rows += b'\0' + rgb
with open(sys.argv[2], 'wb') as png:
    png.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 2, 0, 0, 0)) +
              chunk(b'IDAT', zlib.compress(bytes(rows), 6)) + chunk(b'IEND', b''))
with open(sys.argv[2] + '.raw', 'wb') as raw:
    raw.write(rows)
PYTHON
  kill "$viewer" "$server" 2> /dev/null
  wait "$viewer" "$server" 2> /dev/null
  rm -rf -- "$frame"
}

# pair VIEWER FILE COMMAND...: the picture with the file against that of an empty scene.
pair() {
  local viewer=$1 file=$2
  shift 2
  shoot "${viewer}_$file.png" "$@"
  python3 - "${viewer}_$file.png.raw" "${viewer}_nothing.png.raw" << 'PYTHON' && return
import sys
a, b = (open(name, 'rb').read() for name in sys.argv[1:3])
share = sum(a[i:i + 3] != b[i:i + 3] for i in range(1, min(len(a), len(b)) - 3, 3)) / (len(a) / 3)
print(f'{sys.argv[1][:-8]}: {100 * share:.1f} % of the screen')
sys.exit(share < 0.01)
PYTHON
  failures=$((failures + 1))
}

has() { command -v "$1" > /dev/null && [[ " ${VIEWERS-pcl_viewer meshlab CloudCompare paraview} " = *" $1 "* ]]; }

# The empty scene: one point for pcl_viewer, which opens nothing without a file.
printf 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nDATA ascii\n0 0 0\n' > nothing.pcd
if has pcl_viewer; then
  shoot pcl_viewer_nothing.png pcl_viewer nothing.pcd
  for file in surface.pcd splats.pcd; do pair pcl_viewer $file pcl_viewer -ps 3 $file; done
fi
if has meshlab; then
  shoot meshlab_nothing.png meshlab
  for file in surface.ply splats.ply mesh.ply mesh.stl; do pair meshlab $file meshlab $file; done
fi
if has CloudCompare; then
  shoot CloudCompare_nothing.png CloudCompare
  for file in surface.ply surface.pcd splats.ply mesh.ply mesh.obj; do pair CloudCompare $file CloudCompare $file; done
fi
if has paraview; then
  shoot paraview_nothing.png paraview
  for file in surface.vtp splats.vtp curved.vtp mesh.vtp mesh.ply; do pair paraview $file paraview "--data=$PWD/$file"; done
fi
rm -f -- *.raw nothing.pcd
[ "$failures" -eq 0 ] || echo "$failures pairs show nothing"
[ "$failures" -eq 0 ]
