#!/usr/bin/env python3
"""Runs cracks from 0 to 75 degrees, with K by the ring around patches, by squares in patches, by finer particles, and by
elements alone; prints what each is off by from the closed form, and draws modes.png beside this file.

usage: study.py [--executable build/release/pdxsolve] [--out out/mixed_modes] [--only ring,fine,contours,elements|none]
Off: of K_I at 0 degrees, and of its own value; T of the stress; the worse of both tips. A minute on one core.
"""

import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import case_study
import closed_form
import pdxtools
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ANGLES = (0, 15, 30, 45, 60, 75)
WAYS = {
    "ring": ("case", [], "ring around the patch"),
    "fine": ("case", ["-pd_spacing", "6.25e-5"], "ring, spacing / 4"),
    "contours": ("contours", [], "squares in the patch"),
    "elements": ("elements", [], "elements alone"),
}
LOOKS = {"ring": "o", "fine": "s", "contours": "^", "elements": "x"}
COLOURS = {"ring": "#4477aa", "fine": "#228833", "contours": "#ee6677", "elements": "#888888"}
STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10, "savefig.dpi": 160,
         "savefig.bbox": "tight", "axes.spines.top": False, "axes.spines.right": False}  # fmt: skip


def run(executable, out, way, degrees):
    variant, options, _ = WAYS[way]
    command = [*case_check.ALONE, executable, "-options_file", f"cases/mixed_modes/{variant}.opts", *options,
               "-crack_crack_points", closed_form.points(degrees), "-output_dir", str(out / f"{way}_{degrees}"), "-quiet"]  # fmt: skip
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{way}, {degrees} degrees: {done.stderr}")


def found(out, way, degrees):
    """K_I, K_II, T of each tip; of the middle square where there are several."""
    tips = pdxtools.read_summary(out / f"{way}_{degrees}")["results"]["tips"]
    if way == "contours":
        return np.array([tip["modes_by_contour"][1][1:] for tip in tips])
    return np.array([(tip["k1_domain"], tip["k2_domain"], tip["t_stress_domain"]) for tip in tips])


def picture(out):
    with plt.rc_context(STYLE):
        figure, (values, errors) = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
        angles = np.linspace(0, 80, 161)
        exact = np.array([closed_form.modes(a) for a in angles]) / (closed_form.K0, closed_form.K0, closed_form.STRESS)
        for column, (label, side) in enumerate(((r"$K_I/K_0$", "left"), (r"$K_{II}/K_0$", "right"), (r"$T/\sigma$", "right"))):
            values.plot(angles, exact[:, column], "k-", linewidth=0.9)
            values.annotate(label, (angles[44], exact[44, column]), xytext=(0, 6), textcoords="offset points", ha=side)
        scale = (closed_form.K0, closed_form.K0, closed_form.STRESS)
        for way in ("ring", "contours"):
            for degrees in ANGLES:
                mean = found(out, way, degrees).mean(axis=0) / scale
                values.plot([degrees] * 3, mean, LOOKS[way], color=COLOURS[way], markersize=5, markerfacecolor="none")
        values.set(xlabel="angle of the crack, degrees", ylim=(-1.1, 1.15))
        for way in WAYS:
            worst = [100 * np.abs(found(out, way, a)[:, :2] - closed_form.modes(a)[:2]).max() / closed_form.K0 for a in ANGLES]
            errors.semilogy(ANGLES, worst, LOOKS[way] + "-", color=COLOURS[way], markersize=5, linewidth=0.8, label=WAYS[way][2])
        errors.axhline(1.0, color="k", linewidth=0.7, linestyle=":")
        errors.set(xlabel="angle of the crack, degrees", ylabel=r"$K$ off by, % of $K_0$", ylim=(0.015, 3))
        errors.legend(frameon=False, fontsize=8)
        figure.savefig(HERE / "modes.png")


def main():
    arguments = case_study.Parser(__doc__, "mixed_modes", WAYS).read()
    out = arguments.out
    for way in WAYS:
        for degrees in ANGLES:
            if way in arguments.only:
                run(arguments.executable, out, way, degrees)
            off = np.abs(found(out, way, degrees) - closed_form.modes(degrees)).max(axis=0)
            own = [100 * off[k] / abs(closed_form.modes(degrees)[k]) if degrees or k == 0 else 0.0 for k in (0, 1)]
            print(f"| {WAYS[way][2]} | {degrees} | {100 * off[0] / closed_form.K0:.2f} ({own[0]:.2f}) | "
                  f"{100 * off[1] / closed_form.K0:.2f} ({own[1]:.2f}) | {100 * off[2] / closed_form.STRESS:.2f} |", flush=True)  # fmt: skip
    picture(out)


if __name__ == "__main__":
    main()
