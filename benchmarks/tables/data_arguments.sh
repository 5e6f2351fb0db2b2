# SPDX-License-Identifier: BSD-3-Clause
# For scripts that are called with DATA_FOLDER OUT_FOLDER ...: sourced with their own arguments, sets
# data, out and bin (build/release/bin, or BIN_DIR), makes the output folder, and ends the script with
# one line and status 2 where something is missing. Needs: here, their folder; program, one of bin's.
script=$(basename -- "$0")

usage() {
  echo "$1" >&2
  exit 2
}
case ${1-} in
  # The comment at the head of a script is its help.
  -h | --help) sed -n '3,/^[^#]/{/^#/s/^# \{0,1\}//p}' "$0"; exit 0 ;;
esac
[ $# -ge 2 ] || usage "$script wants DATA_FOLDER and OUT_FOLDER; see $script -h"
data=$1
out=$2
bin=${BIN_DIR:-$here/../../build/release/bin}
[ -d "$data" ] || usage "$data is not a folder: give one that holds .pcd and .ply scans"
[ -x "$bin/$program" ] || usage "no $program in $bin: build it, or name its folder in BIN_DIR"
command -v python3 >/dev/null || usage "python3 is missing: install it (apt install python3)"
mkdir -p -- "$out" || usage "$out cannot be made: name another folder"
