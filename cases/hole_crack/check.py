#!/usr/bin/env python3
"""Asserts the stress beside a hole [Kirsch, 1898] and K of cracks that begin there, by distributed dislocations.

usage: check.py [--executable build/release/pdxsolve] [hole] [exact] [cracks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))

import case_check
import exact
import numpy as np
import pdxtools
import published


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "hole_crack"

    def hole(self):
        run = self.run("hole", 1)
        if not run:
            return
        side, crown = (pdxtools.read_curve(run[0] / f"probe_{name}.csv") for name in ("side", "crown"))
        self.expect_near("beside the hole, of the stress", side["stress_yy"][-1] / published.STRESS, 3.0, 0.01)
        self.expect_near("above the hole", crown["stress_xx"][-1] / published.STRESS, -1.0, 0.03)

    def exact(self):
        for ratio, newman in published.NEWMAN[[5, 10, 14]]:
            found = exact.factor(ratio - 1, 2) / np.sqrt(ratio / (ratio - 1))
            self.expect_near(f"dislocations at {ratio - 1:g} R, of Newman's figures", found, newman, 1e-3)

    def cracks(self):
        for name, run in zip(("particles", "elements"), self.run_at_once(("case", 1), ("elements", 1))):
            if not run:
                continue
            for tip in pdxtools.read_summary(run[0])["results"]["tips"]:
                a = abs(tip["at"][0]) - published.RADIUS
                expected = exact.factor(a / published.RADIUS, 2) * published.unit(a) * published.width(a)
                self.expect_near(f"{name}: K_I of a crack of {1e3 * a:g} mm", tip["k1_domain"], expected, 0.01)
                self.expect(abs(tip["k2_domain"]) < 1e-6 * expected, f"and no K_II: {tip['k2_domain']:.2g}")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ["hole", "exact", "cracks"]))
