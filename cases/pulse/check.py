#!/usr/bin/env python3
"""Runs shortened variants of the pulse and asserts what must hold: the reflection at the side of a patch in either
scheme, the energies, the distance from the exact pulse, and the same motion on 1, 2 and 3 ranks.

usage: check.py [--executable build/release/pdxsolve] [ranks] [elements] [left] [plane] [paper]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np
import waves

PLANE_END = 3e-5  # [s] the pulse is in the patch, 0.036 m from the side it came in by
PATCH = ["-pd_patches", "0.234,0,0.3,0.1"]  # no longer than needed
# A displacement below this is none: the exact rule skips next to nothing, as numbers run ahead of the wave. [m]
REST = ["-pd_skip_tolerance", "1e-14"]
REFLECTION_PAPER = 0.70e-2, 0.05e-2  # of the amplitude
REFLECTION_DEFAULT = 0.2e-2
DRIFT = 1e-5
LEFT = 1.26e-5  # the paper's
SAME = 1e-10  # of the amplitude, on any number of ranks
DISPERSION = 1.58e-2, 0.1e-2  # of elements alone against the exact pulse at t2, an independent computation


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "pulse"
    alone = None  # directory of the plane pulse in elements alone

    def directory(self, variant, options=(), ranks=2, name=None):
        run = self.run(variant, ranks, options, name)
        if not run:
            return None
        drift = pdxtools.read_summary(run[0])["results"]["energy_drift_ratio"]
        self.expect(drift <= DRIFT, f"energy drift {drift:.1e} of the input, {DRIFT:g} allowed")
        return run[0]

    def ranks(self):
        """smoke.opts moves alike on any number of ranks."""
        runs = [self.directory("smoke", [], n) for n in (1, 2, 3)]
        if None in runs:
            return
        motions = [waves.on_nodes(run, np.inf)[2] for run in runs]
        for n, motion in zip((2, 3), motions[1:]):
            gap = np.abs(motion - motions[0]).max() / np.abs(motions[0]).max()
            self.expect(gap <= SAME, f"{n} ranks: the same displacement: off by {gap:.1e} of its largest")
        skipped = pdxtools.read_summary(runs[0])["results"]["pd_tiles_skipped"]
        self.expect(skipped > 0, f"{skipped} tiles of bonds skipped that the wave had not reached")

    def elements(self):
        """Elements alone against the exact plane pulse."""
        low = ["-mesh_upper", "0.5,0.004", "-mesh_cells", "250,2"]
        rollers = ["-options_file", "cases/pulse/rollers.opts"]
        run = self.directory("fe_only", [*rollers, *low, "-ts_max_time", "5.61e-5"], 1)
        if run:
            self.expect_within("distance from the exact pulse", waves.difference(run, None, waves.TIMES[1]), DISPERSION)

    def expect_within(self, name, share, bounds):
        wanted, tolerance = (100 * value for value in bounds)
        self.expect(
            abs(100 * share - wanted) <= tolerance,
            f"{name} {100 * share:.3f} %, wanted {wanted:.2f} within {tolerance:g}",
        )

    def left(self):
        """What stays in the patch, on a coarser mesh."""
        coarse = ["-mesh_cells", "200,100", "-pd_spacing", "5e-4", "-ts_dt", "1e-7", "-ts_max_time", "8.2e-5"]
        run = self.directory("case", ["-options_file", "cases/pulse/rollers.opts", *coarse])
        if run:
            share = pdxtools.read_summary(run)["results"]["pd_energy_ratio_final"]
            self.expect(share <= LEFT, f"energy left in the patch {share:.2e} of the input, {LEFT:g} allowed")

    def reflected(self, variant):
        """Part of the amplitude that comes back from the patch of a plane strip, or None if a run failed."""
        self.alone = self.alone or self.directory("plane_fe_only", [], 1)
        run = self.directory(variant, [*PATCH, *REST])
        return waves.reflection(run, self.alone, PLANE_END) if run and self.alone else None

    def plane(self):
        """The default scheme."""
        share = self.reflected("plane_case")
        if share is not None:
            bound = REFLECTION_DEFAULT
            self.expect(share <= bound, f"reflection {100 * share:.3f} %, {100 * bound:g} allowed")

    def paper(self):
        """The papers' scheme."""
        share = self.reflected("plane_paper")
        if share is not None:
            self.expect_within("reflection", share, REFLECTION_PAPER)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("ranks", "elements", "left", "plane", "paper"), "PART"))
