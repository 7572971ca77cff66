#!/usr/bin/env python3
"""Draws the runs that study.py left: force and crack length over the opening, and the crack's growth in one run.

usage: pictures.py [--out out/dcb] [--runs row3,paper_row3,m6,pd_only] [--growth row3] [--loads 0.3,0.6,1]
Writes curves.png and growth.png beside this file.
"""

import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

OPENING = 1.5  # of one clamp at full load [um]
# Linear elastic fracture mechanics, p-FE of the upper half, clamp of 0.03 mm: crack [mm], opening at which the energy
# release rate is 5 J/m^2 [um], force then [N/m].
LEFM = np.array(
    [
        (0.30, 0.46758, 1843.7),
        (0.35, 0.56243, 1681.3),
        (0.40, 0.66720, 1548.8),
        (0.45, 0.78178, 1439.2),
        (0.50, 0.90656, 1348.5),
        (0.55, 1.04306, 1275.2),
        (0.60, 1.19538, 1221.0),
        (0.65, 1.37326, 1192.7),
        (0.70, 1.59922, 1205.5),
    ]
)
PAPER_PEAK, PAPER_CRACK = 2086.0, 0.6487  # row 3 [N/m, mm]
LABELS = {"row3": "row 3, default", "paper_row3": "row 3, papers' scheme", "m6": "row 3, m = 6", "pd_only": "particles only"}
COLOURS = ["#4477aa", "#ee6677", "#228833", "#ccbb44"]
ENRICHED, PLAIN = "#f0b860", "#e8e8e8"
MAGNIFICATION = 20.0
STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10, "savefig.dpi": 200,
         "savefig.bbox": "tight", "axes.spines.top": False, "axes.spines.right": False}  # fmt: skip


def curves(directory, names):
    figure, (force, crack) = plt.subplots(1, 2, figsize=(9.2, 3.5), layout="constrained")
    shown = LEFM[LEFM[:, 1] <= OPENING]
    last = [np.interp(OPENING, LEFM[:, 1], values) for values in LEFM.T[1:]]
    rise = [(0.0, 0.0), *shown[:, 1:], last]
    force.plot(*np.transpose(rise), "k--", linewidth=1, label="LEFM")
    crack.plot([0.0, *LEFM[:, 1]], [0.3, *LEFM[:, 0]], "k--", linewidth=1, label="LEFM")
    for name, colour in zip(names, COLOURS):
        if not (directory / name / "history.csv").exists():
            continue
        columns = pdxtools.read_history(directory / name)
        opening = OPENING * columns["load"]
        thickness = 1e-3  # [m]
        force.plot([0, *opening], [0, *(columns["reaction_top_y"] / thickness)], color=colour, linewidth=1,
                   label=LABELS.get(name, name))  # fmt: skip
        crack.fill_between(opening, 1e3 * columns["crack_first_intact"], 1e3 * columns["crack_farthest_broken"],
                           color=colour, linewidth=0.8, label=LABELS.get(name, name))  # fmt: skip
    force.axhline(PAPER_PEAK, color="0.5", linewidth=0.8, linestyle=":", label="the paper's peak")
    crack.plot([OPENING], [PAPER_CRACK], "k*", markersize=8, label="the paper's end")
    force.set(xlabel="opening of a clamp [µm]", ylabel="force per thickness [N/m]", xlim=(0, OPENING), ylim=(0, None))
    crack.set(xlabel="opening of a clamp [µm]", ylabel="crack length [mm]", xlim=(0, 1.02 * OPENING), ylim=(0.28, 0.7))
    for axes in (force, crack):
        axes.grid(linewidth=0.3)
        axes.legend(frameon=False, fontsize=8)
    figure.savefig(HERE / "curves.png")
    plt.close(figure)


def moved(block):
    return 1e3 * (block.points[:, :2] + MAGNIFICATION * block["displacement"][:, :2])


def draw_mesh(axes, blocks):
    """Elements grey, the two parts of cut ones coloured, each where its own displacement takes it."""
    mesh = blocks["mesh"]
    x = moved(mesh)
    axes.add_collection(
        PolyCollection(x[mesh.cells[mesh["use"] == 0]], facecolors=PLAIN, edgecolors="0.6", linewidths=0.15)
    )
    if "cut_cells" in blocks:
        cut = blocks["cut_cells"]
        axes.add_collection(
            PolyCollection(moved(cut)[cut.cells], facecolors=ENRICHED, edgecolors="0.35", linewidths=0.15)
        )


def draw_particles(axes, particles, figure, last):
    x = moved(particles)
    spacing = 1e3 * np.diff(np.unique(np.round(particles.points[:, 0], 12))).min()
    points = 72.0 * axes.get_position().width * figure.get_figwidth() * spacing / np.ptp(axes.get_xlim())
    seen = axes.scatter(x[:, 0], x[:, 1], s=(1.25 * points) ** 2, c=particles["damage"], cmap="viridis", vmin=0, vmax=0.5,
                        marker="s", linewidths=0, rasterized=True)  # fmt: skip
    if last:
        figure.colorbar(seen, ax=axes, fraction=0.03, pad=0.02, label="damage, precrack left out")


def growth(run, loads):
    figure, rows = plt.subplots(len(loads), 1, figsize=(6.2, 2.9 * len(loads)), squeeze=False)
    for axes, load in zip(rows[:, 0], loads):
        time, blocks = pdxtools.read_step(run, pdxtools.step_at(run, load))
        axes.set(aspect="equal", xlim=(-0.02, 0.92), ylim=(-0.04, 0.49), xlabel="$x$ [mm]", ylabel="$y$ [mm]")
        axes.set_title(f"opening of a clamp {OPENING * time:.3f} µm, deformation × {MAGNIFICATION:g}", fontsize=9)
        draw_mesh(axes, blocks)
        draw_particles(axes, blocks["particles"], figure, True)
    figure.tight_layout()
    figure.savefig(HERE / "growth.png")
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/dcb")
    parser.add_argument("--runs", default="row3,paper_row3,m6,pd_only")
    parser.add_argument("--growth", default="row3")
    parser.add_argument("--loads", default="0.3,0.6,1")
    arguments = parser.parse_args()
    plt.rcParams.update(STYLE)
    curves(arguments.out, arguments.runs.split(","))
    growth(arguments.out / arguments.growth, [float(load) for load in arguments.loads.split(",")])


if __name__ == "__main__":
    main()
