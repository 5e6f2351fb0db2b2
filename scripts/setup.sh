#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian or Ubuntu packages that building and testing need. Does nothing when they
# are there; without root rights it names the command to run and exits 1.
#   scripts/setup.sh        what the README's commands need
#   scripts/setup.sh ci     what .ci/run needs beside it: clang, clang-tidy, clang-format, and what builds the site
#   scripts/setup.sh packages  what scripts/package.sh, package_test.sh and abi.sh need
#   scripts/setup.sh nightly  what .ci/nightly needs: all of that, a browser that pages are tested in, tools of Python wheels
set -euo pipefail

packages=(
  cmake ninja-build g++ pkg-config
  libpcl-dev libeigen3-dev libhwy-dev libpng-dev zlib1g-dev libtbb-dev nlohmann-json3-dev libgtest-dev python3
)
case ${1-} in ci | nightly) packages+=(git clang clang-tidy clang-format libclang-rt-14-dev doxygen python3-sphinx furo python3-myst-parser) ;; esac
case ${1-} in packages | nightly) packages+=(git abigail-tools debhelper debootstrap dh-python dpkg-dev lintian pybind11-dev python3-dev) ;; esac
if [ "${1-}" = nightly ]; then
  packages+=(chromium python3-numpy python3-pytest)
  packages+=(python3-skbuild python3-build python3-wheel python3-venv)
  command -v node >/dev/null || packages+=(nodejs)
fi
# Benchmarks, ROS's own check of package.xml in the tests, the X server that windows are tested on, and the Python
# package: nothing fails without them.
optional=(libnanoflann-dev python3-catkin-pkg xvfb xauth libgl1-mesa-dri)
optional+=(pybind11-dev python3-dev python3-numpy python3-pytest)

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "This is not Debian or Ubuntu: install what these packages hold, then run cmake by hand:" >&2
  echo "  ${packages[*]}" >&2
  exit 1
fi

# Ubuntu 22.04 has an older Google Highway than the kernels need.
highway=$(apt-cache show libhwy-dev 2>/dev/null | awk '$1 == "Version:" { print $2; exit }')
if [ -n "$highway" ] && dpkg --compare-versions "$highway" lt 1.0.3; then
  echo "This system's Google Highway (libhwy-dev) is $highway, and 1.0.3 is needed: use Debian 12, Ubuntu 24.04 or later" >&2
  exit 1
fi

# LASzip, for .laz, is in Debian from version 13 on.
apt-cache show liblaszip-dev >/dev/null 2>&1 && optional+=(liblaszip-dev)
# The workspace of ROS's nodes.
colcon=(colcon python3-colcon-ros python3-colcon-package-information ament-cmake)
case ${1-} in ci | nightly) apt-cache show "${colcon[@]}" >/dev/null 2>&1 && optional+=("${colcon[@]}") ;; esac

installed() { # PACKAGE
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing=()
needed=0
for package in "${packages[@]}" "${optional[@]}"; do
  [ "$package" != "${optional[0]}" ] || needed=${#missing[@]}
  installed "$package" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

install=(apt-get install -y --no-remove --no-install-recommends "${missing[@]}")
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    as_root=(sudo)
  elif [ "$needed" -eq 0 ]; then
    exit 0
  else
    echo "Packages are missing. Run this, then this script again:" >&2
    echo "  sudo apt-get update && sudo ${install[*]}" >&2
    exit 1
  fi
fi

log=$(mktemp -t pcl_slim_setup.XXXXXX)
begin=$SECONDS
echo "Installing ${missing[*]}"
if ! { ${as_root[@]+"${as_root[@]}"} apt-get update &&
  ${as_root[@]+"${as_root[@]}"} env DEBIAN_FRONTEND=noninteractive "${install[@]}"; } >"$log" 2>&1; then
  if [ "$needed" -eq 0 ]; then
    echo "They did not install (log: $log); going on, as they are optional"
    exit 0
  fi
  tail -n 40 "$log" >&2
  echo "Installing packages failed; the whole log is $log" >&2
  exit 1
fi
rm -f "$log"
echo "Installed in $((SECONDS - begin)) s"
