#!/usr/bin/env python3
"""Runs pulses of two widths over a block of particles and over one across the strip, and a square that rings, in points and in
elements by each coupling, and prints the tables: what comes back, what is left behind, energy and stable step.

usage: study.py [--executable build/release/pdxsolve] [--out out/coupling] [--only points_energy_8,...]
Each run leaves its directory in the output directory; with --only none the table of what is there.
"""

import sys

import coupling  # scripts/ are on the path from here on
import case_study

HOWS = ("alone", *coupling.COUPLINGS)
VARIANTS = {
    f"{carrier}_{how}_{width}{shape}": (carrier, coupling.pulse(carrier, width, how, block))
    for carrier in coupling.CARRIERS
    for how in HOWS
    for width in coupling.WIDTHS
    for shape, block in (("", coupling.BLOCK), ("_band", coupling.BAND))
    if how != "alone" or not shape
}
VARIANTS |= {
    f"{carrier}_{how}_{pattern}": (f"{carrier}_drift", coupling.ringing(carrier, pattern, how))
    for carrier in coupling.CARRIERS
    for how in coupling.COUPLINGS
    for pattern in coupling.PATTERNS
    if carrier == "points" or how != "handshake" or pattern == "block"
}
COLUMNS = ["carrier", "coupling", "scene", "comes back [%]", "left behind [%]", "energy in 1e4 steps", "stable step"]


def line(out, name):
    """Cells of the table, or None where a run is missing."""
    carrier, how, scene = name.replace("face_mass", "face-mass").split("_", 2)
    if not (out / name / "summary.json").exists():
        return None
    if scene in coupling.PATTERNS:
        found, step = coupling.drift(out / name)
        return [carrier, how, scene, "", "", f"{found:.1e}", f"{step:.3f}"]
    width = int(scene.split("_")[0])
    alone = out / f"{carrier}_alone_{width}"
    back = f"{100 * coupling.reflection(out / name):.3f}"
    left = f"{100 * coupling.left_behind(out / name, alone, width):.3f}" if how != "alone" and alone.exists() else ""
    return [carrier, how, f"pulse {scene.replace('_', ', ')}", back, left, "", ""]


if __name__ == "__main__":
    sys.exit(case_study.main(__doc__, "coupling", VARIANTS, COLUMNS, line))
