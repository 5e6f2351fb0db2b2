#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the packages of build/packages in a fresh, minimal Debian by apt, as their users do: fits a scan with the programs,
# runs the first example of docs/python.md, builds README's example against the development package, and removes them again.
#   scripts/package_test.sh [RELEASE]    RELEASE: bookworm, trixie ...; that of this system if not given
#   KEEP=1 scripts/package_test.sh       leaves the system in build/debian/RELEASE_packages
# Needs root, and packages that scripts/package.sh has built on the same release.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
# shellcheck source=scripts/minimal_debian.sh
source "$root/scripts/minimal_debian.sh"

release=${1-$(. /etc/os-release && echo "$VERSION_CODENAME")}
system=$root/build/debian/${release}_packages
export DEBIAN_CACHE=${DEBIAN_CACHE-$root/build/debian/${release}_cache}
packages=("$root"/build/packages/*.deb)
if [ ! -e "${packages[0]}" ]; then
  echo "There are no packages in build/packages: scripts/package.sh makes them" >&2
  exit 2
fi
bash "$root/scripts/setup.sh" packages

finish() {
  if [ -n "${KEEP-}" ]; then
    echo "The system is in $system"
  elif [ -e "$system" ]; then
    remove_debian "$system"
  fi
}
trap finish EXIT

# step WHAT COMMAND...: in the system, in its folder /test, which has the packages.
step() {
  quietly "$1" "$root/build/log/package_test.log" in_debian "$system" env --chdir=/test "${@:2}"
}

[ ! -e "$system" ] || remove_debian "$system"
quietly "Making a fresh $release" "$root/build/log/package_test.log" make_debian "$release" "$system"
mkdir -- "$system/test"
cp -- "${packages[@]}" "$system/test"

step "Installing pcl-slim-tools" sh -c 'apt-get install -y ./pcl-slim-tools_*.deb ./libpcl-slim0.1_*.deb'
step "Fitting and drawing a scan" sh -c '
  set -e
  pcl_slim_demo_scan scan.pcd -points 20000
  pcl_slim_fit scan.pcd surface.slim
  pcl_slim_render surface.slim surface.png
  pcl_slim_mesh surface.slim mesh.ply
  test -s surface.png && test -s mesh.ply'
step "Every program starts" sh -c '
  set -e
  for program in $(dpkg -L pcl-slim-tools | grep ^/usr/bin/); do $program -help >/dev/null || $program --help >/dev/null; done'

# README's example: the blocks of its section, in a function that has a cloud.
block() { # LANGUAGE
  awk -v language="$1" '/^## / { here = /Use it from C/ } here && /^```/ { inside = $0 == "```" language; next } inside' \
    "$root/README.md"
}
mkdir -- "$system/test/mine"
{
  echo 'cmake_minimum_required(VERSION 3.22)'
  echo 'project(mine LANGUAGES CXX)'
  block cmake
} >"$system/test/mine/CMakeLists.txt"
{
  echo '#include <iostream>'
  echo '#include <pcl/io/pcd_io.h>'
  block cpp | grep '^#include'
  echo 'int main() {'
  echo '  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);'
  echo '  if (pcl::io::loadPCDFile("scan.pcd", *cloud)) return 1;'
  block cpp | grep -v '^#include'
  echo '  std::cout << surface.size() << " surfels\n";'
  echo '  return surface.empty();'
  echo '}'
} >"$system/test/mine/mine.cpp"
step "Installing libpcl-slim-dev and a compiler" sh -c 'apt-get install -y ./libpcl-slim-dev_*.deb cmake g++ make pkg-config'
step "Building README's example" sh -c 'cmake -S mine -B mine/build && cmake --build mine/build'
step "Running it" mine/build/mine
cat -- "$root/build/log/package_test.log"

page_block "$root/docs/python.md" python >"$system/test/example.py"
step "Installing python3-pcl-slim" sh -c 'apt-get install -y ./python3-pcl-slim_*.deb'
step "Running the first example of docs/python.md" python3 example.py
cat -- "$root/build/log/package_test.log"

step "Installing pcl-slim-doc" sh -c 'apt-get install -y ./pcl-slim-doc_*.deb && test -s /usr/share/doc/pcl-slim-doc/docs/tutorial.md'
step "Removing all" sh -c '
  set -e
  apt-get purge -y pcl-slim-tools libpcl-slim0.1 libpcl-slim-dev python3-pcl-slim pcl-slim-doc
  ! find /usr /etc /var/lib -path /var/lib/apt -prune -o -path "*pcl?slim*" -print | grep .'
echo "The packages work in a fresh $release"
