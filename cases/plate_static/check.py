#!/usr/bin/env python3
"""Runs the static plate on 2 ranks and asserts what must hold: errors against elements only, reactions, displacements.

usage: check.py [--executable build/release/pdxsolve] [VARIANT ...]     default: all variants below
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

# Largest relative error of Eq. 28 [%]: bounds, or the paper's value with what separates our figures from its own.
ERRORS = {
    "fe_only": None,
    "smoke": (0.0, 0.2),
    "coarse": (0.0, 0.02),
    "fine": (0.0, 0.01),
    "paper_coarse": (1.20 - 0.03, 1.20 + 0.03),
    "paper_fine": (0.75 - 0.02, 0.75 + 0.02),
}
# The traction 1 MPa in both directions acts on 5 mm x 1 mm.
REACTION = (-5.0, -5.0)  # [N]
REACTION_TOLERANCE = 1e-8  # relative
# Elements only, 100 x 100 of them, computed independently: point [m] and displacement [m], rounded to 7 digits.
DISPLACEMENTS = {
    (5e-3, 5e-3): (-1.220571e-5, 3.627817e-5),
    (2.5e-3, 2.5e-3): (2.376232e-6, 1.342010e-5),
}
DISPLACEMENT_TOLERANCE = 5e-7  # relative, half a digit


class Check(case_check.Check):
    """Errors, reactions and displacements on 2 ranks."""

    case = "plate_static"

    def expect_vector(self, name, found, expected, tolerance):
        gap = np.abs(found / np.array(expected) - 1.0).max()
        self.expect(gap <= tolerance, f"{name} {found[0]:.7g}, {found[1]:.7g}: off by {gap:.1e} of it")

    def check(self, variant):
        run = self.run(variant)
        if not run:
            return
        self.results(run[0], variant)
        if variant == "fe_only":
            self.displacements(run[0])

    def results(self, run, variant):
        results = pdxtools.read_summary(run)["results"]
        reaction = np.array(results["reaction"]["clamp"])
        self.expect_vector("reaction [N]", reaction, REACTION, REACTION_TOLERANCE)
        bounds = ERRORS[variant]
        if bounds:
            error = results["max_relative_error_percent"]
            low, high = bounds
            self.expect(low <= error <= high, f"largest error {error:.4f} %, wanted {low:.3g} ... {high:.3g} %")

    def displacements(self, run):
        mesh = pdxtools.read_step(run)[1]["mesh"]
        for point, expected in DISPLACEMENTS.items():
            distance = np.linalg.norm(mesh.points[:, :2] - point, axis=1)
            found = mesh["displacement"][distance.argmin(), :2]
            self.expect(distance.min() < 1e-12, f"a node at {point[0]:g}, {point[1]:g} m")
            self.expect_vector("displacement [m]", found, expected, DISPLACEMENT_TOLERANCE)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ERRORS))
