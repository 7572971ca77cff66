#!/usr/bin/env python3
"""Runs the variants on one rank and prints what the cracks did.

usage: study.py [--executable build/release/pdxsolve] [--out out/kalthoff_winkler] [--only case,fine]
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import crack_study

SPARSE = ["-output_fields", "-output_interval", "40"]
UNIFORM = ["-pd_micromodulus", "uniform"]
VARIANTS = {
    "case": ("case", []),
    "fine": ("fine", SPARSE),
    "uniform": ("case", UNIFORM),
    "fine_uniform": ("fine", UNIFORM),
    "small": ("fine", ["-kinematics", "small"]),
    "smoke": ("smoke", []),
    "initial": ("initial", []),
}

if __name__ == "__main__":
    sys.exit(crack_study.main(__doc__, "kalthoff_winkler", VARIANTS))
