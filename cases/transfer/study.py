#!/usr/bin/env python3
"""Runs the transfer of a pulse and of a bump at 2, 5 and 10 spacings an element, and prints the table: energy, noise, error
of the pulse.

usage: study.py [--executable build/release/pdxsolve] [--out out/transfer] [--ranks 1] [--only strip_5_changes,...]
Each run leaves its directory in the output directory; with --only none the table of what is there.
"""

import sys

import transfer  # scripts/ are on the path from here on
import case_study

VARIANTS = {
    f"{scene}_{ratio}_{kind}": ("strip" if scene == "low" else scene, transfer.options(scene, ratio, kind))
    for scene in transfer.KINDS
    for ratio in transfer.RATIOS
    for kind in transfer.KINDS[scene]
}
COLUMNS = [
    "scene",
    "h/dx",
    "changes",
    "energy",
    "energy without sides",
    "energy, mean of one",
    "noise left / v0",
    "error of the pulse",
]


def line(out, name):
    """Cells of the table, or None where a run is missing; one line for each run with changes."""
    scene, ratio, kind = name.split("_")
    runs = {kind: out / f"{scene}_{ratio}_{kind}" for kind in transfer.KINDS[scene]}
    if kind != "changes" or scene == "low" or not all((run / "fields.h5").exists() for run in runs.values()):
        return None
    found = transfer.Transfer(scene, runs)
    low = out / f"low_{ratio}_changes"
    bare = f"{transfer.gained_without_sides(runs['changes'], low):.1e}" if scene == "strip" and low.exists() else ""
    pulse = f"{found.pulse:.1e}" if scene == "strip" else ""
    cells = [scene, ratio, found.relocations, f"{found.energy:.1e}", bare, f"{found.energy_each:.1e}"]
    return [*cells, f"{found.noise:.1e}", pulse]


if __name__ == "__main__":
    sys.exit(case_study.main(__doc__, "transfer", VARIANTS, COLUMNS, line, ranks=True))
