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
# that contains WORD. Leaves out.txt and err.txt.
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

# badScans SCAN: files that no program can use, made of a good one of 9000 bytes or more; and one
# point alone.
badScans() {
  local xyz='FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1'
  mkdir -p -- folder.pcd
  head -c 9000 "$1" > cut.pcd
  : > empty.pcd
  printf 'VERSION 0.7\nFIELDS a b\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2\n' > fields.pcd
  printf "VERSION 0.7\n$xyz\nWIDTH 0\nHEIGHT 0\nDATA ascii\n" > none.pcd
  printf "VERSION 0.7\n$xyz\nWIDTH 2\nHEIGHT 1\nDATA ascii\nnan nan nan\nnan 1 2\n" > nan.pcd
  printf "VERSION 0.7\n$xyz\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n" > one.pcd
}

# noSurfaces: a line and a hundred equal points, which are no surface.
noSurfaces() {
  local header='VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nHEIGHT 1\nWIDTH'
  { printf "$header 500\nDATA ascii\n"; awk 'BEGIN { for (i = 0; i < 500; ++i) print i, 2 * i, -i / 2 }'; } > line.pcd
  { printf "$header 100\nDATA ascii\n"; awk 'BEGIN { for (i = 0; i < 100; ++i) print 3, 4, 5 }'; } > same.pcd
}

# keepsOld OUT ARGS...: what stood under a name stays when anything fails, the report included, and no
# two files that are written, or written and read, are one, however their names are spelled. ARGS are
# what expect takes before the output, and end with the input if there is one.
keepsOld() {
  local out=$1 input=${!#}
  shift
  echo old > "$out"
  [ ! -c /dev/full ] || expect 1 'make room' "$@" "$out" -json /dev/full
  grep -qx old "$out" || complain "$out is not the old one after a report that failed"
  rm -f "$out"
  expect 2 'share' "$@" "$out" -json "./$out"
  ln -s "$out" "link_$out"
  expect 2 'share' "$@" "$out" -json "link_$out"
  rm -f "link_$out"
  expect 2 "option -json got ''" "$@" "$out" -json ''
  expect 2 'option -json needs a value' "$@" "$out" -json -quiet
  [ ! -f "$input" ] || expect 2 'overwritten\|share' "$@" "$out" -json "./$input"
  absent "$out" ./-quiet
}

# peak SCAN: MB that the program takes for a scan, and a tenth more.
peak() {
  "$bin/$program" "$1" peak.tmp.slim -json peak.json > /dev/null 2>&1
  rm -f peak.tmp.slim
  value peak.json peak_rss_mb | awk '{ print int(1.1 * $1) + 1 }'
}

# shortOfMemory ARGS...: under ever tighter limits of address space the program ends well, or says in
# one sentence that memory is short, and leaves no file.
shortOfMemory() {
  local limit=1000000 got=0 said=0
  while [ $got -ne 127 ] && [ $limit -gt 20000 ]; do
    limit=$((limit * 9 / 10))
    got=0
    (ulimit -v $limit && exec "$bin/$program" "$@" -threads 1 -quiet) > out.txt 2> err.txt || got=$?
    case $got in
      0) ;;
      1)
        grep -q 'not enough memory' err.txt || complain "$limit KB: $(head -c 300 err.txt)"
        [ "$(wc -l < err.txt)" -eq 1 ] || complain "$limit KB: not one line"
        said=$((said + 1))
        absent "$2"
        ;;
      134)  # static objects of libraries, before the program begins
        grep -q 'terminate called.*bad_alloc' err.txt || complain "$limit KB: $(head -c 300 err.txt)"
        got=127
        ;;
      127) ;; # too little to load the program: a tighter limit shows no more
      *) complain "$limit KB: exit $got, $(head -c 300 err.txt)" ;;
    esac
    rm -f "$2"
  done
  [ "$said" -gt 0 ] || complain "memory was never short"
}

# refuses SCAN: what every program that turns a scan into a file refuses, given a good scan; nothing
# is left. Needs badScans.
refuses() {
  expect 2 'no IN'
  expect 2 'no OUT' "$1"
  expect 2 'unexpected argument' "$1" refused.pcd more.pcd
  expect 2 'No such file' missing.pcd refused.pcd
  expect 2 'folder' folder.pcd refused.pcd
  expect 2 'truncated' cut.pcd refused.pcd
  expect 2 'empty' empty.pcd refused.pcd
  expect 2 'x y z' fields.pcd refused.pcd
  expect 1 'NaN' nan.pcd refused.pcd
  expect 1 'no points' none.pcd refused.pcd
  expect 2 'does not exist' "$1" nowhere/refused.pcd
  expect 2 'folder' "$1" folder.pcd
  expect 2 'does not exist' "$1" refused.pcd -json nowhere/d.json
  absent refused.pcd nowhere
  [ -z "$(find . -name '*.part')" ] || complain "temporary files were left behind"
}

# interrupted SCAN OUT: Ctrl-C soon after the start: status 130, nothing left. A program that was
# faster is done.
interrupted() {
  local pid got=0
  "$bin/$program" "$1" "$2" -quiet 2> err.txt &
  pid=$!
  sleep 0.05
  kill -INT $pid
  wait $pid || got=$?
  [ "$got" -ne 0 ] || return 0
  [ "$got" -eq 130 ] || complain "stopped: exit $got"
  absent "$2"
}

# noisyPlane FOLDER: plane_noisy.ply and plane_original.ply, 900 points each.
noisyPlane() {
  local kind noise
  for kind in noisy original; do
    noise=0
    [ $kind = original ] || noise=0.1
    {
      printf 'ply\nformat ascii 1.0\nelement vertex 900\nproperty float x\nproperty float y\n'
      printf 'property float z\nend_header\n'
      awk -v noise="$noise" 'BEGIN { srand(3)
        for (i = 0; i < 900; ++i) print i % 30, int(i / 30), noise * (rand() - .5) }'
    } > "$1/plane_$kind.ply"
  done
}

# value REPORT KEY: a number or word of a report.
value() { sed -n "s/.*\"$2\": \([^,]*\),*/\1/p" "$1" | head -n 1; }

# documented PROGRAM [PAGE [MORE]]: the help ends well, and each line of its table is in docs/PAGE.md or,
# options that programs share, in docs/MORE.md.
documented() {
  local page=$docs/${2-$1}.md more=$docs/${3-${2-$1}}.md line
  for line in -h -version --help-markdown; do
    "$bin/$1" "$line" > out.txt 2> err.txt || complain "$1 $line fails"
    [ -s out.txt ] && [ -z "$(tail -c 1 out.txt)" ] || complain "$1 $line does not end with a newline"
    [ ! -s err.txt ] || complain "$1 $line says on stderr: $(cat err.txt)"
  done
  "$bin/$1" --help-markdown > out.txt 2> err.txt || complain "$1 --help-markdown fails"
  while IFS= read -r line; do
    case $line in '| `-'*) grep -qF -- "$line" "$page" "$more" || complain "$page lacks: $line" ;; esac
  done < out.txt
}

finish() {
  cd / && rm -rf -- "$work"
  [ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
  echo "all passed"
}
