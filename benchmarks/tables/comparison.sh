#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# SLIM beside pcl::MovingLeastSquares: every table and the chart of benchmarks/README.md.
#   benchmarks/tables/comparison.sh DATA_FOLDER OUT_FOLDER [STAGE...]
# Stages, all by default: timed timed438 noisy sizes exact pairs bunny. Writes OUT_FOLDER/STAGE.csv and .md
# and prints the tables made of all the .csv there. The program is pcl_slim_benchmark of build/release/bin or
# of the folder named by BIN_DIR. THREADS (2) and VECTORS (best; AVX2 and others: the instruction set of SLIM)
# may be set. Needs python3, and xvfb-run for the chart.
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
program=pcl_slim_benchmark
source "$here/data_arguments.sh"
shift 2
[ $# -gt 0 ] || set -- timed timed438 noisy sizes exact pairs bunny
export OMP_WAIT_POLICY=passive  # PCL's threads that wait burn no CPU time

# run STAGE OPTION...
run() {
  local stage=$1
  shift
  echo "$stage" >&2
  "$bin/$program" "$out/$stage" -threads "${THREADS:-2}" -quiet -vectors "${VECTORS:-best}" "$@"
}

smooth=(-shapes 'sphere,torus,bumpy,relief' -noises '0,0.001,0.005')
few=(-methods 'slim,mls' -degrees '2,4' -kappas '0,8' -t_mdls '0.005,0.01')
timed=(-methods 'slim,mls' -degrees '2,3,4' -kappas '0,8' -t_mdls '0.002,0.005,0.02,0.05' -compact 1
  -mls_orders 2 -mls_neighbours '15,30,100,200,400,1000')
for stage in "$@"; do
  case $stage in
    timed)
      if command -v xvfb-run >/dev/null; then
        echo timed >&2
        xvfb-run -a "$bin/$program" "$out/timed" -threads "${THREADS:-2}" -quiet 1 "${smooth[@]}" \
          "${timed[@]}" -vectors "${VECTORS:-best}"
      else
        run timed "${smooth[@]}" "${timed[@]}" -chart 0
      fi
      ;;
    timed438) run timed438 "${smooth[@]}" "${timed[@]}" -points 438000 -repeats 1 -chart 0 ;;
    noisy)
      run noisy -shapes 'sphere,torus,bumpy,relief' -noises '0.001,0.005' -methods 'slim,mls' \
        -normals 0 -degrees '2,4' -kappas '0,8' -t_mdls '0.02,0.05' -compact 1 -mls_orders 2 \
        -mls_neighbours '200,400,1000' -repeats 1 -chart 0
      ;;
    sizes)
      run sizes -shapes bumpy -noises 0.001 -points '5000,20000,100000,438000,1000000' \
        -methods 'slim,mls' -normals 0 -degrees 4 -kappas 0 -t_mdls 0.05 -compact 1 \
        -mls_orders 2 -mls_neighbours '100,400,1000' -repeats 1 -chart 0
      ;;
    exact)
      run exact -shapes 'sphere,torus,bumpy,relief' -noises '0,0.001,0.005,0.01' -chart 0 \
        -degrees '2,4' -kappas '0,0.5,1,8' -t_mdls 0.01 -mls_orders '2,3' \
        -mls_neighbours '15,30,60,100,200,400,1000' -repeats 1
      ;;
    pairs)
      run pairs -pairs "$data" "${few[@]}" -mls_orders '2,3' \
        -mls_neighbours '10,15,20,30,45,60' -repeats 5 -chart 0
      ;;
    bunny)
      run bunny -input "$data/stanford_bunny_raw_scans.pcd" \
        -truth "$data/stanford_bunny_zipper.ply" -methods 'slim,mls' -degrees '2,4' \
        -kappas '0,8' -t_mdls 0 -robust 1 -compact 1 -mls_orders '2,3' \
        -mls_neighbours '60,100,150,200,300,400' -chart 0
      ;;
    *) usage "unknown stage '$stage'; see comparison.sh -h" ;;
  esac
done
python3 "$here/comparison_table.py" "$out" | tee "$out/tables.md"
