#!/usr/bin/env python3
"""Quenches the strip from 300, 350, 400, 500 and 600 degrees, writes cracks.csv and draws cracks.png beside this file.

usage: study.py [--executable build/release/pdxsolve] [--out out/cold_shock]
A run that lies in --out already is not run again; each takes some minutes. Open MPI must run (`. scripts/mpi_env.sh`).
"""

import argparse
import csv
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import matplotlib
import numpy as np
import shock

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DEGREES = (300, 350, 400, 500, 600)
STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 9, "savefig.dpi": 160, "savefig.bbox": "tight"}
COLUMNS = ("initial [C]", "cracks [-]", "apart [m]", "long ones [-]", "deepest [m]", "mean of long ones [m]", "long ones apart [m]",
           "length in all [m]", "classes [-]")  # fmt: skip


def columns_of(initial, run):
    found = shock.cracks(run)
    depths = found[:, 1]
    long = found[depths >= shock.LONG * depths.max()]
    inside = long[long[:, 0] > shock.END]
    apart = [np.diff(some[:, 0]).mean() for some in (found, inside)]
    return (initial, len(found), apart[0], len(long), depths.max(), long[:, 1].mean(), apart[1], depths.sum(), shock.classes(depths))


def draw(runs):
    """Damage of the quarter that was computed, and of its mirror images."""
    with plt.rc_context(STYLE):
        figure, rows = plt.subplots(len(runs), 1, figsize=(7.2, 1.75 * len(runs)), layout="constrained", sharex=True)
        for axes, (initial, run) in zip(rows, runs.items()):
            particles = pdxtools.read_step(run)[1]["particles"]
            x, damage = 1e3 * particles.points[:, :2], particles["damage"]
            count = [len(np.unique(np.round(x[:, d], 6))) for d in (0, 1)]
            picture = np.full(count[::-1], np.nan)
            dx = x[:, 0].max() * 2 / (2 * count[0] - 1)
            picture[tuple(np.floor(x[:, ::-1] / dx).astype(int).T)] = damage
            picture = np.hstack([picture, picture[:, ::-1]])
            picture = np.vstack([picture, picture[::-1]])
            axes.imshow(picture, origin="lower", extent=(0, 50, 0, 10), cmap="magma_r", vmin=0.0, vmax=0.6, interpolation="nearest")
            axes.set(ylabel=f"{initial} °C", yticks=(0, 5, 10))
        rows[-1].set_xlabel("mm")
        figure.savefig(HERE / "cracks.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=ROOT / "build/release/pdxsolve")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/cold_shock")
    arguments = parser.parse_args()
    runs = {initial: arguments.out / f"t{initial}" for initial in DEGREES}
    for initial, run in runs.items():
        if not (run / "summary.json").exists():
            options = ["-options_file", f"cases/cold_shock/t{initial}.opts", "-output_dir", run, "-quiet"]
            subprocess.run([arguments.executable, *options], cwd=ROOT, check=True)
    with open(HERE / "cracks.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for initial, run in runs.items():
            row = columns_of(initial, run)
            table.writerow([f"{value:.4g}" if isinstance(value, float) else value for value in row])
            print(*(f"{name} {value:.4g}" for name, value in zip(COLUMNS, row)), sep="  ")
    draw(runs)


if __name__ == "__main__":
    main()
