#!/usr/bin/env python3
"""Runs two cracks that pass each other, turn and meet, in patches that go along and in particles only, and asserts what must
hold: the cracks are point-symmetric, give way, then hook and part the plate; patches change nothing; ranks agree.

usage: check.py [--executable build/release/pdxsolve] [hooks] [full] [ranks] [joined]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

SPACING = 1e-5
CENTRE = np.array([0.4e-3, 0.3e-3])
GIVEN = 0.27e-3  # height of the left crack [m]
FORCE = 5e-3  # of the largest
PARTICLES = ["-pd_patches", "0.04e-3,0.04e-3,0.76e-3,0.56e-3", "-pd_horizon_ratio", "3", "-pd_spacing", "5e-6"]


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "two_cracks"

    def __init__(self, executable, scratch):
        super().__init__(executable, scratch)
        self.small, self.full_one = self.run_at_once(("smoke", 1), ("smoke_full", 1))

    @staticmethod
    def ways(run):
        """The paths of the left tip and of the right one, the latter turned by half a turn."""
        curve = pdxtools.read_curve(run / "crack_path.csv")
        left, right = (np.column_stack([curve["x"], curve["y"]])[curve["tip"] == tip] for tip in (1, 2))
        return left, 2 * CENTRE - right

    def hooks(self):
        if not self.small:
            return
        history = pdxtools.read_history(self.small[0])
        gap = max(np.abs(history[f"tip1_{a}"] + history[f"tip2_{a}"] - 2 * c).max() for a, c in zip("xy", CENTRE))
        self.expect(gap < 0.1 * SPACING, f"tips are alike if turned by half a turn: off by {gap / SPACING:.1e} spacings")
        left, _ = self.ways(self.small[0])
        lowest = left[:, 1].min()
        self.expect(lowest < GIVEN - SPACING, f"the left crack gives way: {(GIVEN - lowest) / SPACING:.1f} spacings down")
        passed = history["tip1_x"] > CENTRE[0] + 5 * SPACING
        highest = history["tip1_y"][passed].max()
        self.expect(highest > CENTRE[1], f"past the other it turns up, to {1e3 * highest:.3f} mm, beyond the middle")
        force = np.abs(history["reaction_top_y"])
        self.expect(force[-1] < 1e-6 * force.max(), "in the end the plate is in two: no force is left")

    def full(self):
        """Beside particles only."""
        if not self.small or not self.full_one:
            return
        one, other = (pdxtools.read_history(run[0]) for run in (self.full_one, self.small))
        gap = np.abs(one["bonds_broken"] - other["bonds_broken"]).max()
        self.expect(gap <= 4, f"{gap:.0f} of {one['bonds_broken'][-1]:.0f} bonds differ at any load")
        for column in ("tip1_x", "tip1_y", "tip2_x", "tip2_y"):
            gap = np.abs(one[column] - other[column]).max()
            self.expect(gap < 0.5 * SPACING, f"{column} within {gap / SPACING:.2f} spacings at each load")
        gap = np.abs(one["reaction_top_y"] - other["reaction_top_y"]).max() / np.abs(one["reaction_top_y"]).max()
        self.expect(gap < FORCE, f"the force within {100 * gap:.2f} % of the largest")
        summary, whole = (pdxtools.read_summary(run[0]) for run in (self.small, self.full_one))
        moved, many = summary["relocations"], whole["unknowns"]["pd"] / 2
        most = other["particles"].max()
        self.expect(moved >= 8, f"{moved} relocations")
        self.expect(most < 0.6 * many, f"at most {most:.0f} particles for {many:.0f}")

    def ranks(self):
        runs = [self.small, self.run("smoke", 2), self.run("smoke", 3)]
        if None in runs:
            return
        one, *others = (pdxtools.read_history(run[0]) for run in runs)
        for number, other in zip((2, 3), others):
            gap = np.abs(one["bonds_broken"] - other["bonds_broken"]).max()
            self.expect(gap == 0, f"{number} ranks: the same broken bonds at each load")

    def joined(self):
        """The ways as given cracks, one of which ends on the other in an element."""
        runs = [self.run("joined", 1), self.run("joined", 3), self.run("joined", 1, PARTICLES, "particles")]
        if None in runs:
            return
        force, three, particles = (pdxtools.read_summary(run[0])["results"]["reaction"]["right"][0] for run in runs)
        self.expect_near("joined: the force against particles only", force, particles, 0.01)
        self.expect_near("joined: 3 ranks", three, force, 1e-8)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ["hooks", "full", "ranks", "joined"], "PART"))
