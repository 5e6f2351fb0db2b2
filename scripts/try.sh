#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From a change to its tests in seconds: builds the tests of one module, or of filters, in the dev preset and runs them.
#   scripts/try.sh cloud                    all tests of modules/cloud
#   scripts/try.sh cloud 'SharedNoise*'     those whose names match, as --gtest_filter
#   scripts/try.sh filters 'LasFile*'       the classes that take PCL clouds, and files
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

case ${1--h} in
  -h | --help) sed -n 's/^# \{0,1\}//; 3,6p' "${BASH_SOURCE[0]}"; exit 0 ;;
  filters) target=pcl_slim_filters_tests ;;
  *) target=pcl_slim_unit_$1 ;;
esac
build=$root/build/dev
[ -e "$build/build.ninja" ] || quietly "Configuring" "$root/build/log/dev_configure.log" cmake -S "$root" --preset dev
if ! quietly "Building $target" "$root/build/log/dev_build.log" \
  cmake --build "$build" --parallel "${JOBS:-$(nproc)}" --target "$target"; then
  echo "If there are no such tests: modules/ and 'filters' are the names to choose from" >&2
  exit 1
fi
"$build/bin/$target" --gtest_brief=1 --gtest_filter="${2:-*}"
