#!/usr/bin/env python3
"""Runs three scenes of the paper's Table 1 in points that become particles, in coarser points and in particles only, and
asserts that all have the same crack and that points cost less.

usage: check.py [--executable build/release/pdxsolve] [plate] [hole] [kalthoff]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import sys

import efficiency
import case_check
import numpy as np
import pdxtools

FIRST_BREAK = 0.03  # against particles only
FAR = 2.0  # the ends of the cracks lie no farther apart [spacings of particles]
SPACING = {"plate": 5e-4, "hole": 5e-4, "kalthoff": 1e-3}  # [m]
DRIFT = 1e-3
SAVED, ATTEMPTS = 0.1, 3  # of the solver's time, on a machine that does other things too


class Check(case_check.Check):
    """A part is a scene."""

    case = "efficiency"

    def check(self, name):
        best = {}
        for attempt in range(ATTEMPTS):
            runs = {way: self.run(name + way, 1, name=f"{name}{way}_{attempt}") for way in efficiency.WAYS}
            if None in runs.values():
                return
            for way, (run, _) in runs.items():
                best[way] = min(best.get(way, np.inf), pdxtools.read_summary(run)["wall_seconds"]["solve"])
            if max(best[""], best["_coarser"]) <= (1.0 - SAVED) * best["_particles"]:
                break
        theirs = runs["_particles"][0]
        for way in ("", "_coarser"):
            ours, label = runs[way][0], name + way
            self.expect_near(f"{label}: first break", efficiency.first_break(ours), efficiency.first_break(theirs), FIRST_BREAK)
            gap = np.linalg.norm(efficiency.reach(ours) - efficiency.reach(theirs)) / SPACING[name]
            self.expect(gap <= FAR, f"{label}: the crack ends {gap:.2f} spacings from that in particles only")
            self.expect_between(f"{label}: energy_drift_ratio", pdxtools.read_summary(ours)["results"]["energy_drift_ratio"], 0.0, DRIFT)
            saved = 1.0 - best[way] / best["_particles"]
            self.expect(saved >= SAVED, f"{label}: saves {100 * saved:.0f} % of the solver's time")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, efficiency.SCENES, "SCENE"))
