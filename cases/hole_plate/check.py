#!/usr/bin/env python3
"""Runs the plate with a hole in points that become particles, and all in particles, and asserts what must hold: when it breaks
beside the hole, how fast the cracks run, what becomes particles.

usage: check.py [--executable build/release/pdxsolve] [crack] [printed]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

FIRST_BREAK, FAR, SPEED = 0.03, 1e-3, 0.10  # against particles only: relative, [m], relative
START = 14.5e-6, 17.5e-6  # [s]; an independent program 15.1 to 15.7
SPEEDS = 1400.0, 1900.0  # [m/s]; likewise 1556 to 1795
DRIFT = 1e-3
TIP_DAMAGE = 0.38  # of the paper
SHARE, PRINTED_SHARE = 0.45, 0.9  # of the plate that becomes particles: at most, at least


def first_break(run):
    curve = pdxtools.read_history(run)
    return curve["time"][curve["bonds_broken"] > 0][0]


def tips(run):
    """Times of the pictures and how far to the right particles are damaged then [s], [m]."""
    times, places = [], []
    for step in range(pdxtools.step_count(run)):
        time, blocks = pdxtools.read_step(run, step)
        if "particles" not in blocks:
            continue
        damaged = blocks["particles"]["damage"] > TIP_DAMAGE
        if damaged.any():
            times.append(time)
            places.append(blocks["particles"].points[damaged, 0].max())
    return np.array(times), np.array(places)


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "hole_plate"

    def crack(self):
        """Against all in particles."""
        often = ["-output_history_interval", "1", "-output_interval", "20"]
        runs = [self.run("case", 2, often), self.run("particles", 1, often)]
        if None in runs:
            return
        results = pdxtools.read_summary(runs[0][0])["results"]
        self.expect_near("first break", first_break(runs[0][0]), first_break(runs[1][0]), FIRST_BREAK)
        self.expect_between("first break [s]", first_break(runs[0][0]), *START)
        (time, place), (_, theirs) = tips(runs[0][0]), tips(runs[1][0])
        self.expect(abs(place[-1] - theirs[-1]) <= FAR, f"tip at {place[-1]:.4f} m, in particles {theirs[-1]:.4f} m")
        between = (place > 0.008) & (place < 0.02)
        speed = np.polyfit(time[between], place[between], 1)[0]
        self.expect_between("mean speed on the way [m/s]", speed, *SPEEDS)
        self.expect_between("energy_drift_ratio", results["energy_drift_ratio"], 0.0, DRIFT)
        curve = pdxtools.read_history(runs[0][0])
        share = curve["particles"][-1] / (curve["particles"][-1] + curve["points"][-1])
        self.expect(share <= SHARE, f"{share:.3f} of the plate are particles at the end")

    def printed(self):
        """The wave that comes in is above the printed strength."""
        run = self.run("printed", 1)
        if run:
            curve = pdxtools.read_history(run[0])
            share = curve["particles"][-1] / (curve["particles"][-1] + curve["points"][-1])
            self.expect(share >= PRINTED_SHARE, f"{share:.3f} of the plate are particles at the end")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("crack", "printed"), "PART"))
