#!/usr/bin/env python3
"""Runs the discs and asserts what must hold: how fast they fly apart, momentum, energy, and the same on 1, 2 and 3
ranks.

usage: check.py [--executable build/release/pdxsolve] [soft] [stiff] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check

REBOUND = 0.94, 0.97  # an independent program has .962
LEAST = 0.09, 0.18  # [J] kinetic energy in the middle: Karamelo has .134 with 20 cells, .175 with 80
LEAST_TIME = 1.85, 2.15  # [s] likewise, 1.9 and 2.1
END = 2.05, 2.45  # [J] likewise, 2.37 and 2.11
MOMENTUM, DRIFT = 1e-13, 1e-3


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "two_discs"

    def soft(self):
        """Kinetic energy of soft discs, beside the peers'."""
        run = self.run("case", 2)
        if not run:
            return
        _, curve = self.books(run[0], MOMENTUM, DRIFT)
        kinetic = curve["energy_kinetic_points"]
        least = kinetic.argmin()
        self.expect_between("least kinetic energy [J]", kinetic[least], *LEAST)
        self.expect_between("at [s]", curve["time"][least], *LEAST_TIME)
        self.expect_between("kinetic energy at the end [J]", kinetic[-1], *END)

    def stiff(self):
        """Discs that fly apart again."""
        run = self.run("stiff", 1)
        if run:
            self.expect_between("rebound", self.books(run[0], MOMENTUM, DRIFT)[0]["rebound_ratio"], *REBOUND)

    def ranks(self):
        """Alike on any number of ranks."""
        self.expect_alike("stiff", ("rebound_ratio", "kinetic_energy"), 1e-10)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("soft", "stiff", "ranks"), "PART"))
