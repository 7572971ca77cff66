#!/usr/bin/env python3
"""Draws the runs that study.py left: the pulse at three times as in the paper's Fig. 7 (waves.png), and where its
energy is as in Fig. 8 (energy.png), both beside this file.

usage: pictures.py [--out out/pulse]
"""

import argparse
import pathlib

import waves  # finds pdxtools, and the python that has the next
import matplotlib
import numpy as np
import pdxtools

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = pathlib.Path(__file__).resolve().parent
RUNS = {"rollers_case": ("default scheme", "#4477aa"), "rollers_paper": ("papers' scheme", "#ee6677")}
ALONE = "rollers_fe_only"
PAPER_RESIDUAL, PAPER_MOST = 1.26e-5, 0.20
STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10, "savefig.dpi": 160,
         "savefig.bbox": "tight", "axes.spines.top": False, "axes.spines.right": False}  # fmt: skip


def patch_marks(axes):
    axes.axvspan(*(1e3 * x for x in waves.PATCH), color="0.93", zorder=0, linewidth=0)


def plate(axes, run, time):
    """u_x of the whole plate."""
    _, x, u = waves.on_nodes(run, time)
    columns = len(np.unique(np.round(x[:, 0], 9)))
    order = np.lexsort((x[:, 0], x[:, 1]))
    shown = 1e6 * u[order, 0].reshape(-1, columns)
    extent = [0, 1e3 * x[:, 0].max(), 0, 1e3 * x[:, 1].max()]
    image = axes.imshow(shown, origin="lower", extent=extent, cmap="RdBu_r", vmin=-100, vmax=100)
    left, right = (1e3 * at for at in waves.PATCH)
    axes.add_patch(plt.Rectangle((left, 100), right - left, 50, fill=False, linewidth=0.6))
    axes.set(title=f"$t$ = {1e6 * time:.3g} µs", xlabel="$x$ [mm]", ylabel="$y$ [mm]")
    return image


def displacements(axes, out, time):
    _, x, alone = waves.on_line(out / ALONE, time)
    fine = np.linspace(0.0, waves.LENGTH, 2000)
    axes.plot(1e3 * fine, 1e6 * waves.exact(fine, time), "k-", linewidth=0.8, label="exact")
    axes.plot(1e3 * x, 1e6 * alone, color="0.5", linewidth=1, linestyle="--", label="elements alone")
    for run, (label, colour) in RUNS.items():
        _, x, u = waves.on_line(out / run, time)
        axes.plot(1e3 * x, 1e6 * u, color=colour, linewidth=1, label=label)
    axes.set(xlim=(0, 500), ylim=(-10, 110), ylabel="$u_x$ [µm]")


def distances(axes, out, time):
    _, x, alone = waves.on_line(out / ALONE, time)
    axes.semilogy(1e3 * x, np.abs(alone - waves.exact(x, time)) / waves.AMPLITUDE * 100, color="0.5", linewidth=0.8,
                  linestyle="--", label="elements alone from the exact pulse")  # fmt: skip
    for run, (label, colour) in RUNS.items():
        _, x, u = waves.on_line(out / run, time)
        axes.semilogy(1e3 * x, np.abs(u - alone) / waves.AMPLITUDE * 100, color=colour, linewidth=0.8, label=label)
    axes.set(xlim=(0, 500), ylim=(1e-4, 10), xlabel="$x$ [mm]", ylabel="distance from\nelements alone [%]")


def pulse(out):
    figure, grid = plt.subplots(3, 3, figsize=(11, 7), layout="constrained", height_ratios=(1.2, 1, 1))
    for column, time in zip(grid.T, waves.TIMES):
        image = plate(column[0], out / "rollers_case", time)
        displacements(column[1], out, time)
        distances(column[2], out, time)
        for axes in column[1:]:
            patch_marks(axes)
            axes.grid(linewidth=0.3)
    figure.colorbar(image, ax=grid[0, :], fraction=0.02, pad=0.01, label="$u_x$ [µm]")
    grid[1, 0].legend(frameon=False, fontsize=8)
    grid[2, 0].legend(frameon=False, fontsize=8)
    figure.savefig(HERE / "waves.png")
    plt.close(figure)


def energies(out):
    figure, (shares, residuals) = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
    for run, (label, colour) in RUNS.items():
        columns = pdxtools.read_history(out / run)
        time, inside = waves.pd_energy(out / run)
        elements = (columns["energy_kinetic_elements"] + columns["energy_elements"]) / columns["work"].max()
        shares.plot(1e6 * time, elements, color=colour, linewidth=1, label=f"elements, {label}")
        shares.plot(1e6 * time, inside, color=colour, linewidth=1, linestyle="--", label=f"particles, {label}")
        residuals.semilogy(1e6 * time, np.maximum(inside, 1e-12), color=colour, linewidth=1, label=label)
    residuals.plot([1e6 * waves.LATE], [PAPER_RESIDUAL], "k*", label="the paper's residual")
    shares.plot([1e6 * waves.TIMES[1]], [PAPER_MOST], "k*", label="the paper's largest share")
    for axes in (shares, residuals):
        for time in waves.TIMES:
            axes.axvline(1e6 * time, color="0.6", linewidth=0.6, linestyle=":")
        axes.grid(linewidth=0.3)
        axes.legend(frameon=False, fontsize=8)
        axes.set(xlabel="$t$ [µs]", xlim=(0, 100))
    shares.set_ylabel("energy / energy put in")
    residuals.set(ylabel="energy of the particles / energy put in", ylim=(1e-9, 1))
    figure.savefig(HERE / "energy.png")
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=waves.ROOT / "out/pulse")
    arguments = parser.parse_args()
    plt.rcParams.update(STYLE)
    pulse(arguments.out)
    energies(arguments.out)


if __name__ == "__main__":
    main()
