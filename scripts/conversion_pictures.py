#!/usr/bin/env python3
"""Draws runs in which points become particles, as the paper's figures do: of the first run what is points (grey) and what
particles (blue) at each time with fields, and the damage at the last; of all runs the share of particles and the growth of the
crack, or how many bonds are broken, over time. With --bar a bar along x instead: kinds, damage and displacement at each time.
With --ends the damage of every run at its last time, side by side.

usage: conversion_pictures.py RUN [RUN ...] --out picture.png [--bar | --ends] [--label TEXT ...] [--first SECONDS]
"""

import argparse
import pathlib

import pdxtools
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

POINTS, PARTICLES = "#b9bfc7", "#2b6cb0"
PANEL = 2.4  # [inch]


def steps(run, first):
    """Times [s] and blocks of the steps with fields from a time on."""
    read = (pdxtools.read_step(run, number) for number in range(pdxtools.step_count(run)))
    return [(time, blocks) for time, blocks in read if time >= first and "points" in blocks]


def damage(block):
    return block["damage"] + block["precrack"]


def places(block):
    return 1e3 * block.points[:, :2]


def gap(x):
    """Between neighbours on a line of the lattice."""
    gaps = np.diff(np.unique(np.round(x[:, 0], 9)))
    return gaps[gaps > 1e-6].min() if len(gaps) else 1.0


def plane(axes, time, blocks, by_damage):
    every = np.concatenate([places(block) for block in blocks.values() if len(block.points)])
    for name, colour in (("points", POINTS), ("particles", PARTICLES)):
        block = blocks.get(name)
        if block is None or not len(block.points):
            continue
        look = {"c": colour}
        if by_damage and name == "particles":
            look = {"c": damage(block), "cmap": "inferno_r", "vmin": 0.0, "vmax": 0.6}
        across = np.ptp(every[:, 0]) / gap(places(block))
        axes.scatter(*places(block).T, s=(72.0 * PANEL / across) ** 2, marker="s", linewidths=0, rasterized=True, **look)
    axes.set_xlim(every[:, 0].min(), every[:, 0].max())
    axes.set_ylim(every[:, 1].min(), every[:, 1].max())
    axes.set_aspect("equal")
    axes.set_title(f"{1e6 * time:.3g} µs" + (", damage" if by_damage else ""), fontsize=9)
    axes.tick_params(labelsize=7)


def curves(axes, runs, labels):
    for run, label in zip(runs, labels):
        history = pdxtools.read_history(run)
        time = 1e6 * history["time"]
        sites = history["particles"] + history["points"] * (history["particles"][-1] - history["particles"][0]) / (
            history["points"][0] - history["points"][-1] or 1.0
        )
        axes[0].plot(time, 100.0 * history["particles"] / sites, label=label, lw=1)
        grows = "crack_length" in history
        grown = 1e3 * (history["crack_length"] - history["crack_length"][0]) if grows else history["bonds_broken"]
        axes[1].plot(time, grown, label=label, lw=1)
    for each, what in zip(axes, ("particles [%]", "growth of all tips [mm]" if grows else "broken bonds")):
        each.set_xlabel("time [µs]", fontsize=8)
        each.set_ylabel(what, fontsize=8)
        each.tick_params(labelsize=7)
        each.legend(fontsize=7, frameon=False)


def bar(run, first):
    shown = steps(run, first)
    figure, grid = plt.subplots(len(shown), 3, figsize=(12, 1.1 * len(shown) + 0.6), sharex=True, squeeze=False,
                                layout="constrained")
    for row, (time, blocks) in zip(grid, shown):
        row[0].set_ylabel(f"{1e3 * time:.3g} ms", fontsize=8)
        for name, marker in (("points", "o"), ("particles", "x")):
            block = blocks.get(name)
            if block is None or not len(block.points):
                continue
            x = places(block)[:, 0]
            look = {"facecolors": "none", "edgecolors": "k"} if marker == "o" else {"c": PARTICLES}
            row[0].scatter(*places(block).T, s=7, marker=marker, lw=0.4, **look)
            row[1].plot(x, damage(block) if name == "particles" else 0.0 * x, ".", ms=2, c=PARTICLES if name == "particles" else POINTS)
            row[2].plot(x, 1e3 * block["displacement"][:, 0], ".", ms=2, c=PARTICLES if name == "particles" else POINTS)
        row[1].set_ylim(-0.05, 1.05)
        for axes in row:
            axes.tick_params(labelsize=7)
    for axes, what in zip(grid[0], ("points (o), particles (x)", "damage", "displacement [mm]")):
        axes.set_title(what, fontsize=9)
    for axes in grid[-1]:
        axes.set_xlabel("x [mm]", fontsize=8)
    return figure


def picture(runs, labels, first):
    shown = steps(runs[0], first)
    count = len(shown) + 1
    extent = np.ptp(places(shown[0][1]["points"]), axis=0)
    figure = plt.figure(figsize=(PANEL * count, PANEL * extent[1] / extent[0] + 2.6), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=[PANEL * extent[1] / extent[0] + 0.4, 2.2])
    panels = upper.subplots(1, count, sharex=True, sharey=True)
    for axes, (time, blocks) in zip(panels, shown):
        plane(axes, time, blocks, False)
    plane(panels[-1], *shown[-1], True)
    curves(lower.subplots(1, 2), runs, labels)
    return figure


def ends(runs, labels, first):
    last = [steps(run, first)[-1] for run in runs]
    extent = np.ptp(places(last[0][1]["points"]), axis=0)
    figure, panels = plt.subplots(1, len(runs), figsize=(PANEL * len(runs), PANEL * extent[1] / extent[0] + 0.5),
                                  sharex=True, sharey=True, squeeze=False, layout="constrained")
    for axes, (time, blocks), label in zip(panels[0], last, labels):
        plane(axes, time, blocks, True)
        axes.set_title(f"{label}, {1e6 * time:.3g} µs", fontsize=9)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", type=pathlib.Path)
    parser.add_argument("--out", required=True)
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument("--bar", action="store_true")
    kind.add_argument("--ends", action="store_true")
    parser.add_argument("--label", nargs="+")
    parser.add_argument("--first", type=float, default=0.0)
    arguments = parser.parse_args()
    labels = arguments.label or [run.name for run in arguments.runs]
    if len(labels) != len(arguments.runs):
        parser.error(f"{len(labels)} labels for {len(arguments.runs)} runs")
    if arguments.bar:
        figure = bar(arguments.runs[0], arguments.first)
    else:
        figure = (ends if arguments.ends else picture)(arguments.runs, labels, arguments.first)
    figure.savefig(arguments.out, dpi=110)
    print(arguments.out)


if __name__ == "__main__":
    main()
