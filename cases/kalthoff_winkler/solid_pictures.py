#!/usr/bin/env python3
"""Draws the plate in space: damage in its middle layer, and the damaged particles where they have moved to.

usage: solid_pictures.py [--run out/kalthoff_winkler_solid]
Writes solid.png beside this file and prints the angles of the cracks.
"""

import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import pdxtools
import matplotlib
import numpy as np
import solid_cracks

matplotlib.use("Agg")
import matplotlib.pyplot as plt

DAMAGED = 0.3
MAGNIFICATION = 10.0
STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10, "savefig.dpi": 200,
         "savefig.bbox": "tight"}  # fmt: skip


def middle(axes, points, damage):
    """Damage of the middle layer as an image: its particles are those of a lattice."""
    layers = solid_cracks.layers(points)
    layer = layers[len(layers) // 2]
    order = np.lexsort((points[layer, 0], points[layer, 1]))
    x, y = np.unique(np.round(points[layer, 0], 9)), np.unique(np.round(points[layer, 1], 9))
    image = damage[layer][order].reshape(len(y), len(x))
    extent = [1e3 * v for v in (x[0], x[-1], y[0], y[-1])]
    shown = axes.imshow(image, origin="lower", extent=extent, cmap="magma_r", vmin=0.0, vmax=0.6)
    angles = [solid_cracks.crack_angle(points[layer], damage[layer], tip) for tip in solid_cracks.TIPS]
    for tip, angle, up in zip(solid_cracks.TIPS, angles, (1.0, -1.0)):
        axes.plot([0.0, 1e3 * tip[0]], [1e3 * tip[1]] * 2, color="0.3", linewidth=1)
        reach = 60.0 * np.array([np.cos(np.radians(angle)), up * np.sin(np.radians(angle))])
        axes.plot(*(1e3 * np.array(tip)[:, None] + reach[:, None] * [0.0, 1.0]), "--", color="#4477aa", linewidth=0.8)
        axes.annotate(f"{angle:.1f}°", 1e3 * np.array(tip) + reach, color="#4477aa", ha="left", va="center")
    axes.set(xlabel="x [mm]", ylabel="y [mm]", title="damage, middle layer")
    plt.colorbar(shown, ax=axes, shrink=0.7)
    print(f"angles in the middle layer: {angles[0]:.2f} and {angles[1]:.2f} degrees")


def space(axes, points, displacement, damage):
    moved = 1e3 * (points + MAGNIFICATION * displacement)
    skin = points[:, 2] >= points[:, 2].max() - 1e-9
    rim = skin & (np.arange(len(points)) % 3 == 0)
    axes.scatter(moved[rim, 0], moved[rim, 2], moved[rim, 1], s=0.3, c="0.7", linewidths=0)
    cracked = damage > DAMAGED
    axes.scatter(moved[cracked, 0], moved[cracked, 2], moved[cracked, 1], s=0.8, c=damage[cracked], cmap="magma_r",
                 vmin=0.0, vmax=0.6, linewidths=0)  # fmt: skip
    axes.set_box_aspect((1.0, 0.3, 2.0))
    axes.view_init(elev=18, azim=-60)
    axes.set_axis_off()
    axes.set(title=f"damage above {DAMAGED}, moved {MAGNIFICATION:g}x")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", default="out/kalthoff_winkler_solid")
    run = parser.parse_args().run
    time, blocks = pdxtools.read_step(run)
    block = blocks["particles"]
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(8.0, 5.6), layout="constrained")
        middle(figure.add_subplot(1, 2, 1), block.points, block["damage"])
        space(figure.add_subplot(1, 2, 2, projection="3d"), block.points, block["displacement"], block["damage"])
        figure.suptitle(f"t = {1e6 * time:.1f} µs")
        figure.savefig(HERE / "solid.png")


if __name__ == "__main__":
    main()
