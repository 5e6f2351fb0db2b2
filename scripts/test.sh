#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, builds the release preset and runs every test.
#   scripts/test.sh [CMAKE_ARGUMENT...]     arguments go to cmake, as -DPCL_SLIM_WARNINGS_AS_ERRORS=ON
#   JOBS=2 scripts/test.sh                  limits the jobs (default: all cores)
set -euo pipefail
# shellcheck source=scripts/common.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

bash "$root/scripts/setup.sh"
configure -DBUILD_TESTING=ON -DPCL_SLIM_BUILD_TESTS=ON -DPCL_SLIM_BUILD_EXAMPLES=ON "$@"
build

log=$root/build/log/test.log
printf 'Testing ...'
begin=$SECONDS
if ! ctest --test-dir "$root/build/release" --output-on-failure --no-tests=error \
  --parallel "${JOBS:-$(nproc)}" >"$log" 2>&1; then
  echo
  grep -v -E 'Passed +[0-9.]+ sec|^ +Start ' "$log" || true
  echo "Tests failed; the whole log is $log" >&2
  exit 1
fi
printf ' done in %d s\n' $((SECONDS - begin))
grep -E '\*\*\*(Skipped|Not Run)' "$log" || true
# Programs of GoogleTest run many tests each, and skip some.
details=$root/build/release/Testing/Temporary/LastTest.log
grep -h -E '^\[  SKIPPED \] [^ ]+$' "$details" | sort -u || true
sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' "$details" |
  awk '{ sum += $1 } END { printf "%d tests of GoogleTest passed in %d programs\n", sum, NR }'
grep -E 'tests passed' "$log"
