#!/usr/bin/env bash
# Style, as CI sees it: style.sh [format] [layers] [tidy] (default: all three).
#   format   clang-format over all C++ files, nothing is rewritten
#   layers   who includes whom, the map of the rooms, lengths of files
#   tidy     clang-tidy over C++ files changed since CI_BASE (default: three commits ago), at most 3
# Formatters differ from version to version: where the pinned one is missing (Debian 13), format is skipped with a word,
# and tidy takes the clang-tidy there is, or none. CI runs on Debian 12, which has both.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
readonly tidy_limit=3 pinned=14

check_format() {
  if ! command -v clang-format-$pinned >/dev/null; then
    echo "style: format is skipped: no clang-format-$pinned here, and others format differently"
    return
  fi
  find src include tests -name '*.cpp' -o -name '*.hpp' | sort | xargs clang-format-$pinned --dry-run -Werror
  echo "style: format is right"
}

check_layers() {
  python3 scripts/check_layers.py --self-test
  python3 scripts/check_layers.py
}

# The commit to compare with: CI_BASE, else three commits ago, else (short history) the first commit there is.
base_commit() {
  git rev-parse --verify --quiet "${CI_BASE:-HEAD~3}^{commit}" || git rev-list --max-parents=0 HEAD | tail -n 1
}

# Source files through which every changed C++ file is seen: itself, or the first .cpp that includes a header.
changed_sources() {
  local file
  git diff --name-only --diff-filter=d "$(base_commit)" -- '*.cpp' '*.hpp' | while read -r file; do
    case $file in
      *.cpp) echo "$file" ;;
      include/*) git grep -lF "\"${file#include/}\"" -- 'src/*.cpp' 'tests/*.cpp' | head -n 1 || true ;;
    esac
  done | sort -u
}

check_tidy() {
  local build=build/tidy known sources tidy
  if ! tidy=$(command -v clang-tidy-$pinned || command -v clang-tidy); then
    echo "style: tidy is skipped: no clang-tidy here"
    return
  fi
  cmake --preset release -B $build -DPDX_BUNDLE=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null # each source alone
  known=$(changed_sources | while read -r file; do
    if grep -qF "/$file\"" $build/compile_commands.json; then echo "$file"; fi
  done)
  sources=$(head -n $tidy_limit <<<"$known")
  if [ -z "$sources" ]; then
    echo "style: no C++ file changed, nothing for clang-tidy"
    return
  fi
  echo "style: ${tidy##*/} over $(wc -l <<<"$sources") of $(wc -l <<<"$known") changed sources"
  xargs -P "$(nproc)" -n 1 "$tidy" --quiet -p $build <<<"$sources" 2>/dev/null
}

[ $# -gt 0 ] || set -- format layers tidy
for step in "$@"; do
  case $step in
    format | layers | tidy) "check_$step" ;;
    *) echo "style: unknown step '$step'; steps are format, layers, tidy" >&2; exit 1 ;;
  esac
done
