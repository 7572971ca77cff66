#!/usr/bin/env bash
# The address and undefined-behaviour sanitizers over unit and parallel tests, smoke cases and the fuzzer, on 1 and 2 ranks.
# usage: sanitize.sh [BUILD_DIRECTORY]     default: build/asan, bundled when it is new. From nothing it takes an hour of one core and more,
# nearly all of it compilation: a job for the night, or for a build directory that is kept.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build/asan}
# shellcheck source=scripts/mpi_env.sh
. scripts/mpi_env.sh
python=$(scripts/find_python.sh h5py numpy)

log=$(mktemp)
scratch=$(mktemp -d)
trap 'rm -rf "$log" "$scratch"' EXIT
[ -e "$build/CMakeCache.txt" ] || PDX_BUNDLE=${PDX_BUNDLE:-ON}
if ! cmake --preset asan -B "$build" ${PDX_BUNDLE:+-DPDX_BUNDLE="$PDX_BUNDLE"} >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
cmake --build "$build" --target pdxsolve unit_tests parallel_tests fuzz_harness --parallel 2

# Plugins of Open MPI leak and are unloaded before they can be named: hence slow unwinding and the suppressions.
export ASAN_OPTIONS=fast_unwind_on_malloc=0
export LSAN_OPTIONS=suppressions=$PWD/tests/support/lsan.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1

"$build/tests/unit_tests" --gtest_brief=1
smoke=(-options_file cases/plate_static/smoke.opts -quiet)
papers=(-couple_scheme ghost -pd_surface_correction volume -kinematics finite -pd_operator assembled)
motion=(-output_fields -output_history -checkpoint_interval 20 -ts_max_steps 60 -quiet)
# Patches that move, material points, junctions, heat, steps of two lengths: a scene a line, coarse and short.
scenes=(
  "branching/medium_snail -pd_spacing 5e-4 -mesh_cells 50,20 -ts_max_steps 250"
  "central_crack/snail -ts_max_steps 80"
  "central_crack/snail -ts_dt 2e-8 -ts_subcycle 2 -ts_max_steps 60"
  "two_discs/coarse -mpm_left_disc 0.5,0.5,0.2 -ts_max_steps 100 -layout_renew_interval 25"
  "hole_plate/case -mpm_spacing 1.25e-3 -pd_spacing 1.25e-3 -adapt_stress 2e8 -ts_dt 3e-8 -ts_max_steps 60 -layout_renew_interval 25"
  "precracked_plate/coarser -mpm_spacing 2.5e-3 -pd_spacing 1.25e-3 -ts_dt 3e-8 -ts_max_steps 150 -pd_critical_stretch 0.003 -layout_renew_interval 25"
  "projectile/case -mesh_cells 20,40 -mpm_spacing 2.5e-3 -pd_spacing 2.5e-3 -mpm_projectile_velocity 200,0 -ts_dt 1e-7 -ts_max_steps 200"
  "sphere_on_plate/case -mpm_spacing 4e-3 -mpm_cell_ratio 1 -mpm_sphere_velocity 0,0,-15 -ts_max_steps 40"
  "bar_in_space/case -mpm_impactor_box -0.01,0,0,0,0.004,0.004 -mpm_bar_box 0,0,0,0.024,0.004,0.004 -ts_max_steps 800"
  "two_cracks/smoke -load_steps 4 -bc_top_displacement 0,0.5e-6 -bc_bottom_displacement 0,-0.5e-6"
  "shear_panel/smoke -mesh_cells 15,15 -load_steps 4"
  "slanted/smoke_snail -load_steps 3"
  "teaching/hole_crack"
  "mixed_modes/case"
  "cold_shock/smoke -mesh_upper 6mm,3mm -load_steps 3"
)
for ranks in 1 2; do
  mpirun -n "$ranks" "$build/tests/parallel_tests" --gtest_brief=1
  for scene in pulse/smoke branching/smoke central_crack/smoke kalthoff_winkler/{,solid_}smoke; do
    mpirun -n "$ranks" "$build/pdxsolve" -options_file "cases/$scene.opts" "${motion[@]}" -output_dir "$scratch/$scene"
  done
  for scene in "${scenes[@]}"; do
    read -r -a words <<<"$scene"
    mpirun -n "$ranks" "$build/pdxsolve" -options_file "cases/${words[0]}.opts" -quiet -output_fields -output_history \
      -output_history_interval 5 "${words[@]:1}" -output_dir "$scratch/scene"
  done
  # On from where patches had moved, dealt out to the other number of ranks.
  snail=(-options_file cases/branching/medium_snail.opts -pd_spacing 5e-4 -mesh_cells 50,20 -quiet -output_dir "$scratch/snail")
  mpirun -n "$ranks" "$build/pdxsolve" "${snail[@]}" -ts_max_steps 220 -checkpoint_interval 220
  mpirun -n $((3 - ranks)) "$build/pdxsolve" "${snail[@]}" -ts_max_steps 250 -restart "$scratch/snail/checkpoint.h5"
  mpirun -n "$ranks" "$build/pdxsolve" -options_file cases/double_notch/smoke.opts -quiet -output_dir "$scratch/notch"
  mpirun -n "$ranks" "$build/pdxsolve" "${smoke[@]}" -output_dir "$scratch/smoke"
  mpirun -n "$ranks" "$build/pdxsolve" "${smoke[@]}" "${papers[@]}" -output_dir "$scratch/papers"
  # What an exception leaves behind in PETSc is no leak of ours to mend, and one process meets hundreds.
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 "$python" tests/fuzz/fuzz.py "$build/tests/fuzz_harness" --ranks "$ranks" --count 600 --seed 3
done
echo "sanitize: nothing found"
