#!/usr/bin/env bash
# Configures and builds one preset (default: release) into build/PRESET. Quiet when nothing is wrong.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}

log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! cmake --preset "$preset" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
cmake --build --preset "$preset" --parallel "$(nproc)"
