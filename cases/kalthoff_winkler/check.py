#!/usr/bin/env python3
"""Runs Kalthoff and Winkler's plate at 1 mm and asserts what must hold: both cracks start when the papers' does, turn outwards
by 60 to 75 degrees, mirror each other and are slower than Rayleigh waves. The same in space, at 2 mm, on 1, 2 and 3 ranks.

usage: check.py [--executable build/release/pdxsolve] [cracks] [initial] [points] [solid]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np
import solid_cracks

SPACING = 1e-3  # [m]
ANGLES = (60.0, 75.0)  # of the way from a notch to where its crack ends [degrees]
COARSE_ANGLES = (58.0, 75.0)  # in space at 2 mm; the full plate has 63.1 to 63.6 [degrees]
START = (20e-6, 30e-6)  # the paper: about 25 us
# 50 rows of 3 particles of 1 mm at 22 m/s, 10 mm thick, 7800 kg/m^3
INITIAL_ENERGY = 0.5 * 7800.0 * 0.05 * 0.003 * 0.01 * 22.0**2


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "kalthoff_winkler"

    def cracks(self):
        run = self.run("case", 2, ["-output_interval", "1000"], "cracks")
        if not run:
            return
        results = pdxtools.read_summary(run[0])["results"]
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
        results = pdxtools.read_summary(run[0])["results"]
        self.expect_near("initial energy", results["initial_energy"], INITIAL_ENERGY, 1e-9)
        self.expect(results["fracture_energy"] == 0.0, "no bond breaks")
        self.expect(results["energy_drift_ratio"] < 0.02, f"energy drift {results['energy_drift_ratio']:.1e}")

    def points(self):
        """Points that become particles, against particles only at the same step."""
        short = ["-ts_dt", "5e-8", "-ts_max_time", "50e-6", "-output_interval", "100000"]
        runs = [self.run("points", 2, short, "points"), self.run("case", 1, short, "particles")]
        if None in runs:
            return
        ours, theirs = (pdxtools.read_summary(run[0])["results"] for run in runs)
        self.expect_near("start", ours["crack_start_time"], theirs["crack_start_time"], 0.03)
        gap = abs(abs(ours["crack_angle_degrees"]) - abs(theirs["crack_angle_degrees"]))
        self.expect(gap <= 3.0, f"angle {abs(ours['crack_angle_degrees']):.1f} degrees: {gap:.1f} beside particles only")
        self.expect_near("largest speed", ours["max_crack_speed"], theirs["max_crack_speed"], 0.10)
        self.expect(ours["energy_drift_ratio"] < 1e-3, f"energy drift {ours['energy_drift_ratio']:.1e}")

    def solid_damage(self, ranks):
        """Directory, points and damage of the plate in space, in an order that does not depend on the ranks."""
        run = self.run("solid_smoke", ranks)
        if not run:
            return None
        block = pdxtools.read_step(run[0])[1]["particles"]
        order = np.argsort(block.natural_point)
        return run[0], block.points[order], block["damage"][order]

    def solid(self):
        alone = self.solid_damage(1)
        if not alone:
            return
        directory, points, damage = alone
        for ranks in (2, 3):
            if other := self.solid_damage(ranks):
                gap = np.abs(other[2] - damage).max()
                self.expect(gap <= 1e-12, f"damage on {ranks} ranks: within {gap:.1e}")
        angles = solid_cracks.angles(points, damage)
        low, high = angles.min(), angles.max()
        self.expect(COARSE_ANGLES[0] < low and high < COARSE_ANGLES[1], f"{low:.1f} to {high:.1f} degrees in all layers")
        self.expect(np.abs(angles[:, 0] - angles[:, 1]).max() < 0.1, "the cracks mirror each other")
        self.expect(np.abs(angles - angles[::-1]).max() < 0.1, "back and front are alike")
        results = pdxtools.read_summary(directory)["results"]
        tip = abs(results["crack_angle_degrees"])
        self.expect(COARSE_ANGLES[0] < tip < COARSE_ANGLES[1], f"the tip has gone off by {tip:.1f} degrees")
        ratio = results["max_crack_speed_ratio"]
        self.expect(0.2 < ratio < 1.0, f"largest speed {ratio:.3f} of the Rayleigh speed")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("cracks", "initial", "points", "solid"), "PART"))
