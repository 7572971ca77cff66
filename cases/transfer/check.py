#!/usr/bin/env python3
"""Runs the transfer of a pulse and of a bump between elements and particles at 2 and 5 spacings an element, and asserts how
little energy, noise and error that makes, and that it is the same on two ranks.

usage: check.py [--executable build/release/pdxsolve] [strip] [plate] [ranks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import sys

import transfer  # scripts/ are on the path from here on
import case_check
import numpy as np

# By spacings in an element. relocation.md, section 4, by the papers' transfer: strip 1.1e-2, 4.0e-2 noise, 1.2e-2, 2.8e-3
# error of the pulse, -3.1e-3, 4e-5 energy; plate 6.9e-2, 7.3e-2 noise, 5e-3 to 8e-3 energy a change.
NOISE = {"strip": {2: 6e-3, 5: 1.1e-2}, "plate": {2: 1e-2, 5: 1e-2}}
ENERGY = {"strip": {2: 3e-3, 5: 1.5e-3}, "plate": {2: 8e-3, 5: 9e-3}}  # of all changes, over all there is
EACH = {"strip": {2: 7e-4, 5: 1.1e-3}, "plate": {2: 2e-3, 5: 4.6e-3}}  # of one change
PULSE = {2: 5e-3, 5: 6e-3}
SAME = 1e-9  # of the energy, on two ranks


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "transfer"

    def runs(self, scene, ratio, kinds, ranks=1):
        wanted = [(scene, ranks, transfer.options(scene, ratio, kind), f"{scene}_{ratio}_{kind}_{ranks}") for kind in kinds]
        done = dict(zip(kinds, self.run_at_once(*wanted) if ranks == 1 else [self.run(*one) for one in wanted]))
        return None if None in done.values() else {kind: directory for kind, (directory, _) in done.items()}

    def scene(self, scene, ratio):
        runs = self.runs(scene, ratio, transfer.KINDS[scene])
        if not runs:
            return
        found = transfer.Transfer(scene, runs)
        name = f"{scene}, {ratio} spacings, {found.relocations} changes"
        self.expect(abs(found.energy) <= ENERGY[scene][ratio], f"{name}: energy {found.energy:.1e}")
        self.expect(found.energy_each <= EACH[scene][ratio], f"{name}: energy of one {found.energy_each:.1e}")
        self.expect(found.noise <= NOISE[scene][ratio], f"{name}: noise {found.noise:.1e} of the peak")
        if scene == "strip":
            self.expect(found.pulse <= PULSE[ratio], f"{name}: error of the pulse {found.pulse:.1e}")

    def strip(self):
        for ratio in (2, 5):
            self.scene("strip", ratio)

    def plate(self):
        for ratio in (2, 5):
            self.scene("plate", ratio)

    def ranks(self):
        runs = [self.runs("plate", 2, ["changes"], ranks) for ranks in (1, 2)]
        if None in runs:
            return
        one, two = (run["changes"] for run in runs)
        gap = np.abs(transfer.gained(one) - transfer.gained(two)).max()
        self.expect(gap <= SAME, f"2 ranks: the same energy at each change: off by {gap:.1e}")
        motions = [transfer.velocity(run)[1] for run in (one, two)]
        gap = np.abs(motions[0] - motions[1]).max()
        self.expect(gap <= SAME, f"2 ranks: the same motion: off by {gap:.1e} of the bump")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ["strip", "plate", "ranks"], "PART"))
