#!/usr/bin/env bash
# Prints a python3 that can import the modules named as arguments, e.g. find_python.sh h5py matplotlib. The system's
# comes first: Debian's packages belong to it, not to one that stands before it on PATH.
set -euo pipefail
for python in /usr/bin/python3 python3; do
  if path=$(command -v "$python") &&
    "$path" -c 'import importlib, sys; [importlib.import_module(name) for name in sys.argv[1:]]' "$@" 2>/dev/null; then
    echo "$path"
    exit 0
  fi
done
echo "find_python: no python3 has $*: run scripts/setup.sh" >&2
exit 1
