#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds a wheel of the Python package for a release of Debian, installs it in a fresh, minimal system of that release by the
# commands of docs/python.md, and runs the page's first example and the package's tests there.
#   scripts/wheel_test.sh RELEASE [DIR]    as bookworm or trixie; DIR keeps the systems, and the wheel in DIR/wheel
#   JOBS=2 scripts/wheel_test.sh trixie    limits the jobs (default: all cores)
# On that release itself the wheel is scripts/wheel.sh's; for another it is built in a second system, where a second run
# in DIR compiles what has changed. Needs root and debootstrap, which scripts/setup.sh nightly installs.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
# shellcheck source=scripts/minimal_debian.sh
source "$root/scripts/minimal_debian.sh"

case ${1-} in
  -h | --help) sed -n 's/^# \{0,1\}//; 3,8p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
  echo "wheel_test.sh takes a release, as trixie, and a folder at most" >&2
  exit 2
fi
release=$1 log=$root/build/log
if [ $# -eq 2 ]; then
  mkdir -p -- "$2"
  work=$(cd -- "$2" && pwd)
else
  work=$(mktemp -d -t "pcl_slim_wheel_$release.XXXXXX")
  finish() {
    local system
    for system in "$work/build" "$work/fresh"; do
      [ ! -e "$system" ] || remove_debian "$system" || return
    done
    rm -rf -- "$work"
  }
  trap finish EXIT
fi
rm -rf -- "$work/wheel"
mkdir -p -- "$work/wheel"

# In the system of that release. scripts/wheel.sh takes the modules of build/release; nothing else is compiled. Which of
# the two builders of wheels there is depends on the release.
build_in_system() {
  local source=/usr/src/pcl_slim builder=python3-skbuild
  [ -e "$work/build/etc/debian_version" ] || make_debian "$release" "$work/build"
  put_source "$work/build" "$source"
  in_debian "$work/build" sh -c "apt-cache show $builder >/dev/null 2>&1" || builder=python3-scikit-build-core
  in_debian "$work/build" apt-get install -y --no-remove cmake ninja-build g++ pkg-config git libeigen3-dev libhwy-dev \
    libpng-dev zlib1g-dev libtbb-dev pybind11-dev python3-dev python3-numpy python3-build python3-wheel python3-venv \
    python3-setuptools "$builder"
  in_debian "$work/build" env --chdir="$source" cmake --preset release -DPCL_SLIM_BUILD_FILTERS=OFF \
    -DPCL_SLIM_BUILD_MPI=OFF -DPCL_SLIM_BUILD_PYTHON=OFF -DBUILD_TESTING=OFF
  in_debian "$work/build" env --chdir="$source" cmake --build build/release --parallel "${JOBS:-$(nproc)}"
  in_debian "$work/build" --mount "$work/wheel" /wheel env --chdir="$source" JOBS="${JOBS:-$(nproc)}" \
    scripts/wheel.sh /wheel
}

# A new system has nothing but the essential packages, so what the page does not name is missing.
make_fresh() {
  [ ! -e "$work/fresh" ] || remove_debian "$work/fresh"
  make_debian "$release" "$work/fresh"
  mkdir -- "$work/fresh/test"
  cp -r -- "$root/python/tests" "$root/python/examples" "$work/fresh/test"
  mkdir -- "$work/fresh/test/wheel_out"
  cp -- "$work"/wheel/*.whl "$work/fresh/test/wheel_out"
  page_block "$root/docs/python.md" "" "scripts/wheel_test.sh" | sed 's/^sudo apt-get install/apt-get install -y/' >"$work/fresh/test/install.sh"
  page_block "$root/docs/python.md" python >"$work/fresh/test/example.py"
  [ -s "$work/fresh/test/install.sh" ] && [ -s "$work/fresh/test/example.py" ]
}

# step WHAT COMMAND...: in the fresh system, in its folder /test.
step() {
  quietly "$1" "$log/wheel_test.log" in_debian "$work/fresh" env --chdir=/test PYTHONDONTWRITEBYTECODE=1 "${@:2}"
}

if [ "$release" = "$(. /etc/os-release && echo "$VERSION_CODENAME")" ]; then
  quietly "Building a wheel for $release" "$log/wheel_build.log" bash "$root/scripts/wheel.sh" "$work/wheel"
else
  quietly "Building a wheel for $release" "$log/wheel_build.log" build_in_system
fi
quietly "Making a fresh $release" "$log/wheel_fresh.log" make_fresh
step "Installing it as docs/python.md says" sh -e install.sh
step "Running the page's first example" env/bin/python example.py
cat -- "$log/wheel_test.log"
step "Installing pytest" apt-get install -y python3-pytest
step "Testing it" env/bin/python -m pytest -q -p no:cacheprovider tests
tail -n 1 -- "$log/wheel_test.log"
step "The tested package is the wheel's" sh -c 'env/bin/python -c "import pcl_slim; print(pcl_slim.__file__)" | grep ^/test/env/'
echo "Debian $(cat "$work/fresh/etc/debian_version"): $(basename -- "$work"/wheel/*.whl) works"
