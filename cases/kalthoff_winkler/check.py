#!/usr/bin/env python3
"""Runs Kalthoff and Winkler's plate at 1 mm and asserts what must hold: both cracks start when the papers' does, turn outwards
by 60 to 75 degrees, mirror each other and are slower than Rayleigh waves.

usage: check.py [--executable build/release/pdxsolve] [cracks] [initial]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import fields
import numpy as np

SPACING = 1e-3  # [m]
ANGLES = (60.0, 75.0)  # of the way from a notch to where its crack ends [degrees]
START = (20e-6, 30e-6)  # the paper: about 25 us
# 50 rows of 3 particles of 1 mm at 22 m/s, 10 mm thick, 7800 kg/m^3
INITIAL_ENERGY = 0.5 * 7800.0 * 0.05 * 0.003 * 0.01 * 22.0**2


class Check(case_check.Check):
    """The parts of the check, each a method."""

    def __init__(self, executable, scratch):
        super().__init__("kalthoff_winkler", executable, scratch)

    def check(self, part):
        getattr(self, part)()

    def cracks(self):
        run = self.run("case", 2, ["-output_interval", "1000"], "cracks")
        if not run:
            return
        results = fields.read_summary(run[0])["results"]
        tips = np.array(results["crack_tips"])
        self.expect(len(tips) == 2, f"{len(tips)} tips")
        gap = max(abs(tips[0, 0] - tips[1, 0]), abs(tips[0, 1] + tips[1, 1]))
        self.expect(gap < 1e-3 * SPACING, f"tips mirror each other: off by {gap:.1e} m")
        upper, lower = (tip["angle_degrees"] for tip in results["tips"])
        self.expect(ANGLES[0] < upper < ANGLES[1], f"the upper crack turns up by {upper:.1f} degrees")
        self.expect(-ANGLES[1] < lower < -ANGLES[0], f"the lower crack turns down by {-lower:.1f} degrees")
        start = results["crack_start_time"]
        self.expect(START[0] < start < START[1], f"starts at {1e6 * start:.2f} us")
        ratio = results["max_crack_speed_ratio"]
        self.expect(0.2 < ratio < 1.0, f"largest speed {ratio:.3f} of the Rayleigh speed")

    def initial(self):
        """Three rows that only start fast have not the energy for a crack."""
        run = self.run("initial", 1, [], "initial")
        if not run:
            return
        results = fields.read_summary(run[0])["results"]
        self.expect_near("initial energy", results["initial_energy"], INITIAL_ENERGY, 1e-9)
        self.expect(results["fracture_energy"] == 0.0, "no bond breaks")
        self.expect(results["energy_drift_ratio"] < 0.02, f"energy drift {results['energy_drift_ratio']:.1e}")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("cracks", "initial"), "PART"))
