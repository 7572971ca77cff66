#!/usr/bin/env bash
# The whole test suite from a fresh clone: packages, build, ctest. Arguments go to ctest, e.g. -L unit or -R app_.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/setup.sh demo tests
scripts/build.sh release
# shellcheck source=scripts/mpi_env.sh
. scripts/mpi_env.sh
exec ctest --preset release --no-tests=error --parallel "$(nproc)" "$@"
