#!/usr/bin/env python3
"""Draws the runs that study.py left: damage, speed and energies. Writes damage.png and curves.png beside this file.

usage: pictures.py [OUT_DIR, default out/kalthoff_winkler]
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import crack_pictures as pictures

RUNS = {"case": "dx = 1 mm", "fine": "dx = 0.5 mm"}
RAYLEIGH = 2778.76  # [m/s]


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/kalthoff_winkler")
    pictures.damage_maps(out / "fine", (25e-6, 50e-6, 75e-6, 100e-6), HERE / "damage.png", columns=4, size=(2.2, 3.8))
    runs = {label: out / name for name, label in RUNS.items()}
    pictures.speed_and_energies(runs, RAYLEIGH, out / "fine", HERE / "curves.png")


if __name__ == "__main__":
    main()
