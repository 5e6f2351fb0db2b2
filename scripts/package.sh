#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Debian packages of this folder's tracked files into build/packages and checks them with lintian:
# libpcl-slim0.1, libpcl-slim-dev, pcl-slim-tools, python3-pcl-slim, pcl-slim-doc, and symbols for debuggers. packaging/debian describes them.
#   scripts/package.sh            a second run compiles what has changed
#   JOBS=2 scripts/package.sh     limits the jobs (default: all cores)
# Needs the packages of scripts/setup.sh packages. scripts/package_test.sh installs the result in a fresh system.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

packages=$root/build/packages source=$root/build/packages/source
cd -- "$root"
bash scripts/setup.sh packages
# A new copy each time, so that no file of an earlier one is packaged; times are kept, so that little is compiled again.
rm -rf -- "$source"
mkdir -p -- "$source"
git ls-files -z | tar --null --files-from=- --create | tar --extract --directory "$source"
mv -- "$source/packaging/debian" "$source/debian"
rm -f -- "$packages"/*.deb "$packages"/*.ddeb "$packages"/*.buildinfo "$packages"/*.changes

cd -- "$source"
quietly "Building packages" "$root/build/log/package.log" \
  env builddir=../objects DEB_BUILD_OPTIONS="parallel=${JOBS:-$(nproc)} ${DEB_BUILD_OPTIONS-}" \
  dpkg-buildpackage --build=binary --no-sign --no-pre-clean
quietly "Checking them with lintian" "$root/build/log/lintian.log" \
  lintian --allow-root --tag-display-limit 0 --fail-on error,warning "$packages"/*.changes
cat -- "$root/build/log/lintian.log"
du -h "$packages"/*.deb | sed "s|$root/||"
