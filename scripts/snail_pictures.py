#!/usr/bin/env python3
"""Draws a run whose patches follow the crack: BASENAME.png, a strip of panels, and BASENAME.gif, all steps with fields.

usage: snail_pictures.py OUT_DIR -o BASENAME [--at 8 16 21 26] [--panels 4] [--window X0 Y0 X1 Y1] [--strip]
Elements are a thin grid, particles are coloured by damage, and a line is the crack: in elements where it cuts them, in
particles where it was followed so far. The run needs -output_fields (in time with -output_times or -output_interval).
"""

import argparse
import pathlib
import sys

import crack_pictures
import pdxtools
import numpy as np
from matplotlib.collections import LineCollection
from pdxtools.draw import COVERED, draw_cells
from PIL import Image

plt = crack_pictures.plt
ELEMENT, GRID, CRACK = "#f6f6f2", "#b4b4b0", "#e8442e"
WIDE = 1.5  # plates longer than this times their height are drawn in two columns
NEAR = 1e-9  # of the plate's length, or of the largest displacement: nothing
COLOURS = 256  # of the animation
FRAME, LAST_FRAME = 150, 2000  # [ms]


class Run:
    """What all steps share; lengths in the unit of the axes."""

    def __init__(self, directory, window=None):
        self.path, self.name = pdxtools.fields_path(directory), directory
        self.refuse_if(not self.path.exists(), "has no fields: run with -output_fields")
        self.steps = pdxtools.step_count(self.path)
        self.summary = pdxtools.read_summary(self.path)
        self.in_time = "load_steps_accepted" not in self.summary.get("results", {})
        self.refuse_if(self.steps == 0, "has fields at no time yet")
        first = self.blocks(0)[1]
        self.refuse_if("mesh" not in first, "has no elements, so no patch in them")
        self.refuse_if("particles" not in first, "has no particles at its first step with fields")
        self.refuse_if("damage" not in first["particles"], "has no damage: give a toughness, so that bonds break")
        x = first["mesh"].points[:, :2]
        self.metre, self.unit = (1e3, "mm") if np.ptp(x, axis=0).max() < 0.5 else (1.0, "m")
        self.lower, self.upper = self.metre * x.min(axis=0), self.metre * x.max(axis=0)
        if window:
            self.lower, self.upper = np.reshape(window, (2, 2))
            self.refuse_if((self.upper <= self.lower).any(), f"has no inside in --window: give x0 y0 x1 y1 in {self.unit}")
        path = self.path.with_name("crack_path.csv")
        self.path_columns = pdxtools.read_curve(path) if path.exists() else None

    def refuse_if(self, wrong, why):
        if wrong:
            sys.exit(f"snail_pictures.py: {self.name} {why}")

    def blocks(self, number):
        return pdxtools.read_step(self.path, number)

    def aspect(self):
        width, height = self.upper - self.lower
        return width / height

    def ways(self, now):
        """Where each tip has been until now."""
        if self.path_columns is None:
            return []
        when = "time" if "time" in self.path_columns else "load"
        tip, time, x, y = (self.path_columns[name] for name in ("tip", when, "x", "y"))
        seen = time <= now * (1 + 1e-9)
        return [self.metre * np.column_stack([x, y])[seen & (tip == t)] for t in np.unique(tip)]

    def heading(self):
        moved = self.summary.get("relocations", 0)
        name = f"{self.summary.get('case', '')}, {moved} relocations" if moved else self.summary.get("case", "")
        return f"{name}: elements as a grid, particles by their damage, the crack as a line"


def crack_in_elements(mesh, cut):
    """Edges along which elements are parted: where parts on both sides of the crack meet, or, for a crack along edges of
    elements, where both ends of an edge move otherwise than the mesh."""
    unit = NEAR * np.ptp(mesh.points[:, :2], axis=0).max()
    nodes = [tuple(at) for at in np.round(mesh.points[:, :2] / unit).astype(int)]
    moves = dict(zip(nodes, mesh["displacement"]))
    names = [tuple(at) for at in np.round(cut.points[:, :2] / unit).astype(int)]
    opened = NEAR * max(np.abs(block["displacement"]).max() for block in (mesh, cut))
    parted = [name in moves and np.abs(u - moves[name]).max() > opened for name, u in zip(names, cut["displacement"])]
    edges, sides = {}, {}
    for cell in cut.cells:
        for a, b in zip(cell, np.roll(cell, -1)):
            edge = tuple(sorted((names[a], names[b])))
            if edge[0] == edge[1]:
                continue
            sides.setdefault(edge, set()).add(cut["side"][a])
            if len(sides[edge]) == 2 or (parted[a] and parted[b]):
                edges[edge] = cut.points[[a, b], :2]
    return list(edges.values())


def draw(axes, run, number):
    """One step: its particles' colours, for the bar."""
    now, blocks = run.blocks(number)
    mesh = blocks["mesh"]
    elements = mesh.cells[mesh["use"] != COVERED]
    draw_cells(axes, run.metre * mesh.points[:, :2], elements, ELEMENT, edgecolors=GRID, linewidths=0.2)
    seen, count = None, 0
    if "particles" in blocks:
        particles = blocks["particles"]
        count = len(particles.points)
        x, damage = run.metre * particles.points[:, :2], particles["damage"] + particles["precrack"]
        for patch in np.unique(particles["patch"]):
            mine = particles["patch"] == patch
            seen = crack_pictures.lattice_image(axes, x[mine], damage[mine])
    lines = run.ways(now)
    if "cut_cells" in blocks:
        lines.extend(run.metre * edge for edge in crack_in_elements(mesh, blocks["cut_cells"]))
    axes.add_collection(LineCollection(lines, colors=CRACK, linewidths=0.7, capstyle="round"))
    axes.set(xlim=(run.lower[0], run.upper[0]), ylim=(run.lower[1], run.upper[1]), aspect="equal")
    when = f"{1e6 * now:.1f} µs" if run.in_time else f"load {now:.3f}"
    axes.set_title(f"{when}: {count:,} particles, {len(elements):,} elements", fontsize=9, pad=3)
    return seen


def label(figure, run, grid, seen):
    for axes in grid[-1]:
        axes.set_xlabel(f"$x$ [{run.unit}]", labelpad=1)
    for axes in grid[:, 0]:
        axes.set_ylabel(f"$y$ [{run.unit}]", labelpad=1)
    figure.colorbar(seen, ax=grid, fraction=0.03, pad=0.015, aspect=30, label="damage, precrack included")
    figure.suptitle(run.heading(), fontsize=10)


def panels(run, rows, columns):
    width = 6.0 + 1.2 * columns  # [inch]
    height = ((width - 1.6) / columns - 0.15) / run.aspect()
    return plt.subplots(rows, columns, figsize=(width, rows * (height + 0.28) + 0.6), squeeze=False, sharex=True,
                        sharey=True, layout="constrained")  # fmt: skip


def chosen_steps(run, options):
    if options.at:
        unit = 1e-6 if run.in_time else 1.0
        return [pdxtools.step_at(run.path, unit * at) for at in options.at]
    return [int(k) for k in np.round(np.linspace(0, run.steps - 1, min(options.panels, run.steps)))]


def strip(run, numbers, path):
    columns = min(len(numbers), 2 if run.aspect() > WIDE else 4)
    rows = -(-len(numbers) // columns)
    figure, grid = panels(run, rows, columns)
    for axes in grid.flat[len(numbers) :]:
        axes.set_axis_off()
    seen = [draw(axes, run, number) for axes, number in zip(grid.flat, numbers)]
    run.refuse_if(not any(seen), "has no particles at these times")
    label(figure, run, grid, next(filter(None, seen)))
    figure.savefig(path)
    plt.close(figure)
    print(f"wrote {path}")


def animation(run, path):
    """All steps, the last one longer; one palette for all, so that nothing flickers."""
    figure, grid = panels(run, 1, 1)
    figure.set_dpi(110)
    axes = grid[0, 0]
    label(figure, run, grid, draw(axes, run, 0))
    figure.canvas.draw()
    figure.set_layout_engine("none")  # all frames lie alike
    pictures = []
    for number in range(run.steps):
        for artist in (*axes.collections, *axes.images):
            artist.remove()
        draw(axes, run, number)
        figure.canvas.draw()
        pictures.append(Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB"))
    plt.close(figure)
    palette = pictures[-1].quantize(COLOURS, dither=Image.Dither.NONE)
    frames = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    times = [FRAME] * (run.steps - 1) + [LAST_FRAME]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=times, loop=0, optimize=True)
    print(f"wrote {path}: {run.steps} frames, {pathlib.Path(path).stat().st_size / 1e6:.2f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="OUT_DIR")
    parser.add_argument("-o", "--output", required=True, metavar="BASENAME", help="pictures to write, without .png, .gif")
    parser.add_argument("--at", type=float, nargs="+", help="times of the panels in µs, in statics loads (default: even)")
    parser.add_argument("--panels", type=int, default=4, choices=range(1, 17), metavar="N", help="of the strip, 1 to 16")
    parser.add_argument("--window", type=float, nargs=4, metavar="X", help="piece of the plate, in the unit of the axes")
    parser.add_argument("--strip", action="store_true", help="the strip alone, no animation")
    options = parser.parse_args()
    if not pathlib.Path(options.output).parent.is_dir():
        parser.error(f"-o {options.output}: there is no such directory")
    try:
        run = Run(options.run, options.window)
    except (OSError, KeyError) as error:
        sys.exit(f"snail_pictures.py: cannot read the fields of {options.run}: {error}")
    strip(run, chosen_steps(run, options), f"{options.output}.png")
    if not options.strip:
        animation(run, f"{options.output}.gif")


if __name__ == "__main__":
    main()
