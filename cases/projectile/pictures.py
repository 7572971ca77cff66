#!/usr/bin/env python3
"""Draws elements, particles and points of the case at the times of its fields: what each is, displaced, and damage.

usage: pictures.py RUN_DIRECTORY [projectile.png]
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

SCALE = 5.0  # of displacements, so that they are seen
PLAIN, CUT = 0, 1  # of `use`


def draw(axes, time, blocks):
    mesh = blocks["mesh"]
    at = mesh.points[:, :2] + SCALE * mesh["displacement"][:, :2]
    shown = np.isin(mesh["use"], (PLAIN, CUT))
    axes.add_collection(PolyCollection(at[mesh.cells[shown]], facecolors="#dce6f2", edgecolors="#7f9fc6", linewidths=0.15))
    points = blocks["points"]
    axes.scatter(*(points.points[:, :2] + SCALE * points["displacement"][:, :2]).T, s=0.25, c="#3a9a5b", linewidths=0)
    particles = blocks["particles"]
    axes.scatter(*(particles.points[:, :2] + SCALE * particles["displacement"][:, :2]).T, s=0.35, linewidths=0,
                 c=particles["damage"] + particles["precrack"], cmap="inferno_r", vmin=0.0, vmax=0.6)
    axes.set_title(f"{1e6 * time:.0f} µs", fontsize=9)
    axes.set_aspect("equal")
    axes.set_xlim(-0.105, 0.115)
    axes.set_ylim(-0.108, 0.108)
    axes.axis("off")


def main():
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    run = sys.argv[1]
    count = pdxtools.step_count(run)
    figure, axes = plt.subplots(1, count, figsize=(3.2 * count, 3.3))
    for number, each in enumerate(np.atleast_1d(axes)):
        draw(each, *pdxtools.read_step(run, number))
    figure.suptitle("elements (blue), particles (by damage), material points (green); displacements five times", fontsize=9)
    figure.tight_layout()
    target = sys.argv[2] if len(sys.argv) > 2 else str(pathlib.Path(run) / "projectile.png")
    figure.savefig(target, dpi=130)
    print(target)


if __name__ == "__main__":
    main()
