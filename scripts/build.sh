#!/usr/bin/env bash
# Configures and builds one preset into build/PRESET. Quiet when nothing is wrong.
# usage: build.sh [PRESET] [TARGET...]     default: release, everything. PDX_WERROR=ON: warnings are errors, as in CI.
# A new build directory compiles sources in bundles, which takes half as long; PDX_BUNDLE=OFF, for whoever changes them
# often, compiles each alone. What a directory began with stays.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
preset=${1:-release}
targets=("${@:2}")

[ -e "build/$preset/CMakeCache.txt" ] || PDX_BUNDLE=${PDX_BUNDLE:-ON}
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! cmake --preset "$preset" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON ${PDX_WERROR:+-DPDX_WERROR="$PDX_WERROR"} \
    ${PDX_BUNDLE:+-DPDX_BUNDLE="$PDX_BUNDLE"} >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
cmake --build --preset "$preset" --parallel "$(nproc)" ${targets:+--target "${targets[@]}"}
