#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and runs the consumer with pkg-config's flags: pkg_config.sh CXX PREFIX LIBDIR FILTERS
set -euo pipefail
command -v pkg-config >/dev/null || exit 77
cxx=$1 prefix=$2 source=$(dirname -- "${BASH_SOURCE[0]}")/main.cpp
export PKG_CONFIG_PATH=$prefix/$3/pkgconfig
package=pcl_slim
define=()
if [ "$4" = ON ]; then
  package=pcl_slim_filters
  define=(-DCONSUMER_USES_FILTERS)
fi
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
read -ra flags <<<"$(pkg-config --cflags --libs "$package")"
"$cxx" -std=c++17 -O1 "${define[@]}" "$source" -o "$folder/consumer" "${flags[@]}"
LD_LIBRARY_PATH=$prefix/$3 "$folder/consumer"
