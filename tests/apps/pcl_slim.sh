#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The one command: it starts each program as it is, and says which command was meant or is not installed.
source "$(dirname -- "${BASH_SOURCE[0]}")/../support/program_test.sh"
program=pcl_slim

# The list: one line a command, each of a program.
expect 0 ''
cp out.txt list.txt
for option in -h -help --help help; do
  expect 0 '' $option
  same out.txt list.txt
done
for command in fit smooth mesh curvature lines sample compare splats render view benchmark fit_mpi demo_scan help; do
  [ "$(grep -c "^  $command " list.txt)" -eq 1 ] || complain "$command is not in the list"
done
[ "$(awk 'length > 79' list.txt | grep -vc 'not installed')" -eq 0 ] || complain "$(awk 'length > 79' list.txt)"
for option in -version --version; do
  expect 0 '' $option
  grep -qx 'pcl_slim [0-9.]*' out.txt || complain "$(cat out.txt)"
done
documented pcl_slim
while IFS= read -r line; do
  grep -qF -- "$line" "$docs/pcl_slim.md" || complain "docs/pcl_slim.md lacks: $line"
done < out.txt

# Help and versions of every program, spelled in each way.
"$bin/pcl_slim_smooth" -h > smooth.txt
for arguments in 'help smooth' 'smooth -h' 'smooth -help' 'smooth --help'; do
  # shellcheck disable=SC2086
  expect 0 '' $arguments
  same out.txt smooth.txt
done
grep -q '^       or: pcl_slim_smooth IN\.\.\. -out DIR' smooth.txt || complain 'several inputs are not in the help'
expect 0 '' splats -version
grep -q '^pcl_color_splat_sampling ' out.txt || complain "$(cat out.txt)"

# Commands that are none.
expect 2 "unknown command 'smoth'; did you mean smooth?" smoth a b
expect 2 "unknown command 'smoth'; did you mean smooth?" help smoth
expect 2 "unknown command 'xyzzyplugh'; see pcl_slim -h" xyzzyplugh
expect 2 "unknown command '-quiet'" -quiet
expect 2 'one command' help smooth fit

# A program beside it, with its statuses and bytes, wherever it is called from.
expect 0 '' demo_scan scan.pcd -points 3000 -quiet
"$bin/pcl_slim_fit" scan.pcd long.slim -quiet || complain 'no long.slim'
expect 0 '' fit scan.pcd a.slim -quiet
same a.slim long.slim
ln -s "$bin/pcl_slim" linked
(PATH=$PWD:$PATH && linked fit scan.pcd b.slim -quiet) || complain 'not found behind a link'
same b.slim long.slim
expect 2 'No such file' fit missing.pcd c.slim
awk 'BEGIN { print "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nDATA ascii\nnan nan nan" }' > nan.pcd
expect 1 'NaN' fit nan.pcd c.slim
absent c.slim

# It becomes the program: a signal reaches that one, and its status is the shell's.
mkfifo never.pcd
"$bin/pcl_slim" fit never.pcd c.slim > /dev/null 2> err.txt &
pid=$!
sleep 0.3
kill -INT $pid
got=0
wait $pid || got=$?
[ "$got" -eq 130 ] || complain "stopped: exit $got"
grep -q '^pcl_slim_fit: stopped' err.txt || grep -q '^stopped' err.txt || complain "stopped: $(cat err.txt)"

# Programs that are not there; then one in a folder of PATH.
mkdir alone
cp "$bin/pcl_slim" alone/
PATH=/usr/bin:/bin alone/pcl_slim view x 2> err.txt && complain 'a window without its program'
grep -q "pcl_slim_view is not installed, as it is built with VTK's rendering" err.txt || complain "$(cat err.txt)"
PATH=/usr/bin:/bin alone/pcl_slim smooth x 2> err.txt && complain 'smooth without its program'
grep -q 'pcl_slim_smooth is not installed; see' err.txt || complain "$(cat err.txt)"
PATH=/usr/bin:/bin alone/pcl_slim > out.txt
[ "$(grep -c '(not installed)$' out.txt)" -eq 13 ] || complain "$(cat out.txt)"
(PATH=$bin:$PATH && alone/pcl_slim fit scan.pcd d.slim -quiet) || complain 'not found in PATH'
same d.slim long.slim

finish
