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
ARRIVAL = 52e-3 / np.sqrt(190e9 / (1.0 - 1.0 / 9.0) / 7800.0)  # [s] of a plane wave, 52 mm behind the face
LATE = 0.025  # of it: elements of 2 mm, and contact, delay its half height by 2.0 % (1 % is wanted)
PATCHES = 1.5e-3  # of the largest displacement, what patches change at 20 us


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "projectile"

    def fracture(self):
        """Cracks run."""
        probe = ["-probe_names", "behind", "-probe_behind_at", "0.052,0", "-probe_behind_field", "velocity"]
        run = self.run("case", 2, ["-output_history_interval", "1", *probe])
        if not run:
            return
        results, curve = self.books(run[0], MOMENTUM, DRIFT)
        impulse = -np.interp(10e-6, curve["time"], curve["contact_projectile_mesh_impulse_x"]) / (MASS * VELOCITY)
        self.expect_between("impulse at 10 us, of m v", impulse, *IMPULSE)
        time, speed = np.loadtxt(pathlib.Path(run[0]) / "probe_behind.csv", delimiter=",", skiprows=1)[:, 1:3].T
        half = int(np.argmax(speed >= 0.25 * VELOCITY))  # the plane wave's is half of the projectile's
        arrival = np.interp(0.25 * VELOCITY, speed[half - 1 : half + 1], time[half - 1 : half + 1])
        self.expect_near("half of the wave arrives [s]", arrival, ARRIVAL, LATE)
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
