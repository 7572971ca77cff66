#!/usr/bin/env python3
"""Says what the run of case.opts has come to beside the published curve, and draws curves.png and panel.png beside this file.

usage: pictures.py [--out out/shear_panel]
"""

import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import pdxtools.draw
import published
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10, "savefig.dpi": 160,
         "savefig.bbox": "tight", "axes.spines.top": False, "axes.spines.right": False}  # fmt: skip


def curves(mine, known, effective):
    with plt.rc_context(STYLE):
        figure, (said, shape) = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
        said.plot(1e4 * mine.displacement, 1e3 * mine.force, color="#4477aa", label=r"$G_c$ = 1e-3 N/mm")
        scale = (effective / published.GC) ** 0.5
        said.plot(1e4 * scale * mine.displacement, 1e3 * scale * mine.force, "--", color="#4477aa", label=rf"$G_c$ = {effective:.1e} N/mm")
        said.plot(1e4 * known.displacement, 1e3 * known.force, color="#ee6677", label="published, phase field")
        said.set(xlabel="displacement, 1e-4 mm", ylabel="force, 1e-3 N")
        said.legend(frameon=False, fontsize=8)
        shape.plot(mine.displacement / mine.at_peak, mine.force / mine.peak, color="#4477aa", label="particles that go along")
        shape.plot(known.displacement / known.at_peak, known.force / known.peak, color="#ee6677", label="published, phase field")
        shape.set(xlabel="displacement, of that at the peak", ylabel="force, of the peak", xlim=(0, 2.2))
        shape.legend(frameon=False, fontsize=8, loc="lower right")
        figure.savefig(HERE / "curves.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/shear_panel")
    run = parser.parse_args().out
    mine, known = published.ours(run), published.published()
    for name, curve in (("ours", mine), ("published", known)):
        print(f"{name}: slope {curve.slope:.2f} N/mm, peak {curve.peak:.4g} N at {curve.at_peak:.4g} mm, secant there "
              f"{curve.secant()[curve.top - 1]:.3f} of the slope, then down to {curve.force[curve.low] / curve.peak:.3f} of the "
              f"peak at {curve.displacement[curve.low] / curve.at_peak:.2f} of its displacement")  # fmt: skip
    print(f"Gc that puts our peak at the published force: {published.GC * (known.peak / mine.peak) ** 2:.3g} N/mm")
    effective = published.toughness_of(known, run)
    print(f"energy per area of crack: ours {published.toughness_of(mine, run):.3g}, published {effective:.3g} N/mm")
    curves(mine, known, effective)
    pdxtools.draw.draw("crack", [pdxtools.draw.Run(run)], HERE / "panel.png")


if __name__ == "__main__":
    main()
