#!/usr/bin/env bash
# The static plate of part I on two meshes: runs, draws out/plate_static.png, prints the errors beside the paper's.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh demo
scripts/build.sh release pdxsolve
# shellcheck source=scripts/mpi_env.sh
. scripts/mpi_env.sh
python=$(scripts/find_python.sh h5py numpy matplotlib)

runs=()
for mesh in coarse fine; do
  directory=out/plate_static_$mesh
  mpirun -n 2 build/release/pdxsolve -options_file "cases/plate_static/$mesh.opts" -output_dir "$directory"
  runs+=("$directory")
done
"$python" scripts/plot_case.py "${runs[@]}" -o out/plate_static.png --kind plate
"$python" scripts/error_table.py coarse:1.19:"${runs[0]}" fine:0.75:"${runs[1]}"
echo "picture: out/plate_static.png"
