#!/usr/bin/env python3
"""Runs the sphere that falls on a plate and asserts what must hold: it bounces, and nothing is lost.

usage: check.py [--executable build/release/pdxsolve] [bounce] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check

DRIFT = 2e-3


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "sphere_on_plate"

    def bounce(self):
        """It comes back."""
        run = self.run("case", 2)
        if not run:
            return
        _, curve = self.books(run[0], drift=DRIFT)
        speed = curve["velocity_sphere_z"]
        self.expect_between("speed of the sphere at the end over that before [-]", -speed[-1] / speed[0], 0.5, 1.0)
        push = curve["contact_sphere_plate_impulse_z"]
        mass = push[-1] / (speed[-1] - speed[0])
        self.expect_near("impulse over the change of its speed, mass [kg]", mass, 1000.0 * 4.0 / 3.0 * 3.14159265 * 0.016**3, 0.05)

    def ranks(self):
        """Alike on any number of ranks."""
        self.expect_alike("case", ("strain_energy", "kinetic_energy"), 1e-8)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("bounce", "ranks"), "PART"))
