#!/usr/bin/env python3
"""Draws the runs that study.py left: damage, speed and energies. Writes damage.png and curves.png beside this file.

usage: pictures.py [OUT_DIR, default out/branching]
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import crack_pictures as pictures

RAYLEIGH, GLASS = 3058.39, 1580.0  # [m/s]
RUNS = {"full": "default", "rows322": "default, 322 rows", "paper": "the paper's bonds", "medium": "dx = 0.25 mm"}


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/branching")
    pictures.damage_maps(out / "full", (15e-6, 20e-6, 22.5e-6, 25e-6, 32e-6, 40e-6), HERE / "damage.png")
    runs = {label: out / name for name, label in RUNS.items()}
    pictures.speed_and_energies(runs, RAYLEIGH, out / "full", HERE / "curves.png", (GLASS,))


if __name__ == "__main__":
    main()
