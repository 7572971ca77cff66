#!/usr/bin/env python3
"""Runs the bars and asserts what must hold: where and when the bar spalls, and how that converges; what the pieces keep; energy
and momentum; the same on 1, 2 and 3 ranks.

usage: check.py [--executable build/release/pdxsolve] [spall] [spacings] [slow] [printed] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

PLACE, TIME = (0.039, 0.041), (1.00e-3, 1.06e-3)  # plane waves: .0400 m, 1.000 ms
CONVERGED_PLACE, CONVERGED_TIME = (0.0398, 0.0402), (1.00e-3, 1.02e-3)
VELOCITY = 30.0  # [m/s]
PIECE_KEEPS, IMPACTOR_KEEPS = 0.95, 0.02  # of it: at least at .5 mm, at most
DRIFT = 1e-3


def velocities(directory, section):
    """Mean velocity at the end of what lies left of the bar, in it before the section and behind that [m/s]."""
    places, speeds = [], []
    _, blocks = pdxtools.read_step(directory)
    for name in ("points", "particles"):
        places.append(blocks[name].points[:, 0])
        speeds.append(blocks[name]["velocity"][:, 0])
    x, v = np.concatenate(places), np.concatenate(speeds)
    return v[x < 0.0].mean(), v[(x > 0.0) & (x < section)].mean(), v[x > section].mean()


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "spallation"

    def spalled(self, variant, ranks=1):
        """Results of a run in which the bar spalls, None if it failed."""
        run = self.run(variant, ranks)
        if not run:
            return None, None
        results, _ = self.books(run[0], None, DRIFT)
        self.expect(results.get("spall_body") == "bar", f"what spalls is the {results.get('spall_body')}")
        return results, run[0]

    def spall(self):
        """Where and when, at 1 mm."""
        results, _ = self.spalled("case", 2)
        if results:
            self.expect_between("spalls at [m]", results["spall_position"], *PLACE)
            self.expect_between("spalls when [s]", results["spall_time"], *TIME)

    def spacings(self):
        """Towards .0400 m and 1.000 ms."""
        all_results = []
        for variant in ("case", "half", "quarter", "eighth"):
            results, directory = self.spalled(variant)
            if not results:
                return
            all_results.append(results)
            impactor, _, piece = velocities(directory, results["spall_position"])
            if variant != "case":
                self.expect(piece >= PIECE_KEEPS * VELOCITY, f"the piece keeps {piece / VELOCITY:.3f} of 30 m/s")
            self.expect(abs(impactor) <= IMPACTOR_KEEPS * VELOCITY, f"the impactor {impactor / VELOCITY:.4f}")
        times = [results["spall_time"] for results in all_results]
        listed = ", ".join(f"{1e3 * t:.4f}" for t in times)
        self.expect(all(a > b for a, b in zip(times, times[1:])), f"sooner the finer: {listed} ms")
        self.expect_between("converges to [m]", all_results[-1]["spall_position"], *CONVERGED_PLACE)
        self.expect_between("converges to [s]", times[-1], *CONVERGED_TIME)

    def slow(self):
        """In proportion at a thirtieth of the speed."""
        results, _ = self.spalled("slow")
        if results:
            self.expect_between("spalls at [m]", results["spall_position"], *PLACE)
            self.expect_between("spalls when [s]", results["spall_time"], *TIME)

    def printed(self):
        """Twice the strength that waves reach: nothing becomes particles."""
        run = self.run("printed", 1)
        if run:
            summary = pdxtools.read_summary(run[0])
            self.expect(summary["unknowns"]["pd"] == 0, "no particle")
            self.expect("spall_time" not in summary["results"], "no spall")

    def ranks(self):
        """Alike on any number of ranks, the same bonds broken."""
        self.expect_alike("case", ("spall_position", "spall_time", "fracture_energy", "kinetic_energy"), 1e-10)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("spall", "spacings", "slow", "printed", "ranks"), "PART"))
