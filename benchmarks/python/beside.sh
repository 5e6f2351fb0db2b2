#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes the table "beside Open3D and PCL" of docs/python.md: normals, smoothing and curvature of six scans whose surface is
# known, by the Python package, by Open3D 0.19 and by PCL's programs, all in a system of Debian 13.
#   benchmarks/python/beside.sh DATA OUT    DATA: a folder of scans (benchmarks/README.md names them); OUT gets table.md
# OUT keeps the scans, the results, the wheel, and the systems: Open3D and PCL's programs in OUT/debian13, 3 GB. What OUT
# has is not made again. Needs root and debootstrap. BIN_DIR: a folder of built benchmarks; then nothing is built.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/../../scripts/common.sh"
# shellcheck source=scripts/minimal_debian.sh
source "$root/scripts/minimal_debian.sh"
if [ $# -ne 2 ] || [ ! -d "$1" ]; then
  echo "usage: benchmarks/python/beside.sh DATA OUT, DATA a folder of scans" >&2
  exit 2
fi
mkdir -p -- "$2/log" "$2/runs"
data=$(cd -- "$1" && pwd) out=$(cd -- "$2" && pwd)
system=$out/debian13 here=$root/benchmarks/python
python=/usr/bin/python3 # the distribution's, which has its NumPy
[ -x "$python" ] || python=python3

if [ -n "${BIN_DIR-}" ]; then
  bin=$(cd -- "$BIN_DIR" && pwd)
else
  bash "$root/scripts/setup.sh"
  configure -DPCL_SLIM_BUILD_BENCHMARKS=ON
  build exact_surface
  bin=$root/build/release/bin
fi
set -- "$out"/trixie/wheel/*.whl
[ -e "$1" ] || bash "$root/scripts/wheel_test.sh" trixie "$out/trixie"
[ -d "$system/usr" ] || quietly "Debian 13" "$out/log/debian.log" make_debian trixie "$system"
[ -e "$system/usr/bin/pcl_mls_smoothing" ] ||
  quietly "Open3D and PCL's programs" "$out/log/packages.log" in_debian "$system" apt-get install -y -q \
    --no-install-recommends python3-open3d pcl-tools python3-venv python3-numpy libtbb12 libhwy1 libpng16-16
install_wheel() {
  in_debian "$system" python3 -m venv --system-site-packages /env
  in_debian "$system" --mount "$out/trixie/wheel" /wheel sh -c '/env/bin/pip install --no-index /wheel/pcl_slim-*.whl'
}
[ -d "$system/env" ] || quietly "The wheel" "$out/log/wheel.log" install_wheel

# shellcheck disable=SC2016
"$python" "$here/beside.py" "$bin/exact_surface" "$data" "$out/runs" bash -c '
  source "$0"
  in_debian "$1" --mount "$2" /runs --mount "$3" /methods env --chdir=/runs /env/bin/python /methods/methods.py "${@:4}"' \
  "$root/scripts/minimal_debian.sh" "$system" "$out/runs" "$here"
mv -- "$out/runs/table.md" "$out/table.md"
cat -- "$out/table.md"
