#!/usr/bin/env python3
"""Runs the sphere that falls on a plate and asserts what must hold: it bounces, and nothing is lost.

usage: check.py [--executable build/release/pdxsolve] [bounce] [hertz] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import math
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

    def hertz(self):
        """The largest force between two spheres, and how long they touch [Hertz 1882]."""
        run = self.run("hertz", 2)
        if not run:
            return
        _, curve = self.books(run[0], drift=DRIFT)
        radius, young, poisson, density, speed = 0.01, 1e7, 0.25, 1000.0, 4.0
        stiffness = 4.0 / 3.0 * young / (2.0 * (1.0 - poisson**2)) * math.sqrt(0.5 * radius)
        mass = 0.5 * density * 4.0 / 3.0 * math.pi * radius**3
        deepest = (5.0 * mass * speed**2 / (4.0 * stiffness)) ** 0.4
        force = abs(curve["contact_lower_upper_force_z"])
        self.expect_near("largest force [N]", force.max(), stiffness * deepest**1.5, 0.15)
        touching = curve["time"][force > 0.0]
        self.expect_near("time of touch [s]", touching[-1] - touching[0], 2.9432 * deepest / speed, 0.15)

    def ranks(self):
        """Alike on any number of ranks."""
        self.expect_alike("case", ("strain_energy", "kinetic_energy"), 1e-8)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("bounce", "hertz", "ranks"), "PART"))
