# SPDX-License-Identifier: BSD-3-Clause
# What the programs' tests share. A test sources it with its own arguments (programs' folder, an
# empty folder to work in, folder of real scans, which may be empty) and ends with `finish`.
# Sets bin, work, data and docs and stands in the empty folder $work; with `program` set, expect
# runs that program, otherwise the one named by its third argument.
set -uo pipefail
bin=$1
work=$2/run
data=${3-}
docs=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../../docs" && pwd)
rm -rf -- "$work"
mkdir -p -- "$work"
cd -- "$work" || exit 1
failures=0

complain() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# expect STATUS WORD [PROGRAM] ARGS...: the status; on success nothing on stderr, on failure one line
# that holds WORD. Leaves out.txt and err.txt.
expect() {
  local status=$1 word=$2 got=0
  shift 2
  if [ -n "${program-}" ]; then
    "$bin/$program" "$@" > out.txt 2> err.txt || got=$?
  else
    "$bin/$1" "${@:2}" > out.txt 2> err.txt || got=$?
  fi
  [ "$got" -eq "$status" ] || complain "exit $got instead of $status: $* ($(head -c 300 err.txt))"
  if [ "$status" -eq 0 ]; then
    [ ! -s err.txt ] || complain "stderr not empty: $* ($(head -c 300 err.txt))"
  else
    [ "$(wc -l < err.txt)" -eq 1 ] || complain "stderr is not one line: $* ($(head -c 300 err.txt))"
    grep -q -- "$word" err.txt || complain "no '$word' in: $(cat err.txt)"
  fi
}

absent() {
  for file in "$@"; do [ ! -e "$file" ] || complain "$file was left behind"; done
}

same() { cmp -s -- "$1" "$2" || complain "$1 and $2 differ"; }
differ() { ! cmp -s -- "$1" "$2" || complain "$1 and $2 are the same"; }

# header FILE LINE: a line of a PCD's or PLY's header.
header() { grep -aq "^$2\$" "$1" || complain "$1 has no header line '$2'"; }

# value REPORT KEY: a number or word of a report.
value() { sed -n "s/.*\"$2\": \([^,]*\),*/\1/p" "$1" | head -n 1; }

# documented PROGRAM [PAGE]: the help ends well, and docs/PAGE.md has each line of its table.
documented() {
  local page=$docs/${2-$1}.md line
  "$bin/$1" -h > out.txt 2> err.txt || complain "$1 -h fails"
  "$bin/$1" --help-markdown > out.txt 2> err.txt || complain "$1 --help-markdown fails"
  while IFS= read -r line; do
    case $line in '| `-'*) grep -qF -- "$line" "$page" || complain "$page lacks: $line" ;; esac
  done < out.txt
}

# fails_cleanly SCAN OUT: folders that do not exist, or that stand where a file should: status 1 and
# nothing left.
fails_cleanly() {
  expect 1 'does not exist' "$1" "nowhere/$2"
  expect 1 'folder' "$1" folder.pcd
  expect 1 'does not exist' "$1" "$2" -json nowhere/report.json
  absent "$2" nowhere
  [ -z "$(find . -name '*.part')" ] || complain "temporary files were left behind"
}

# survives_one_point OUT: one.pcd is done or refused.
survives_one_point() {
  local got=0
  "$bin/$program" one.pcd "$1" > out.txt 2> err.txt || got=$?
  [ "$got" -le 1 ] || complain "one point: exit $got"
}

# stops SCAN OUT: Ctrl-C gives status 130 and leaves nothing, unless the work was done before.
stops() {
  local pid got=0
  "$bin/$program" "$1" "$2" -quiet 1 2> err.txt &
  pid=$!
  sleep 0.05
  kill -INT $pid
  wait $pid || got=$?
  if [ "$got" -ne 0 ]; then
    [ "$got" -eq 130 ] || complain "stopped: exit $got"
    absent "$2"
  fi
}

finish() {
  cd / && rm -rf -- "$work"
  [ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
  echo "all passed"
}
