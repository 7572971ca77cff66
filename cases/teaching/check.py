#!/usr/bin/env python3
"""Runs the six problems and holds each against what is known of it.

usage: check.py [--executable build/release/pdxsolve] [hole] [hole_crack] [two_cracks] [bend] [slanted] [block]    default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))

import case_check
import closed_form
import pdxtools

PROBLEMS = ["hole", "hole_crack", "two_cracks", "bend", "slanted", "block"]


class Check(case_check.Check):
    """A method for each problem, with its output directory."""

    case = "teaching"

    def check(self, name):
        run = self.run(name, 1)
        if run:
            getattr(self, name)(run[0])

    @staticmethod
    def tips(run):
        return [(tip["k1_domain"], tip["k2_domain"]) for tip in pdxtools.read_summary(run)["results"]["tips"]]

    def hole(self, run):
        found = pdxtools.read_curve(run / "probe_side.csv")["stress_yy"][-1]
        self.expect_near("stress beside the hole", found, closed_form.hole(), 0.005)

    def hole_crack(self, run):
        self.expect_near("K_I", self.tips(run)[-1][0], closed_form.hole_crack(), 0.005)

    def two_cracks(self, run):
        lower, upper = self.tips(run)[:2], self.tips(run)[2:]
        for name, found, known in zip(("outer", "inner"), lower, closed_form.two_cracks()):
            self.expect_near(f"{name} tip: K_I", found[0], known[0], 0.005)
            self.expect_near(f"{name} tip: K_II", found[1], known[1], 0.02)
        for one, other in zip(lower, upper[::-1]):
            self.expect_near("K_I where the plate is turned upside down", other[0], one[0], 1e-6)

    def bend(self, run):
        self.expect_near("K_I", self.tips(run)[0][0], closed_form.bend(), 0.01)

    def slanted(self, run):
        for found in self.tips(run):
            for name, k, known in zip(("K_I", "K_II"), found, closed_form.slanted()):
                self.expect_near(name, k, known, 0.01)

    def block(self, run):
        history = {name: values[-1] for name, values in pdxtools.read_history(run).items()}
        self.expect_near("work of the push", history["work"], closed_form.block(), 0.005)
        thrown = 0.5 * 2700 * 0.024**2 * 1e-3  # [J], of the row that moves from the start, which nobody pushed to that
        self.expect_near("what of it moves", history["energy_kinetic_particles"] - thrown, 0.5 * history["work"], 0.003)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, PROBLEMS, "PROBLEM"))
