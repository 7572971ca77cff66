#!/usr/bin/env python3
"""Runs Kalthoff and Winkler's plate in space at 2 mm and asserts what must hold: the same damage on 1, 2 and 3 ranks, two
cracks that mirror each other, in every layer at 58 to 75 degrees to their notches, slower than Rayleigh waves.

usage: check_solid.py [--executable build/release/pdxsolve] [smoke]
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import fields
import numpy as np

ANGLES = (58.0, 75.0)  # at 2 mm; the full plate has 63.0 to 63.5 [degrees]
TIPS = ((0.05, 0.125), (0.05, 0.075))  # of the notches [m]
DAMAGED = 0.3  # of particles beside a crack


def crack_angle(points, damage, tip):
    """Angle [degrees] to its notch of the crack from a tip: the line through the tip with the least squares of the
    distances of damaged particles, those of the other crack and of the right edge left out."""
    way = points[:, :2] - tip
    outward = np.sign(tip[1] - 0.1)
    way[:, 1] *= outward
    near = (damage > DAMAGED) & (way[:, 1] > 0.0) & (points[:, 0] < 0.095)
    values, vectors = np.linalg.eigh(way[near].T @ way[near])
    x, y = vectors[:, np.argmax(values)]
    return np.degrees(np.arctan2(abs(y), x * np.sign(y)))


def layers(points):
    """Masks of the layers of particles, from the back to the front."""
    heights = np.round(points[:, 2], 9)
    return [heights == z for z in np.unique(heights)]


class Check(case_check.Check):
    """The parts of the check, each a method."""

    def __init__(self, executable, scratch):
        super().__init__("kalthoff_winkler", executable, scratch)

    def check(self, part):
        getattr(self, part)()

    def damage(self, ranks):
        run = self.run("solid_smoke", ranks)
        if not run:
            return None
        block = fields.read_step(run[0])[1]["particles"]
        order = np.argsort(block.natural_point)
        return run[0], block.points[order], block["damage"][order]

    def smoke(self):
        alone = self.damage(1)
        if not alone:
            return
        directory, points, damage = alone
        for ranks in (2, 3):
            if other := self.damage(ranks):
                gap = np.abs(other[2] - damage).max()
                self.expect(gap <= 1e-12, f"damage on {ranks} ranks: within {gap:.1e}")
        angles = np.array([[crack_angle(points[k], damage[k], tip) for tip in TIPS] for k in layers(points)])
        low, high = angles.min(), angles.max()
        self.expect(ANGLES[0] < low and high < ANGLES[1], f"angles in all layers: {low:.1f} to {high:.1f} degrees")
        self.expect(np.abs(angles[:, 0] - angles[:, 1]).max() < 0.1, "the cracks mirror each other")
        self.expect(np.abs(angles - angles[::-1]).max() < 0.1, "back and front are alike")
        results = fields.read_summary(directory)["results"]
        tip = abs(results["crack_angle_degrees"])
        self.expect(ANGLES[0] < tip < ANGLES[1], f"the tip has gone off by {tip:.1f} degrees")
        ratio = results["max_crack_speed_ratio"]
        self.expect(0.2 < ratio < 1.0, f"largest speed {ratio:.3f} of the Rayleigh speed")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("smoke",), "PART"))
