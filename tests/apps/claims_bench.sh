#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# claims_bench: exit status, messages, files, options as documented.
# Arguments: programs' folder, an empty folder to work in.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=claims_bench
mkdir -p -- pairs none
noisyPlane pairs

# A table each, a row a figure, the same for any number of threads.
claims=(-claims rims,sheets,default -points 3000 -shapes sphere -noises 0.005 -kappas 1,8 -t_mdls 0
  -mls_orders 2 -mls_neighbours 60)
expect 0 '' claims "${claims[@]}"
[ "$(grep -c 'goals met' claims.md)" -eq 3 ] || complain "not three tables in claims.md"
[ "$(wc -l < claims.csv)" -eq 25 ] || complain "$(wc -l < claims.csv) lines in claims.csv"
expect 0 '' -quiet claims1 "${claims[@]}" -threads 1
[ ! -s out.txt ] || complain "-quiet says: $(cat out.txt)"
same claims.csv claims1.csv
expect 0 '' moves -claims moves -scans pairs
[ "$(wc -l < moves.csv)" -eq 5 ] || complain "$(wc -l < moves.csv) lines in moves.csv"

rm -f -- ./*.csv ./*.md
expect 2 'OUT_PREFIX'
expect 2 'claims' x -claims fast
expect 2 'moves' x -claims moves
expect 2 'moves' x -claims rims -scans pairs
expect 2 'name another folder' x -claims moves -scans none
expect 2 'name another folder' x -scans /no/such
expect 2 'tea' x -shapes tea
expect 1 'no/such' no/such/x "${claims[@]}"
[ -z "$(find . -name '*.csv' -o -name '*.md')" ] || complain "files left behind"

documented "$program" ../benchmarks/claims/README

finish
