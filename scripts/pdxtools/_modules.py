"""Goes on under the system's python3 where the one that was called lacks what the scripts beside this package need:
Debian's packages belong to the system's, whatever stands before it on PATH. Of no effect on programs of others.
"""

import importlib.util
import os
import pathlib
import sys

NEEDED = ("h5py", "numpy", "matplotlib")
SYSTEM = "/usr/bin/python3"
TREE = pathlib.Path(__file__).resolve().parents[2]


def is_our_script():
    """One of the tree, or an installed command."""
    path = getattr(sys.modules.get("__main__"), "__file__", None)
    if path is None:
        return False
    path = pathlib.Path(path).resolve()
    return path.name.startswith("pdxsolve-") or ((TREE / "scripts" / "pdxtools").is_dir() and TREE in path.parents)


def use_a_python_that_has_them():
    missing = [name for name in NEEDED if importlib.util.find_spec(name) is None]
    if not missing or not is_our_script():
        return
    if sys.prefix != "/usr" and os.path.exists(SYSTEM):
        sys.stdout.flush()
        os.execv(SYSTEM, [SYSTEM, *sys.orig_argv[1:]])
    if missing != ["matplotlib"]:  # which reading does without
        sys.exit(f"the scripts need {', '.join(missing)} (Debian: python3-h5py python3-numpy python3-matplotlib, with {SYSTEM})")
