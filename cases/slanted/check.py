#!/usr/bin/env python3
"""Runs the slanted crack in a patch that holds all of its way and in one that goes along, coarse, and asserts what must
hold: it turns, the two go the same way under the same force, and ranks agree.

usage: check.py [--executable build/release/pdxsolve] [turns] [snail] [laplacian] [fine]      default: all
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
GIVEN = 0.3e-3 / np.cos(np.pi / 6)  # length of the given crack [m]
APART = 0.5 * SPACING  # of tips and lengths in both patches
FORCE = 5e-3  # of the largest


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "slanted"

    def __init__(self, executable, scratch):
        super().__init__(executable, scratch)
        tracker = ["-adapt_tracker", "laplacian"]
        self.large_fine, self.large, self.small, self.tracked, self.fine_one = self.run_at_once(
            ("case", 1), ("smoke", 1), ("smoke_snail", 1), ("smoke_snail", 1, tracker, "laplacian"), ("snail", 1))  # fmt: skip

    @staticmethod
    def path(run):
        curve = pdxtools.read_curve(run / "crack_path.csv")
        return np.column_stack([curve["x"], curve["y"]])

    def turns(self):
        if not self.large:
            return
        path = self.path(self.large[0])
        ways = np.diff(path[[0, len(path) // 2, -1]], axis=0)
        first, last = np.degrees(np.arctan2(ways[:, 1], ways[:, 0]))
        self.expect(first < 10, f"it goes on at {first:.1f} degrees, not at the 30 of the given tip")
        self.expect(last < first - 15, f"and turns again: {last:.1f} degrees in the end")
        length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
        told = pdxtools.read_history(self.large[0])["crack_length"][-1] - GIVEN
        self.expect(abs(length - told) < 1e-4 * SPACING, f"it has grown by {1e3 * told:.4f} mm, the length of its path")

    def same(self, name, run, large=None):
        """A run beside that with a patch which holds all of the way."""
        large = large or self.large[0]
        one, other = (pdxtools.read_history(directory) for directory in (large, run))
        gap = np.abs(one["bonds_broken"] - other["bonds_broken"]).max()
        self.expect(gap <= 4, f"{name}: {gap:.0f} more or less broken bonds at each load")
        for column in ("crack_length", "tip1_x", "tip1_y"):
            gap = np.abs(one[column] - other[column]).max()
            self.expect(gap < APART, f"{name}: {column} within {gap / SPACING:.2f} spacings at each load")
        gap = np.abs(one["reaction_top_y"] - other["reaction_top_y"]).max() / np.abs(one["reaction_top_y"]).max()
        self.expect(gap < FORCE, f"{name}: the force within {100 * gap:.2f} % of the largest")
        summary = pdxtools.read_summary(run)
        self.expect(summary["relocations"] >= 8, f"{name}: {summary['relocations']} relocations")
        self.expect(summary["unknowns"]["enriched"] > 0, f"{name}: elements carry the crack behind the tip")

    def snail(self):
        runs = [self.small, self.run("smoke_snail", 2)]
        if not self.large or None in runs:
            return
        self.same("snail", runs[0][0])
        one, two = (self.path(run) for run, _ in runs)
        gap = np.abs(one - two).max() if one.shape == two.shape else np.inf
        self.expect(gap < 1e-6 * SPACING, f"2 ranks: the same path: off by {gap:.1e} m")

    def fine(self):
        """Four spacings in an element, where the crack runs along a line of the mesh."""
        if self.large_fine and self.fine_one:
            self.same("fine", self.fine_one[0], self.large_fine[0])

    def laplacian(self):
        if self.large and self.tracked:
            self.same("laplacian", self.tracked[0])


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ["turns", "snail", "laplacian", "fine"], "PART"))
