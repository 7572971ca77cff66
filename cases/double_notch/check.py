#!/usr/bin/env python3
"""Runs the notched plate on 2 ranks and on 1 and asserts what must hold: J against its reference, against -dPi/da, on
every contour, in elements around the patch, and on any number of ranks.

usage: check.py [--executable build/release/pdxsolve] [VARIANT ...]     default: all variants below
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import math
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools

YOUNG = 72e9  # [Pa]
REFERENCE = 12.8930  # J [J/m^2], p-version elements graded to the tip, an independent computation
REFERENCE_WORK = 5.52064e-4  # of both loads, force times displacement, 1 mm thick [J], likewise
# J [J/m^2]: bounds.
BOUNDS = {
    "smoke": (REFERENCE * (1 - 1e-2), REFERENCE * (1 + 1e-2)),
    "coarse": (REFERENCE * (1 - 3e-3), REFERENCE * (1 + 3e-3)),
    "fine": (REFERENCE * (1 - 1e-3), REFERENCE * (1 + 1e-3)),
    "paper": (12.95 - 0.02, 12.95 + 0.02),
    "pd_only": (REFERENCE * (1 - 3e-3), REFERENCE * (1 + 3e-3)),
    "pd_only_paper": (REFERENCE * (1 + 0.9e-2), REFERENCE * (1 + 1.2e-2)),
    "xfem_only": None,
}
RELEASE_TOLERANCE = 1e-3  # J against -dPi/da with the tip moved by a spacing, relative
# The sum over a contour is a conservation law of the lattice: what is left is the tolerance of the solver. The issue
# asks for 5e-4, the paper has 1.06e-2.
SPREAD = 1e-6
# Faces have no surface factors close behind the tip. At this spacing the smallest contour, 8 spacings from the tip,
# crosses where they end, and differs from the others by so much at most.
SMALLEST_OFF = {"coarse": 1e-4, "pd_only": 1e-4}
# J in the elements around the patch against J in the patch, and work of the loads, relative. The papers' border of
# ghosts is not quite a conservation law.
DOMAIN_TOLERANCE = {"coarse": 3e-4, "fine": 3e-4, "paper": 3e-3}
WORK_TOLERANCE = {"coarse": 3e-3, "fine": 1e-3, "paper": 7e-3}
RANKS_TOLERANCE = 1e-8  # relative
WARNING = "closes at the last element edge before it"


class Check(case_check.Check):
    """J of a variant on 1 and 2 ranks."""

    case = "double_notch"

    def results(self, variant, ranks):
        """Runs a variant that warns if it should and says nothing else; its results, or None if it failed."""
        run = self.run(variant, ranks)
        if not run:
            return None
        directory, said = run
        self.expect(WARNING in said if variant == "xfem_only" else not said, f"{ranks} rank(s) {said.strip()}")
        return pdxtools.read_summary(directory)["results"]

    def check(self, variant):
        one, two = (self.results(variant, ranks) for ranks in (1, 2))
        if not one or not two:
            return
        self.ranks(one, two, variant)
        if BOUNDS[variant]:
            self.contours(two, variant)
        self.energies(two, variant)

    def contours(self, results, variant):
        low, high = BOUNDS[variant]
        j = results["j_integral"]
        error = 100 * (j / REFERENCE - 1)
        self.expect(low <= j <= high, f"J {j:.5f} J/m^2 ({error:+.3f} %), wanted {low:.4f} ... {high:.4f}")
        values = [value for _, value in results["j_by_contour"]]
        if variant in SMALLEST_OFF:
            smallest = values.pop(0)
            self.expect_near("J of the smallest contour", smallest, values[0], SMALLEST_OFF[variant])
        spread = max(values) / min(values) - 1
        self.expect(spread <= SPREAD, f"spread over {len(values)} contours {100 * spread:.1e} %, {SPREAD:g} allowed")
        self.expect_near("K [Pa m^0.5]", results["stress_intensity"], math.sqrt(YOUNG * j), 1e-12)

    def energies(self, results, variant):
        if "energy_release_rate" in results and variant != "smoke":
            released = results["energy_release_rate"]
            self.expect_near("J against -dPi/da", results["j_integral"], released, RELEASE_TOLERANCE)
        self.expect_near("twice the strain energy", 2 * results["strain_energy"], 2 * results["external_work"], 1e-8)
        if variant not in DOMAIN_TOLERANCE:
            return
        self.expect_near("J in elements", results["j_domain"], results["j_integral"], DOMAIN_TOLERANCE[variant])
        self.expect_near("work of the loads", 2 * results["external_work"], REFERENCE_WORK, WORK_TOLERANCE[variant])
        counts = results["cut_elements"], results["enriched_sets"]
        self.expect(counts == (10, 22), f"{counts[0]} cut elements, {counts[1]} enriched nodes; the paper: 10, 22")

    def ranks(self, one, two, variant):
        key = "j_domain" if variant == "xfem_only" else "j_integral"
        self.expect_near(f"{key} on 1 and 2 ranks", two[key], one[key], RANKS_TOLERANCE)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, BOUNDS))
