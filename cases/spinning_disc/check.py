#!/usr/bin/env python3
"""Runs the disc that spins and asserts what must hold: energy, angular momentum, and the closed form of its strain.

usage: check.py [--executable build/release/pdxsolve] [turns] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import numpy as np

ANGULAR, DRIFT, SAME_END = 1e-12, 1e-4, 2e-5
YOUNG, DENSITY, RADIUS, SPIN = 1e6, 1000.0, 0.025, 126.4911064


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "spinning_disc"

    def turns(self):
        """Three turns."""
        for ranks in (1, 2):
            run = self.run("case", ranks)
            if not run:
                return
            results, curve = self.books(run[0], drift=DRIFT)
            angular = curve["angular_momentum_z"]
            self.expect_between("angular momentum lost", np.abs(angular / angular[0] - 1.0).max(), 0.0, ANGULAR)
            end = results["kinetic_energy"] + results["strain_energy"]
            self.expect_near("energy at the end [J]", end, results["initial_energy"], SAME_END)
        # Thrown without strain the disc breathes about its strain at that spin: mean energy 3/2 of it at small spins.
        nu = 1.0 / 3.0
        still = np.pi * (DENSITY * SPIN**2) ** 2 * RADIUS**6 / YOUNG * (1.0 - nu) * (7.0 + nu) / 96.0
        mean = curve["energy_points"].mean()
        self.expect_between("mean strain energy over that of a steady spin", mean / still, 1.2, 1.8)

    def ranks(self):
        """Alike on any number of ranks."""
        self.expect_alike("case", ("strain_energy", "kinetic_energy"), 1e-10)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("turns", "ranks"), "PART"))
