#!/usr/bin/env python3
"""Runs the bars that collide and asserts what must hold: plane waves arrive when they should, what the contact hands over,
momentum and energy; bulk viscosity takes the overshoot.

usage: check.py [--executable build/release/pdxsolve] [waves] [viscous] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

MOMENTUM, DRIFT = 1e-13, 1e-3
SPEED, LENGTH, AREA = 100.0, 0.1, 0.008  # [m/s], [m], [m^2]
FORCE = 1000.0 * SPEED * 0.5 * AREA  # [N] rho c v / 2


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "impact_bars"

    def waves(self):
        """Force between the bars, how long it lasts, and what it hands over."""
        for ranks in (1, 2):
            run = self.run("case", ranks, ["-output_history_interval", "1"])
            if not run:
                return
            results, curve = self.books(run[0], MOMENTUM, DRIFT)
            force = -curve["contact_hammer_anvil_force_x"]
            time = curve["time"]
            pushed = (time > 0.4e-3) & (time < 1.6e-3)
            self.expect_near("force between the bars [N]", force[pushed].mean(), FORCE, 0.01)
            impulse = -curve["contact_hammer_anvil_impulse_x"]
            self.expect_near("time of contact [s]", impulse[-1] / FORCE, 2.0 * LENGTH / SPEED, 0.02)
            half = np.interp(0.5 * impulse[-1], impulse, time)
            self.expect_near("half of the impulse is there [s]", half, LENGTH / SPEED, 0.02)
            self.expect_between("speed of the bar that was hit [m/s]", curve["velocity_anvil_x"][-1], 0.97, 1.0)

    def push(self, variant):
        """Results and history of a run, and the largest push anywhere, over rho c v / 2."""
        run = self.run(variant, 2, ["-output_fields", "-output_interval", "2", "-output_history_interval", "1"])
        if not run:
            return None
        results, curve = self.books(run[0], MOMENTUM, DRIFT)
        most = 0.0
        for number in range(pdxtools.step_count(run[0])):
            points = pdxtools.read_step(run[0], number)[1]["points"]
            most = max(most, -points["stress"][:, 0].min())
        return results, curve, most / (FORCE / AREA)

    def viscous(self):
        """What bulk viscosity does to the overshoot behind the waves, and what it takes."""
        plain, viscous = self.push("case"), self.push("viscous")
        if not plain or not viscous:
            return
        self.expect_between("largest push without viscosity", plain[2], 1.2, 1.4)
        self.expect_between("largest push with viscosity", viscous[2], 1.0, 1.1)
        taken = viscous[0]["viscous_energy"] / viscous[1]["energy_kinetic_points"][0]
        self.expect_between("taken by viscosity, of the energy at the start", taken, 0.02, 0.05)

    def ranks(self):
        """Alike on any number of ranks."""
        self.expect_alike("case", ("rebound_ratio", "kinetic_energy"), 1e-10)
        self.expect_alike("viscous", ("rebound_ratio", "kinetic_energy", "viscous_energy"), 1e-10)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("waves", "viscous", "ranks"), "PART"))
