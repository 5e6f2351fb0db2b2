#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# One task of a Slurm job array: fits its share of the tiles of a plan (docs/tiles.md).
#
#   sbatch --array 0-15 slim_tiles.sh scan.ply out.slim /shared/job 400
#
# The last argument is the number of tiles, which the report of the run that made the plan gives:
#   pcl_slim_fit scan.ply out.slim -plan /shared/job -tiles 0:0 -json plan.json
set -euo pipefail
scan=$1 out=$2 plan=$3 tiles=$4
task=${SLURM_ARRAY_TASK_ID:-0}
tasks=${SLURM_ARRAY_TASK_COUNT:-1}
begin=$((task * tiles / tasks))
end=$(((task + 1) * tiles / tasks))
exec pcl_slim_fit "$scan" "$out" -plan "$plan" -tiles "$begin:$end" -threads "${SLURM_CPUS_PER_TASK:-1}"
