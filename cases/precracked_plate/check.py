#!/usr/bin/env python3
"""Runs the plate in points that become particles, and in particles only, and asserts what must hold: the crack starts when it
does in particles only, grows as far and about as fast; energy; what conversion takes; the same on 1, 2 and 3 ranks.

usage: check.py [--executable build/release/pdxsolve] [crack] [coarser] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools

FIRST_BREAK, GROWTH, SPEED = 0.03, 1e-3, 0.10  # against particles only: relative, [m] at either end, relative
DRIFT, CONVERTED = 1e-3, 1e-3  # of the work
PAPER_START = 5e-6, 7e-6  # [s]


def first_break(run):
    """When the first bond had broken, to a look of the history [s]."""
    curve = pdxtools.read_history(run)
    return curve["time"][curve["bonds_broken"] > 0][0]


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "precracked_plate"

    def compare(self, variant):
        """One way of points against particles only."""
        runs = [self.run(name, ranks, ["-output_history_interval", "1"]) for name, ranks in ((variant, 2), ("particles", 1))]
        if None in runs:
            return
        ours, theirs = (pdxtools.read_summary(run[0])["results"] for run in runs)
        self.expect_near("first break", first_break(runs[0][0]), first_break(runs[1][0]), FIRST_BREAK)
        gap = 0.5 * abs(ours["crack_length"] - theirs["crack_length"])
        self.expect(gap <= GROWTH, f"grows by {1e3 * (0.5 * ours['crack_length'] - 5e-3):.2f} mm: {1e3 * gap:.2f} mm beside particles")
        self.expect_near("largest speed", ours["max_crack_speed"], theirs["max_crack_speed"], SPEED)
        self.expect_between("energy_drift_ratio", ours["energy_drift_ratio"], 0.0, DRIFT)
        self.expect_between("conversion, of the work", abs(ours["energy_relocated_ratio"]), 0.0, CONVERTED)
        self.expect_between("starts [s]", ours["crack_start_time"], *PAPER_START)

    def crack(self):
        """Points as far apart as particles."""
        self.compare("case")

    def coarser(self):
        """Points twice as far apart."""
        self.compare("coarser")

    def ranks(self):
        """Alike on any number of ranks, the same bonds broken."""
        self.expect_alike("case", ("crack_length", "fracture_energy", "kinetic_energy"), 1e-9)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("crack", "coarser", "ranks"), "PART"))
