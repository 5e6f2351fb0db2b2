#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds a wheel of the Python package, without a network, installs it in a fresh virtual environment and runs the first
# example of docs/python.md and tests there.
#   scripts/wheel.sh [OUT]     OUT: a folder for the wheel (wheel_out)
# The modules are those of build/release, if they are built; else they are compiled, which takes some minutes. Needs
# (Debian 12): pybind11-dev python3-dev python3-numpy python3-skbuild python3-build python3-wheel python3-venv
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

out=${1-wheel_out}
python=/usr/bin/python3 # the distribution's, which its packages are of
[ -x "$python" ] || python=python3
work=$root/build/wheel
rm -rf -- "$work"
mkdir -p -- "$work" "$out"
out=$(cd -- "$out" && pwd)

if ! "$python" -c "import build, numpy, wheel, setuptools" 2>/dev/null ||
  ! "$python" -c "import skbuild" 2>/dev/null && ! "$python" -c "import scikit_build_core" 2>/dev/null; then
  echo "The tools of wheels are missing. Run: sudo apt-get install pybind11-dev python3-dev python3-numpy" \
    "python3-skbuild python3-build python3-wheel python3-venv" >&2
  exit 1
fi

if [ -e "$root/build/release/modules/web/libpcl_slim_web.a" ]; then
  quietly "Installing the modules" "$work/install.log" \
    cmake --install "$root/build/release" --prefix "$work/prefix" --component development
  export PCL_SLIM_PREFIX=$work/prefix
fi
# The build writes beside its sources: of a copy. setup.py reads the version and README.md above it.
mkdir -p "$work/source/modules/core/include/pcl_slim"
cp -r "$root/python" "$root/cmake" "$root/README.md" "$work/source"
cp "$root/modules/core/include/pcl_slim/version.h" "$work/source/modules/core/include/pcl_slim"
[ -n "${PCL_SLIM_PREFIX-}" ] || cp -r "$root/modules" "$root/CMakeLists.txt" "$root/package.xml" "$root/web" \
  "$root/visualization" "$root/tests" "$root/LICENSE" "$work/source"
quietly "Building the wheel" "$work/build.log" \
  env CMAKE_BUILD_PARALLEL_LEVEL="${JOBS:-$(nproc)}" "$python" -m build --no-isolation --skip-dependency-check --wheel \
  --outdir "$work/dist" "$work/source/python"
made=("$work"/dist/pcl_slim-*.whl)
wheel=$out/$(basename -- "${made[0]}")
cp -- "${made[0]}" "$wheel"

quietly "Making an environment" "$work/venv.log" "$python" -m venv --system-site-packages "$work/venv"
quietly "Installing the wheel" "$work/pip.log" \
  "$work/venv/bin/python" -m pip install --no-index --no-deps --no-warn-script-location "$wheel"
cd -- "$work"
page_block "$root/docs/python.md" python >"$work/example.py"
quietly "Running the first example" "$work/example.log" env -u PYTHONPATH "$work/venv/bin/python" "$work/example.py"
if "$work/venv/bin/python" -c "import pytest" 2>/dev/null; then
  quietly "Testing it" "$work/test.log" env -u PYTHONPATH -u PCL_SLIM_BIN PYTHONDONTWRITEBYTECODE=1 \
    "$work/venv/bin/python" -m pytest -q -p no:cacheprovider "$root"/python/tests/test_{truth,package,programs}.py
fi
"$work/venv/bin/python" -c "import pcl_slim; print(pcl_slim.__file__)" | grep -q "^$work/venv/"
printf '\nWheel     %s   (%s bytes)\n' "$wheel" "$(stat -c %s "$wheel")"
