#!/usr/bin/env bash
# Installs, by apt, what a bare Debian 12 lacks to build, test and draw. Idempotent; changes nothing else.
set -euo pipefail

packages=(
  build-essential cmake ninja-build pkg-config git
  petsc-dev libopenmpi-dev openmpi-bin libhdf5-openmpi-dev libmetis-dev
  libeigen3-dev libfmt-dev nlohmann-json3-dev libgtest-dev libbenchmark-dev
  python3 python3-numpy python3-matplotlib python3-h5py
  clang-format-14 clang-tidy-14 valgrind
)

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "setup: this script needs Debian's apt; install by hand the equivalents of: ${packages[*]}" >&2
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "setup: all ${#packages[@]} packages are installed"
  exit 0
fi

if [ "$(id -u)" -eq 0 ]; then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo env)
else
  echo "setup: missing packages and no sudo; run as root:" >&2
  echo "  apt-get update && apt-get install -y --no-install-recommends ${missing[*]}" >&2
  exit 1
fi

echo "setup: installing ${#missing[@]} of ${#packages[@]} packages: ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { "${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get update -q &&
       "${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"; } \
     >"$log" 2>&1; then
  tail -n 20 "$log" >&2
  echo "setup: apt-get failed (its last lines are above)" >&2
  exit 1
fi
echo "setup: done"
