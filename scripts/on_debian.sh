#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the last commit in a fresh, minimal Debian of a release and runs the README's two commands there. Where that
# Debian has LASzip, a .laz that its Python module writes is smoothed, too.
#   scripts/on_debian.sh RELEASE [DIR]             as bookworm, trixie or forky; the system is kept in DIR,
#                                                  where a second run compiles what has changed
#   COMPILER=clang-19 scripts/on_debian.sh trixie  that compiler of the release, or gcc-13; all is compiled, no test is run
#   JOBS=2 scripts/on_debian.sh trixie             limits the jobs (default: all cores)
# Needs root and debootstrap, which scripts/setup.sh nightly installs.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
# shellcheck source=scripts/minimal_debian.sh
source "$root/scripts/minimal_debian.sh"

case ${1-} in
  -h | --help) sed -n 's/^# \{0,1\}//; 3,9p' "${BASH_SOURCE[0]}"; exit 0 ;;
esac
if [ $# -lt 1 ] || [ $# -gt 2 ]; then
  echo "on_debian.sh takes a release, as trixie, and a folder at most" >&2
  exit 2
fi
release=$1 source=/usr/src/pcl_slim # in the system
if [ $# -eq 2 ]; then
  system=$2
else
  system=$(mktemp -d -t "pcl_slim_$release.XXXXXX")
  trap 'remove_debian "$system"' EXIT
fi

in_source() { # COMMAND...: run in the project's folder of the system
  in_debian "$system" env --chdir="$source" JOBS="${JOBS:-$(nproc)}" "$@"
}

# What laspy writes is read by this project through the same library, but written by other hands.
smooth_laz() {
  in_source apt-get install -y --no-remove -qq python3-laspy python3-laszip python3-numpy >/dev/null
  in_source build/release/bin/pcl_slim_smooth demo_out/scan.pcd demo_out/scan.las -quiet
  in_source python3 -c '
import laspy
laspy.read("demo_out/scan.las").write("demo_out/scan.laz", laz_backend=laspy.LazBackend.Laszip)'
  in_source build/release/bin/pcl_slim_smooth demo_out/scan.laz demo_out/from_laz.pcd
  in_source build/release/bin/pcl_slim_smooth demo_out/scan.las demo_out/from_las.pcd -quiet
  in_source cmp demo_out/from_laz.pcd demo_out/from_las.pcd
  echo "A .laz and the .las with the same points are smoothed to the same bytes"
}

printf 'Debian %s in %s\n' "$release" "$system"
[ -e "$system/etc/debian_version" ] || make_debian "$release" "$system"
put_source "$system" "$source"

if [ -n "${COMPILER-}" ]; then
  in_source scripts/setup.sh
  case $COMPILER in
    clang*) # with OpenMP's header, which Eigen includes with PCL's flags
      packages=("$COMPILER" "${COMPILER/clang/libomp}-dev") cxx=${COMPILER/clang/clang++}
      ;;
    *) packages=("${COMPILER/gcc/g++}") cxx=${COMPILER/gcc/g++} ;;
  esac
  in_source apt-get install -y --no-remove -qq "${packages[@]}" >/dev/null
  in_source cmake --preset release -DCMAKE_C_COMPILER="$COMPILER" -DCMAKE_CXX_COMPILER="$cxx" \
    -DPCL_SLIM_BUILD_EXAMPLES=ON
  in_source cmake --build build/release --parallel "${JOBS:-$(nproc)}"
  echo "Debian $(cat "$system/etc/debian_version"): all compiles with $COMPILER"
  exit 0
fi

in_source scripts/demo.sh
in_source scripts/test.sh
if in_source sh -c 'apt-cache show python3-laszip >/dev/null 2>&1 && dpkg -s liblaszip-dev >/dev/null 2>&1'; then
  smooth_laz
fi
echo "Debian $(cat "$system/etc/debian_version"): the demo and all tests run"
