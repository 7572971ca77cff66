#!/usr/bin/env python3
"""Runs the panel coarsely and asserts its stiffness, where the crack starts and which way it goes.

usage: check.py [--executable build/release/pdxsolve] [smoke]
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))

import case_check
import pdxtools
import published


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "shear_panel"

    def smoke(self):
        run = self.run("smoke", 1)
        if not run:
            return
        known, mine = published.published(), published.ours(run[0], full=1e-3)
        self.expect_near("slope [N/mm]", mine.slope, known.slope, 0.005)
        self.expect_near("secant at the peak over slope", mine.secant()[mine.top - 1], known.secant()[known.top - 1], 0.05)
        # In elements J of the notch is 0.01215 J/m^2 at 1e-4 mm; a crack that kinks gets up to 1.6 times as much.
        straight = 1e-4 * math.sqrt(1.0 / 0.01215)
        self.expect_between("peak at [mm]", mine.at_peak, straight / math.sqrt(1.6), 1.1 * straight)
        tip = pdxtools.read_summary(run[0])["results"]["tips"][0]
        way = [tip["at"][d] - tip["start"][d] for d in (0, 1)]
        self.expect_between("way of the crack, degrees", math.degrees(math.atan2(way[1], way[0])), -65.0, -40.0)
        relocations = pdxtools.read_summary(run[0])["relocations"]
        self.expect(relocations >= 2, f"{relocations} relocations: the patch goes along")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ["smoke"]))
