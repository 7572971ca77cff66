#!/usr/bin/env python3
"""Runs the plate of elements with patches at its notches that a body of material points strikes, and asserts what must hold:
momentum, energy, impulse against the plane wave's, when the wave arrives, patches against none, when and where cracks run, the
same on 1, 2 and 3 ranks.

usage: check.py [--executable build/release/pdxsolve] [fracture] [elastic] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

MASS, VELOCITY = 7800.0 * 0.1 * 0.05 * 0.01, 44.0  # of the projectile
MOMENTUM, DRIFT = 1e-12, 1e-3
IMPULSE = 0.24, 0.265  # of m v at 10 us: .248 of an independent program, .262 of plane waves
SPEED_LEFT = -0.23, -0.11  # of v, of the projectile at the end
START, ANGLE = (20e-6, 28e-6), (63.0, 72.0)
PATCHES = 1.5e-3  # of the largest displacement, what patches change at 20 us


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "projectile"

    def fracture(self):
        """Cracks run."""
        run = self.run("case", 2, ["-output_history_interval", "1"])
        if not run:
            return
        results, curve = self.books(run[0], MOMENTUM, DRIFT)
        impulse = -np.interp(10e-6, curve["time"], curve["contact_projectile_mesh_impulse_x"]) / (MASS * VELOCITY)
        self.expect_between("impulse at 10 us, of m v", impulse, *IMPULSE)
        self.expect_between("velocity left, of v", curve["velocity_projectile_x"][-1] / VELOCITY, *SPEED_LEFT)
        self.expect_between("cracks start [s]", results["crack_start_time"], *START)
        for tip in results["tips"]:
            self.expect_between("angle [degrees]", abs(tip["angle_degrees"]), *ANGLE)

    def elastic(self):
        """Patches against none, at 20 us."""
        runs = [self.run(name, 1) for name in ("elastic", "elements")]
        if None in runs:
            return
        ours, theirs = (pdxtools.read_step(run[0])[1]["mesh"] for run in runs)
        gap = np.linalg.norm(ours["displacement"] - theirs["displacement"], axis=1)
        self.expect_between("patches change", gap.max() / np.linalg.norm(theirs["displacement"], axis=1).max(), 0.0, PATCHES)

    def ranks(self):
        """Alike on any number of ranks, the same bonds broken."""
        self.expect_alike("case", ("fracture_energy", "kinetic_energy", "crack_length"), 1e-8)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("fracture", "elastic", "ranks"), "PART"))
