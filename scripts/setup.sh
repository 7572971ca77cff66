#!/usr/bin/env bash
# Installs, by apt, what a bare Debian 12 or 13 lacks. Idempotent; changes nothing else.
# usage: setup.sh [demo] [tests] [style] [docs]     default: all four
#   demo    to build the program, run it, draw, and make packages of it (`file` is for cpack)
#   tests   to build and run the tests
#   style   formatter and linter of the pinned version (Debian 12); a release that lacks them goes without
#   docs    to make the documentation as a site
set -euo pipefail

demo=(
  build-essential cmake ninja-build pkgconf git file
  petsc-dev libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libmetis-dev
  libeigen3-dev libfmt-dev nlohmann-json3-dev libxxhash-dev
  python3 python3-numpy python3-matplotlib python3-h5py
)
tests=(libgtest-dev libbenchmark-dev valgrind)
style=(clang-format-14 clang-tidy-14)
docs=(mkdocs)

needed=()
wished=()
[ $# -gt 0 ] || set -- demo tests style docs
for part in "$@"; do
  case $part in
    demo) needed+=("${demo[@]}") ;;
    tests) needed+=("${tests[@]}") ;;
    style) wished+=("${style[@]}") ;;
    docs) wished+=("${docs[@]}") ;;
    *) echo "setup: unknown part '$part'; parts are demo, tests, style, docs" >&2; exit 1 ;;
  esac
done

# Those of the packages named that are not installed.
missing_of() {
  local package
  for package in "$@"; do
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || echo "$package"
  done
}
# Those of the packages named that apt can install, as far as its lists go.
known_of() {
  local package
  for package in "$@"; do
    if apt-cache show --no-all-versions "$package" >/dev/null 2>&1; then echo "$package"; fi
  done
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "setup: this script needs Debian's apt; install by hand the equivalents of: ${needed[*]}" >&2
  exit 1
fi

mapfile -t missing < <(missing_of "${needed[@]}")
mapfile -t wanted < <(missing_of "${wished[@]}")
if [ ${#missing[@]} -eq 0 ]; then mapfile -t wanted < <(known_of "${wanted[@]}"); fi # no new lists for wishes alone
if [ ${#missing[@]} -eq 0 ] && [ ${#wanted[@]} -eq 0 ]; then
  echo "setup: all ${#needed[@]} packages are installed"
  exit 0
fi

if [ "$(id -u)" -eq 0 ]; then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo env)
else
  echo "setup: missing packages and no sudo; run as root:" >&2
  echo "  apt-get update && apt-get install -y --no-install-recommends ${missing[*]} ${wanted[*]}" >&2
  exit 1
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Shows how far apt-get is: a line for every 25 packages that it fetched, unpacked or set up, of so many in all.
progress() {
  local all=$1 line word
  local -A count=()
  while IFS= read -r line; do
    echo "$line" >>"$log"
    case $line in
      Get:*) word=fetched ;;
      Unpacking*) word=unpacked ;;
      "Setting up"*) word="set up" ;;
      *) continue ;;
    esac
    count[$word]=$((${count[$word]:-0} + 1))
    if [ "$all" -gt 0 ] && { [ $((${count[$word]} % 25)) -eq 0 ] || [ "${count[$word]}" -eq "$all" ]; }; then
      echo "setup: ${count[$word]} of $all $word"
    fi
  done
}
apt() {
  local all=0
  : >"$log"
  if [ "$1" = install ]; then all=$("${as_root[@]}" apt-get -s "$@" 2>/dev/null | grep -c '^Inst' || true); fi
  if ! "${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get "$@" 2>&1 | progress "$all"; then
    tail -n 20 "$log" >&2
    echo "setup: apt-get failed (its last lines are above)" >&2
    exit 1
  fi
}
echo "setup: $((${#missing[@]} + ${#wanted[@]})) packages are not here: ${missing[*]} ${wanted[*]}"
echo "setup: asking apt where they are"
apt update -q
mapfile -t found < <(known_of "${wanted[@]}")
[ ${#found[@]} -eq ${#wanted[@]} ] || echo "setup: this release has not all of: ${wanted[*]} (only style checks and the site need them)"
missing+=("${found[@]}")
echo "setup: installing ${#missing[@]} packages: ${missing[*]}"
apt install -y -q --no-install-recommends "${missing[@]}"
echo "setup: done"
