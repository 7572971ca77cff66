#!/usr/bin/env python3
"""Runs the variants one after the other on one rank and prints where and when each branches.

usage: study.py [--executable build/release/pdxsolve] [--out out/branching] [--only full,paper]
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import crack_study

FIELDS = ["-output_fields", "-output_interval", "25"]
# name: options file and what is said after it
VARIANTS = {
    "full": ("full", FIELDS),
    "rows322": ("rows322", []),
    "paper": ("paper", []),
    "paper_rows320": ("paper", ["-mesh_lower", "0,-0.02", "-mesh_upper", "0.1,0.02"]),
    "medium": ("medium", []),
    "smoke": ("smoke", []),
}

if __name__ == "__main__":
    sys.exit(crack_study.main(__doc__, "branching", VARIANTS))
