#!/usr/bin/env python3
"""Runs shortened variants of the pulse and asserts what must hold: the reflection at the side of a patch in either
scheme, the energies, the distance from the exact pulse, and the same motion on 1, 2 and 3 ranks.

usage: check.py [--executable build/release/pdxsolve] [ranks] [elements] [plane] [paper]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import fields
import numpy as np
import waves

PLANE_END = 3e-5  # [s] the pulse is in the patch, 0.036 m from the side it came in by
LOW = ["-mesh_upper", "0.36,0.07", "-mesh_cells", "80,35"]  # a plane strip in half the time
PATCH = ["-pd_patches", "0.235,0,0.3,0.07"]
# A displacement below this is none: the exact rule skips next to nothing, as numbers run ahead of the wave. [m]
REST = ["-pd_skip_tolerance", "1e-14"]
REFLECTION_PAPER = 0.70e-2, 0.05e-2  # of the amplitude
REFLECTION_DEFAULT = 0.2e-2
DRIFT = 1e-5
SAME = 1e-10  # of the amplitude, on any number of ranks
DISPERSION = 1.58e-2, 0.1e-2  # of elements alone against the exact pulse at t2, an independent computation


class Check(case_check.Check):
    """The parts of the check, each a method."""

    def __init__(self, executable, scratch):
        super().__init__("pulse", executable, scratch)

    def check(self, part):
        getattr(self, part)()

    def directory(self, variant, options=(), ranks=2, name=None):
        run = self.run(variant, ranks, options, name)
        if not run:
            return None
        drift = fields.read_summary(run[0])["results"]["energy_drift_ratio"]
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
        skipped = fields.read_summary(runs[0])["results"]["pd_tiles_skipped"]
        self.expect(skipped > 0, f"{skipped} tiles of bonds skipped that the wave had not reached")

    def elements(self):
        """Elements alone against the exact plane pulse."""
        low = ["-mesh_upper", "0.5,0.004", "-mesh_cells", "250,2"]
        run = self.directory("fe_only", ["-options_file", "cases/pulse/rollers.opts", *low, "-ts_max_time", "5.61e-5"], 1)
        if run:
            gap, (wanted, tolerance) = waves.difference(run, None, waves.TIMES[1]), DISPERSION
            self.expect(abs(gap - wanted) <= tolerance,
                        f"{100 * gap:.2f} % from the exact pulse, wanted {100 * wanted:.2f} within {100 * tolerance:g}")  # fmt: skip

    def reflected(self, variant):
        """Part of the amplitude that comes back from the patch of a plane strip, or None if a run failed."""
        alone = self.directory("plane_fe_only", LOW, 1, f"{variant}_alone")
        run = self.directory(variant, [*LOW, *PATCH, *REST])
        return waves.reflection(run, alone, PLANE_END) if run and alone else None

    def plane(self):
        """The default scheme."""
        share = self.reflected("plane_case")
        if share is not None:
            self.expect(share <= REFLECTION_DEFAULT,
                        f"reflection {100 * share:.3f} %, {100 * REFLECTION_DEFAULT:g} allowed")  # fmt: skip

    def paper(self):
        """The papers' scheme."""
        share, (wanted, tolerance) = self.reflected("plane_paper"), REFLECTION_PAPER
        if share is not None:
            self.expect(abs(share - wanted) <= tolerance,
                        f"reflection {100 * share:.3f} %, wanted {100 * wanted:.2f} within {100 * tolerance:g}")  # fmt: skip


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("ranks", "elements", "plane", "paper"), "PART"))
