#!/usr/bin/env python3
"""Runs the bar that flies and rings and asserts what must hold: energy and momentum, and the ringing itself.

usage: check.py [--executable build/release/pdxsolve] [flight] [ringing] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import numpy as np

DRIFT, MOMENTUM = 1e-9, 1e-13
SPEED = 10.0  # [m/s] of sound
LENGTH, SHARE = 0.1, 0.15  # [m], of SPEED: each half against the middle


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "flying_bar"

    def moved(self, run):
        """Results and history; what holds the bar straight does not hold it back."""
        results, curve = self.books(run, drift=DRIFT)
        along = curve["momentum_x"]
        self.expect_between("momentum lost", np.abs(along / along[0] - 1.0).max(), 0.0, MOMENTUM)
        return results, curve

    def flight(self):
        """Energy and momentum, 60 cells on."""
        for ranks in (1, 2):
            run = self.run("case", ranks)
            if not run:
                return
            _, curve = self.moved(run[0])
            flown = np.trapezoid if hasattr(np, "trapezoid") else np.trapz
            cells = flown(curve["velocity_bar_x"], curve["time"]) / 2e-3
            self.expect_between("cells flown across", cells, 55.0, 61.0)

    def ringing(self):
        """Ten thousand steps: the energies stay, and the bar rings as long as sound takes to go through it twice."""
        run = self.run("case", 1, ["-ts_max_time", "1.8", "-output_history_interval", "1"], "long")
        if not run:
            return
        results, curve = self.moved(run[0])
        self.expect(results["time"] / results["step_length"] > 9999, "ten thousand steps")
        first = curve["time"] < 0.02
        stored = curve["energy_points"][first]
        peak = curve["time"][first][stored.argmax()]
        self.expect_near("time of the largest strain energy [s]", peak, LENGTH / 2 / SPEED, 0.03)
        self.expect_near("largest strain energy [J]", stored.max(), 0.5 * 1000.0 * 0.4e-3 * (SHARE * SPEED) ** 2, 0.03)

    def ranks(self):
        """Alike on any number of ranks."""
        self.expect_alike("case", ("strain_energy", "kinetic_energy"), 1e-10)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("flight", "ringing", "ranks"), "PART"))
