#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Dumps the binary interface of the libraries that scripts/package.sh has built, as libabigail's XML, into
# build/abi/VERSION/LIBRARY.abi.xz, and compares it with that of an earlier release.
#   scripts/abi.sh               dumps: the files that are published with the packages of a release
#   scripts/abi.sh FOLDER        also compares with FOLDER, the dumps of a release of the same major and minor version;
#                                exits 1 where names are gone or types differ, so that a program linked against that
#                                release may fail with these libraries; additions are compatible
# Types count that the installed headers define; calls between the libraries (PCL_SLIM_PRIVATE_...) do not.
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

objects=$root/build/packages/objects
if [ ! -d "$objects" ]; then
  echo "There are no libraries in build/packages: scripts/package.sh makes them" >&2
  exit 2
fi
bash "$root/scripts/setup.sh" packages
version=$(sed -n 's/^#define PCL_SLIM_VERSION "\(.*\)"/\1/p' "$root/modules/core/include/pcl_slim/version.h")
out=$root/build/abi/$version
rm -rf -- "$out"
mkdir -p -- "$out"
printf '[suppress_function]\nsymbol_version_regexp = ^PCL_SLIM_PRIVATE\n[suppress_variable]\nsymbol_version_regexp = ^PCL_SLIM_PRIVATE\n' \
  >"$out/private.ini"
headers=()
for folder in "$root"/modules/*/include "$root/filters/include" "$root/visualization/include"; do
  headers+=(--headers-dir "$folder")
done

changed=0
while read -r library; do
  name=$(basename -- "$library" ".so.$version")
  # No paths of this machine, and in the same order each time: equal interfaces are equal files.
  abidw "${headers[@]}" --drop-private-types --no-comp-dir-path --no-corpus-path --no-show-locs --suppressions "$out/private.ini" \
    --out-file "$out/$name.abi" "$library"
  if [ $# -gt 0 ]; then
    if [ ! -e "$1/$name.abi.xz" ]; then
      echo "$name: new"
    else
      xz --decompress --stdout "$1/$name.abi.xz" >"$out/$name.old.abi"
      status=0
      abidiff --no-added-syms --suppressions "$out/private.ini" "$out/$name.old.abi" "$out/$name.abi" || status=$?
      rm -- "$out/$name.old.abi"
      [ "$status" -eq 0 ] || changed=1
      [ "$status" -ne 0 ] || echo "$name: compatible"
    fi
  fi
  xz --force "$out/$name.abi"
done < <(find "$objects" -name "libpcl_slim_*.so.$version" | sort)
rm -- "$out/private.ini"
for old in ${1+"$1"/*.abi.xz}; do
  [ -e "$out/$(basename -- "$old")" ] || { echo "$(basename -- "$old" .abi.xz): gone" && changed=1; }
done
du -h --total "$out"/*.abi.xz | sed "s|$root/||"
[ "$changed" -eq 0 ] || echo "The binary interface has changed: this needs another minor version (SONAME)" >&2
exit "$changed"
