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
    figure, (speed, energy) = pictures.plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
    pictures.curves({label: out / name for name, label in RUNS.items()}, "crack_speed", 1.0, speed)
    speed.axhline(RAYLEIGH, color="k", linewidth=0.8, label="Rayleigh waves")
    speed.set(ylabel="speed of the fastest tip [m/s]", ylim=(0, None))
    speed.legend(frameon=False, fontsize=8)
    pictures.energies(out / "fine", energy)
    figure.savefig(HERE / "curves.png")


if __name__ == "__main__":
    main()
