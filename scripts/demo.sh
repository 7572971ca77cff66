#!/usr/bin/env bash
# Two parts. A crack that runs, branches and is followed by its patch: out/branching_snail.png and .gif. And the static plate
# of part I on two meshes, whose errors are printed beside the paper's: out/plate_static.png.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
echo "demo: 1 of 3, packages: compiler, PETSc, Open MPI, HDF5, Python to draw; no tests, no linters"
scripts/setup.sh demo
echo "demo: 2 of 3, building the program alone, $(nproc) files at a time; ninja counts them"
scripts/build.sh release pdxsolve
echo "demo: 3 of 3, a crack that branches, and a static plate on two meshes"
# shellcheck source=scripts/mpi_env.sh
. scripts/mpi_env.sh
python=$(scripts/find_python.sh h5py numpy matplotlib PIL)
begin=$SECONDS

mpirun -n 2 build/release/pdxsolve -options_file cases/branching/demo.opts -output_dir out/branching_snail
"$python" scripts/snail_pictures.py out/branching_snail -o out/branching_snail --at 8 18 26 40

runs=()
for mesh in coarse fine; do
  directory=out/plate_static_$mesh
  mpirun -n 2 build/release/pdxsolve -options_file "cases/plate_static/$mesh.opts" -output_dir "$directory"
  runs+=("$directory")
done
"$python" scripts/plot_case.py "${runs[@]}" -o out/plate_static.png --kind plate
"$python" scripts/error_table.py coarse:1.19:"${runs[0]}" fine:0.75:"${runs[1]}"
echo "pictures: out/branching_snail.png, out/branching_snail.gif, out/plate_static.png, in $((SECONDS - begin)) s"
