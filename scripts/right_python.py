"""Goes on under the system's python3 where the one that was called lacks what the scripts need: Debian's packages belong to
the system's, whatever stands before it on PATH. To be imported before h5py, numpy and matplotlib; `fields` does that."""

import importlib.util
import os
import sys

NEEDED = ("h5py", "numpy", "matplotlib")
SYSTEM = "/usr/bin/python3"

if sys.prefix != "/usr" and os.path.exists(SYSTEM) and any(importlib.util.find_spec(name) is None for name in NEEDED):
    sys.stdout.flush()
    os.execv(SYSTEM, [SYSTEM, *sys.orig_argv[1:]])
