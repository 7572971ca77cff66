#!/usr/bin/env bash
# The address and undefined-behaviour sanitizers over unit and parallel tests, smoke cases and the fuzzer, on 1 and 2 ranks.
# usage: sanitize.sh [BUILD_DIRECTORY]     default: build/asan. From nothing it takes some 6 minutes of two cores, nearly
# all of it compilation: a job for the night, or for a build directory that is kept.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build/asan}
# shellcheck source=scripts/mpi_env.sh
. scripts/mpi_env.sh
python=$(scripts/find_python.sh h5py numpy)

log=$(mktemp)
scratch=$(mktemp -d)
trap 'rm -rf "$log" "$scratch"' EXIT
if ! cmake --preset asan -B "$build" >"$log" 2>&1; then
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
for ranks in 1 2; do
  mpirun -n "$ranks" "$build/tests/parallel_tests" --gtest_brief=1
  for scene in pulse/smoke branching/smoke central_crack/smoke kalthoff_winkler/{,solid_}smoke; do
    mpirun -n "$ranks" "$build/pdxsolve" -options_file "cases/$scene.opts" "${motion[@]}" -output_dir "$scratch/$scene"
  done
  mpirun -n "$ranks" "$build/pdxsolve" -options_file cases/double_notch/smoke.opts -quiet -output_dir "$scratch/notch"
  mpirun -n "$ranks" "$build/pdxsolve" "${smoke[@]}" -output_dir "$scratch/smoke"
  mpirun -n "$ranks" "$build/pdxsolve" "${smoke[@]}" "${papers[@]}" -output_dir "$scratch/papers"
  # What an exception leaves behind in PETSc is no leak of ours to mend, and one process meets hundreds.
  ASAN_OPTIONS=$ASAN_OPTIONS:detect_leaks=0 "$python" tests/fuzz/fuzz.py "$build/tests/fuzz_harness" --ranks "$ranks" --count 600 --seed 3
done
echo "sanitize: nothing found"
