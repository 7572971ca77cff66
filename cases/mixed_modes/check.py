#!/usr/bin/env python3
"""Runs slanted cracks and asserts K_I, K_II and the T-stress against the closed form of the infinite plate.

usage: check.py [--executable build/release/pdxsolve] [ring] [contours] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))

import case_check
import closed_form
import pdxtools


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "mixed_modes"

    def slanted(self, variant, *angles):
        return zip(angles, self.run_at_once(
            *((variant, 1, ["-crack_crack_points", closed_form.points(a)], f"{variant}_{a}") for a in angles)))  # fmt: skip

    def modes(self, name, found, degrees, of_k, of_t):
        """Each K within this share of its own, T of the stress."""
        k1, k2, t_stress = closed_form.modes(degrees)
        self.expect_near(f"{name}: K_I", found[0], k1, of_k)
        if degrees:
            self.expect_near(f"{name}: K_II", found[1], k2, of_k)
        else:
            self.expect(abs(found[1]) < 1e-4 * closed_form.K0, f"{name}: K_II {found[1]:.3g}, none")
        off = abs(found[2] - t_stress) / closed_form.STRESS
        self.expect(off < of_t, f"{name}: T {found[2]:.5g} against {t_stress:.5g}: off by {100 * off:.2f} % of the stress")

    def ring(self):
        for degrees, run in self.slanted("case", 0, 30, 75):
            if not run:
                continue
            tips = pdxtools.read_summary(run[0])["results"]["tips"]
            for tip in tips:
                self.modes(f"{degrees} degrees", (tip["k1_domain"], tip["k2_domain"], tip["t_stress_domain"]), degrees, 0.01, 0.005)
            last = {name: values[-1] for name, values in pdxtools.read_history(run[0]).items()}
            self.expect(last["tip2_k2"] == tips[1]["k2_domain"], "history.csv has K too")

    def contours(self):
        for degrees, run in self.slanted("contours", 0, 45):
            if not run:
                continue
            for tip in pdxtools.read_summary(run[0])["results"]["tips"]:
                for side, *found in tip["modes_by_contour"]:
                    self.modes(f"{degrees} degrees, {1e3 * side:g} mm", found, degrees, 0.012, 0.02)

    def ranks(self):
        runs = [self.run("case", 1, name="one"), self.run("case", 2, name="two")]
        if None in runs:
            return
        one, two = (pdxtools.read_summary(run[0])["results"]["tips"][0] for run in runs)
        for name in ("k1_domain", "k2_domain", "t_stress_domain"):
            self.expect_near(f"2 ranks: {name}", two[name], one[name], 1e-7)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ["ring", "contours", "ranks"], "PART"))
