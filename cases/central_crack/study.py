#!/usr/bin/env python3
"""Runs both loadings, coupled and with particles only, on one rank and prints what the cracks did.

usage: study.py [--executable build/release/pdxsolve] [--out out/central_crack] [--only case,pd_only]
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import crack_study

FIELDS = ["-output_fields", "-output_interval", "200"]
VARIANTS = {name: (name, FIELDS) for name in ("case", "pd_only", "second", "second_pd_only")}

if __name__ == "__main__":
    sys.exit(crack_study.main(__doc__, "central_crack", VARIANTS))
