#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Where surfaces, pictures and meshes end: the tables of "Borders" in benchmarks/README.md.
#   benchmarks/tables/borders.sh DATA_FOLDER OUT_FOLDER [STAGE...]
# Stages, all by default: open closed files cost scans rivals. Writes OUT_FOLDER/STAGE.txt and prints its
# tables. The program is borders_bench of build/release/bin or of the folder named by BIN_DIR; it uses one
# thread. Needs python3.
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
program=borders_bench
source "$here/data_arguments.sh"
shift 2
[ $# -gt 0 ] || set -- open closed files cost scans rivals

closed=(armadillo_50k.ply stanford_dragon_res2.ply block_04_original.ply block_04_noisy.ply fandisk_03_original.ply
  fandisk_03_noisy.ply pcpnet_cube100k.pcd denoise/{casting,chair,cow,duck,eight,genus3,star}.ply)
scans=(kinect_mosd_learn13.pcd angel_real_scan.ply autzen_stadium.pcd lion_takanawa.pcd lone_star_geyser_tls.pcd
  terrain_isprs_csite1_utm.pcd stereo_pr2_textured.pcd azure_kinect_organized.pcd stanford_bunny_raw_scans.pcd
  stanford_dragon_res2.ply armadillo_50k.ply pcpnet_cube100k.pcd)

# joined NAME...: the scans' paths, separated by commas.
joined() {
  local IFS=,
  echo "${*/#/$data/}"
}

for stage in "$@"; do
  case $stage in
    open) command=(open) ;;
    closed) command=(closed) ;;
    files) command=(closed -files "$(joined "${closed[@]}")") ;;
    cost) command=(cost -repeat 5 -files "$data/lone_star_geyser_tls.pcd") ;;
    rivals) command=(open -methods 'truth,poisson,front' -noises '0,0.3') ;;
    scans) command=() ;;
    *) usage "no stage is called '$stage'; see $script -h" ;;
  esac
  echo "$stage" >&2
  if [ "$stage" = scans ]; then
    for scan in "${scans[@]}"; do "$bin/$program" "$data/$scan" -size 700; done >"$out/scans.txt"
    python3 "$here/borders_scans.py" "$out/scans.txt"
  else
    "$bin/$program" "${command[@]}" >"$out/$stage.txt"
    case $stage in
      files | cost) grep '^|' "$out/$stage.txt" ;;
      *) sed '1,/^$/d' "$out/$stage.txt" ;;  # the sums
    esac
  fi
done
