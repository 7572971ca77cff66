#!/usr/bin/env python3
"""Runs one and two cracks of several lengths, by elements that end where cells meet and by patches at the tips, prints K beside
what is published, and draws hole_crack.png beside this file.

usage: study.py [--executable build/release/pdxsolve] [--out out/hole_crack] [--only elements,particles|none]
K over s sqrt(pi a), of a plate as wide as ours (published figures are taken there by Feddersen's factor). Half a minute.
"""

import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import case_study
import exact
import pdxtools
import pdxtools.draw
import matplotlib
import mesh
import numpy as np
import published

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STEP = 2 * published.SQUARE / 21
LENGTHS = {"elements": [mesh.layers_at(8)[k] for k in (5, 6, 7)] + [0.00575, 0.00575 + 8 * STEP],
           "particles": [0.00575 + k * STEP for k in (4, 8)]}  # fmt: skip
STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10, "savefig.dpi": 160,
         "savefig.bbox": "tight", "axes.spines.top": False, "axes.spines.right": False}  # fmt: skip
COLOURS = {1: "#4477aa", 2: "#ee6677"}


def directory(out, way, cracks, a):
    return out / f"{way}_{cracks}_{1e6 * a:.0f}"


def run(executable, out, way, cracks, a):
    """One crack begins in the hole."""
    first = -published.RADIUS - a if cracks == 2 else 0.5 * published.RADIUS
    ring = (4 * STEP, 6 * STEP) if a > 0.006 else (0.3 * a, 0.8 * a)
    command = [*case_check.ALONE, executable, "-options_file", "cases/hole_crack/plate.opts", "-case", "hole_crack",
               "-crack_names", "c", "-crack_c_points", f"{first:.12g},0,{published.RADIUS + a:.12g},0", "-post_modes",
               "-post_j_domain", f"{ring[0]},{ring[1]}", "-output_dir", str(directory(out, way, cracks, a)), "-quiet"]  # fmt: skip
    if way == "particles":
        command += ["-adapt_seed", "tip", "-pd_horizon_ratio", "3"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{way}, {cracks} cracks of {a:g} m: {done.stderr}")


def factor(out, way, cracks, a):
    tip = pdxtools.read_summary(directory(out, way, cracks, a))["results"]["tips"][-1]
    return tip["k1_domain"] / published.unit(a) / published.width(a)


def picture(out):
    lengths = np.geomspace(0.4e-3, 20e-3, 60)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(5.6, 3.8), layout="constrained")
        axes.plot(published.NEWMAN[:, 0] - 1, [published.newman(a) for a in published.RADIUS * (published.NEWMAN[:, 0] - 1)], "k+",
                  label="Newman, two cracks")  # fmt: skip
        for cracks in (1, 2):
            axes.plot(lengths / published.RADIUS, [exact.factor(a / published.RADIUS, cracks) for a in lengths], "-", color=COLOURS[cracks],
                      linewidth=1, label=f"dislocations, {('one crack', 'two cracks')[cracks - 1]}")  # fmt: skip
            axes.plot(lengths / published.RADIUS, [published.bowie(a, cracks) for a in lengths], "--", color=COLOURS[cracks], linewidth=1)
            axes.plot(lengths / published.RADIUS, [published.no_hole(a, cracks) for a in lengths], ":", color=COLOURS[cracks], linewidth=1)
        for way, mark in (("elements", "o"), ("particles", "s")):
            for cracks in (1, 2):
                axes.plot([a / published.RADIUS for a in LENGTHS[way]], [factor(out, way, cracks, a) for a in LENGTHS[way]], mark,
                          color=COLOURS[cracks], markersize=5, markerfacecolor="none", label=f"{way}, {cracks}")  # fmt: skip
        axes.set(xlabel="$a/R$", ylabel=r"$K_I / (\sigma \sqrt{\pi a})$", xlim=(0, 2), ylim=(0.9, 3.4))
        axes.annotate("dashed: formula after Bowie\ndotted: a crack, no hole", (0.05, 1.0), fontsize=8)
        axes.legend(frameon=False, fontsize=8)
        figure.savefig(HERE / "hole_crack.png")


def main():
    arguments = case_study.Parser(__doc__, "hole_crack", LENGTHS).read()
    out = arguments.out
    for cracks in (1, 2):
        for way, lengths in LENGTHS.items():
            for a in lengths:
                if way in arguments.only:
                    run(arguments.executable, out, way, cracks, a)
                found, length = factor(out, way, cracks, a), a / published.RADIUS
                known = exact.factor(length, cracks), published.newman(a) if cracks == 2 else None, published.bowie(a, cracks)
                beside = " | ".join("-" if k is None else f"{k:.4f} ({100 * (found / k - 1):+.2f} %)" for k in known)
                print(f"| {cracks} | {way} | {length:.3f} | {found:.4f} | {beside} | {published.no_hole(a, cracks):.4f} |", flush=True)
    picture(out)


if __name__ == "__main__":
    main()
