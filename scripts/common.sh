# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# shellcheck disable=SC2034
# Sourced by the other scripts.

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

# quietly WHAT LOG COMMAND...: runs a command with its output in a file, shown only if it fails.
quietly() {
  local what=$1 log=$2 begin=$SECONDS
  shift 2
  mkdir -p -- "$(dirname -- "$log")"
  printf '%s ...' "$what"
  if "$@" >"$log" 2>&1; then
    printf ' done in %d s\n' $((SECONDS - begin))
  else
    local status=$?
    printf ' failed\n'
    tail -n 60 -- "$log"
    printf '%s failed; the whole log is %s\n' "$what" "$log" >&2
    return $status
  fi
}

# configure CMAKE_ARGUMENT...: the release preset.
configure() {
  quietly "Configuring" "$root/build/log/configure.log" \
    cmake -S "$root" --preset release "$@"
}

# build TARGET...: of the release preset; no target means everything. JOBS limits the jobs.
build() {
  local jobs=${JOBS:-$(nproc)} what="Building"
  [ -e "$root/build/release/bin/pcl_slim_fit" ] || what="Building, some minutes this first time"
  quietly "$what" "$root/build/log/build.log" \
    cmake --build "$root/build/release" --parallel "$jobs" ${1:+--target "$@"}
}

# page_block PAGE LANGUAGE [BEFORE]: the first block of code in this language of a page after a line that contains BEFORE.
page_block() {
  awk -v fence="\`\`\`$2" -v before="${3-}" 'index($0, before) { after = 1 }
    after && !inside && $0 == fence { inside = 1; next } inside && /^```/ { exit } inside' "$1"
}
