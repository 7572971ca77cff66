#!/usr/bin/env python3
"""Runs coarse variants of the plate with a central crack and asserts what must hold: both tips grow alike and straight on,
slower than Rayleigh waves, and the coupled plate's crack grows as the one of particles only.

usage: check.py [--executable build/release/pdxsolve] [growth] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

SPACING = 1e-3 / 3.0  # [m]


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "central_crack"

    def growth(self):
        """Coupled and with particles only."""
        runs = [self.run(variant, 1, [], variant) for variant in ("smoke", "smoke_pd_only")]
        if None in runs:
            return
        for run in runs:
            results = pdxtools.read_summary(run[0])["results"]
            name = run[0].name
            tips = np.array(results["crack_tips"])
            self.expect(len(tips) == 2, f"{name}: {len(tips)} tips")
            self.expect(abs(tips[:, 0].sum()) < 1e-3 * SPACING, f"{name}: tips at {1e3 * tips[:, 0]} mm mirror each other")
            self.expect(np.abs(tips[:, 1]).max() < 2.5 * SPACING, f"{name}: the crack stays within 2.5 spacings of its line")
            ratio = results["max_crack_speed_ratio"]
            self.expect(0.2 < ratio < 1.0, f"{name}: largest speed {ratio:.3f} of the Rayleigh speed")
            self.expect(results["energy_drift_ratio"] < 0.03, f"{name}: energy drift {results['energy_drift_ratio']:.1e}")
        coupled, alone = (pdxtools.read_history(run[0]) for run in runs)
        gap = np.abs(coupled["crack_length"] - alone["crack_length"]).max()
        grown = alone["crack_length"][-1] - alone["crack_length"][0]
        self.expect(grown > 10 * SPACING, f"the crack grew by {1e3 * grown:.2f} mm")
        self.expect(gap < 0.1 * grown, f"coupled and particles only: lengths differ by up to {1e3 * gap:.2f} mm")

    def ranks(self):
        """The same bonds break, look by look, however many ranks there are."""
        runs = [self.run("smoke", n, [], f"ranks_{n}") for n in (1, 2, 3)]
        if None in runs:
            return
        histories = [pdxtools.read_history(run[0]) for run in runs]
        for n, history in zip((2, 3), histories[1:]):
            same = np.array_equal(history["bonds_broken"], histories[0]["bonds_broken"])
            self.expect(same, f"{n} ranks: the same bonds_broken")
            gap = np.abs(history["crack_length"] - histories[0]["crack_length"]).max()
            self.expect(gap < 1e-9 * SPACING, f"{n} ranks: the same crack_length: off by {gap:.1e} m")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("growth", "ranks"), "PART"))
