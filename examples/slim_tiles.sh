#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# One task of a Slurm job array: fits its share of the tiles of a plan (docs/tiles.md).
#
#   sbatch --array 0-15 slim_tiles.sh scan.ply out.slim /shared/job
set -euo pipefail
exec pcl_slim_fit "$1" "$2" -plan "$3" -threads "${SLURM_CPUS_PER_TASK:-1}" \
  -tiles "${SLURM_ARRAY_TASK_ID:-0}/${SLURM_ARRAY_TASK_COUNT:-1}"
