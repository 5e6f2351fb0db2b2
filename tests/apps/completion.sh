#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Manual pages and completions for bash, which programs print of their options and the build keeps.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
share=$(cd -- "$bin/../share" 2> /dev/null && pwd)

names=$("$bin/pcl_slim" --help-markdown | sed -n 's/^| `[^`]*` | `\([^`]*\)` .*/\1/p')
[ "$(wc -w <<< "$names")" -eq 13 ] || complain "programs: $names"
mkdir man completions
for name in pcl_slim $names; do
  [ -x "$bin/$name" ] || continue
  "$bin/$name" --help-man > man/$name.1 2> err.txt || complain "$name --help-man fails"
  "$bin/$name" --help-completion > completions/$name 2>> err.txt || complain "$name --help-completion fails"
  [ ! -s err.txt ] || complain "$name: $(cat err.txt)"
  same man/$name.1 "$share/man/man1/$name.1"
  same completions/$name "$share/bash-completion/completions/$name"
  bash -n completions/$name || complain "completions/$name is not bash"
done

# Pages without a warning, that whatis can list, with every option.
for page in man/*.1; do
  if command -v man > /dev/null; then
    man --warnings -E UTF-8 -l "$page" 2>&1 > /dev/null | grep . && complain "man: $page"
  fi
  if command -v mandoc > /dev/null; then
    mandoc -T lint -W style "$page" || complain "mandoc: $page"
  fi
  grep -A1 '^\.SH NAME' "$page" | grep -q "^$(basename "$page" .1) \\\\- [a-zSP]" || complain "$page has no NAME"
done
for option in $("$bin/pcl_slim_render" --help-markdown | sed -n 's/^| `-\([a-z_]*\).*/\1/p'); do
  grep -q "^.fB.-$option.fR" man/pcl_slim_render.1 || complain "pcl_slim_render.1 has no -$option"
done

# completes FILE 'WORDS' WORD...: after these words, the last one of which is completed, exactly these are offered.
completes() {
  local file=$1 got
  got=$(
    set +u
    # shellcheck disable=SC1090
    source "$file" || exit 1
    read -ra COMP_WORDS <<< "${2%|}"
    [ "${2%|}" = "$2" ] || COMP_WORDS+=('')
    COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
    registered=$(complete -p "${COMP_WORDS[0]##*/}") || exit 1
    function=${registered#*-F }
    "${function%% *}"
    printf '%s\n' "${COMPREPLY[@]}" | sort | tr '\n' ' '
  )
  local wanted
  wanted=$(printf '%s\n' "${@:3}" | sort | tr '\n' ' ')
  [ "$got" = "$wanted" ] || complain "'$2' offers '$got', not '$wanted'"
}
: > scan.pcd
: > scene.ply
mkdir folder
one=completions/pcl_slim
completes $one 'pcl_slim s' sample smooth splats
completes $one 'pcl_slim -' -help -version
completes $one 'pcl_slim help f' fit fit_mpi
completes $one 'pcl_slim smooth -cur' -curvatures
completes $one 'pcl_slim smooth --cur' --curvatures
completes $one 'pcl_slim smooth sc' scan.pcd scene.ply
completes $one 'pcl_slim lines -type |' both ravines ridges
completes $one 'pcl_slim lines -type = r' ravines ridges
completes $one 'pcl_slim lines -type = |' ravines ridges both
completes $one 'pcl_slim smooth -correlation |' auto off
completes $one 'pcl_slim smooth -degree |' ''
completes $one 'pcl_slim smooth -scratch f' folder
completes $one 'pcl_slim splats -radius |' corner density neighbours
completes $one 'pcl_slim unknown -' ''
long=completions/pcl_slim_smooth
completes $long 'pcl_slim_smooth -norm' -normal_error -normals -normals_as_data
completes $long 'pcl_slim_smooth scan.pcd -format |' las pcd ply vtp
completes $long 'pcl_slim_smooth scan.pcd -quiet s' scan.pcd scene.ply
completes $long 'pcl_slim_smooth -surface s' scan.pcd scene.ply
completes completions/pcl_slim_render 'pcl_slim_render -camera a' auto
completes completions/pcl_slim_render 'pcl_slim_render -up |' -x -y -z auto x y z

# Sourced as the program prints it, without files beside: programs print theirs.
mkdir alone
cp $one alone/
completes alone/pcl_slim "$bin/pcl_slim smooth -cur" -curvatures

finish
