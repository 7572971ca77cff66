#!/usr/bin/env python3
"""Draws the runs that study.py left: crack lengths, energies and damage. Writes curves.png and damage.png beside this file.

usage: pictures.py [OUT_DIR, default out/central_crack]
"""

import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import crack_pictures as pictures

PULLED = {"coupled": "case", "particles only": "pd_only"}
RELEASED = {"coupled": "second", "particles only": "second_pd_only"}


def main():
    out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/central_crack")
    pictures.damage_maps(out / "case", (8e-6, 12e-6, 14e-6, 16.6e-6), HERE / "damage.png", size=(4.2, 3.8))
    figure, axes = pictures.plt.subplots(1, 3, figsize=(12, 3.4), layout="constrained")
    for plot, runs, title in ((axes[0], PULLED, "edges at 20 m/s"), (axes[1], RELEASED, "800 MPa up to 6 µs")):
        pictures.curves({label: out / name for label, name in runs.items()}, "crack_length", 1e3, plot)
        plot.set(ylabel="crack length, both tips [mm]")
        plot.set_title(title, fontsize=9)
        plot.legend(frameon=False, fontsize=8)
    for colour, (label, name) in zip(pictures.COLOURS, RELEASED.items()):
        h = pictures.pdxtools.read_history(out / name)
        total = sum(h[f"energy_{part}"] for part in
                    ("kinetic_elements", "kinetic_particles", "elements", "bonds", "interface"))  # fmt: skip
        axes[2].plot(1e6 * h["time"], total, color=colour, linewidth=1, label=label)
    axes[2].set(xlabel="time [µs]", ylabel="kinetic and strain energy [J]", xlim=(0, None))
    axes[2].grid(linewidth=0.3)
    axes[2].legend(frameon=False, fontsize=8)
    figure.savefig(HERE / "curves.png")


if __name__ == "__main__":
    main()
