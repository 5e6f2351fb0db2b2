#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The pictures of docs/python.md, by the examples: pictures.sh PACKAGE_DIR OUT. Needs ImageMagick.
set -euo pipefail
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
export PYTHONPATH=$1 PYTHONDONTWRITEBYTECODE=1
out=$2 work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
python=/usr/bin/python3
[ -x "$python" ] || python=python3

"$python" "$here/01_fit.py" "$work/fit.png"
"$python" "$here/03_compare.py" "$work/compare.png"
"$python" "$here/04_lines.py" "$work/lines.png"
"$python" "$here/05_mesh.py" "$work/mesh.png" "$work/vase.obj"
"$python" "$here/06_splats.py" "$work/splats.png"
small=(-define png:color-type=2 -define png:compression-level=9 -define "png:exclude-chunks=date,time")
convert "$work/fit.png" "${small[@]}" "$out/python_fit.png"
montage "$work/compare.png" "$work/lines.png" "$work/mesh.png" "$work/splats.png" -tile 4x -geometry +0+0 \
  "${small[@]}" "$out/python_more.png"
