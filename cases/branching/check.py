#!/usr/bin/env python3
"""Runs coarse variants of the branching plate and asserts what must hold: the same broken bonds on 1, 2 and 3 ranks with the
crack along a border of ranks, a crack slower than Rayleigh waves, two branches that mirror each other.

usage: check.py [--executable build/release/pdxsolve] [ranks] [branch]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import numpy as np

RAYLEIGH = 3058.39  # [m/s]
SAME_DAMAGE = 1e-12
SPACING = 5e-4  # [m]
LAYERS = ["-mesh_cells", "10,40", "-petscpartitioner_type", "metis"]  # long flat cells: the border of two ranks is the line of the crack


def by_number(particles, name):
    return particles[name][np.argsort(particles.natural_point)]


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "branching"

    def ranks(self):
        """The same bonds break, look by look, however many ranks there are."""
        options = ["-ts_max_time", "30e-6", "-output_fields", "-output_interval", "1000", *LAYERS]
        runs = [self.run("smoke", n, options, f"ranks_{n}") for n in (1, 2, 3)]
        if None in runs:
            return
        runs = [run[0] for run in runs]
        histories = [pdxtools.read_history(run) for run in runs]
        last = [pdxtools.read_step(run)[1]["particles"] for run in runs]
        broken = histories[0]["bonds_broken"]
        self.expect(broken[0] == 0 and broken[-1] > 1000, f"{broken[-1]:.0f} bonds broken in the end, none at first")
        damage = by_number(last[0], "damage")
        for n, run, history, particles in zip((2, 3), runs[1:], histories[1:], last[1:]):
            self.expect(np.array_equal(history["bonds_broken"], broken), f"{n} ranks: the same bonds_broken")
            gap = np.abs(history["crack_length"] - histories[0]["crack_length"]).max()
            self.expect(gap < 1e-9 * SPACING, f"{n} ranks: the same crack_length: off by {gap:.1e} m")
            gap = np.abs(by_number(particles, "damage") - damage).max()
            self.expect(gap <= SAME_DAMAGE, f"{n} ranks: the same damage: off by {gap:.1e}")
        shared = self.ranks_along_crack(last[1])
        self.expect(shared > 10, f"2 ranks: {shared} columns of the crack have other owners above and below")

    @staticmethod
    def ranks_along_crack(particles):
        """Columns of particles in which the two rows beside the crack belong to different ranks."""
        x, y = particles.points[:, 0], particles.points[:, 1]
        owner = {}
        for k in np.flatnonzero((np.abs(y) < SPACING) & (particles["damage"] > 0.3)):
            owner.setdefault(round(x[k] / SPACING * 2), set()).add(int(particles["rank"][k]))
        return sum(len(ranks) > 1 for ranks in owner.values())

    def branch(self):
        """The crack runs straight, slower than Rayleigh waves, and becomes two that mirror each other."""
        run = self.run("smoke", 2, [], "branch")
        if not run:
            return
        results = pdxtools.read_summary(run[0])["results"]
        tips = np.array(results["crack_tips"])
        self.expect(abs(results["rayleigh_speed"] - RAYLEIGH) < 0.01, f"Rayleigh speed {results['rayleigh_speed']:.2f} m/s")
        ratio = results["max_crack_speed_ratio"]
        self.expect(0.3 < ratio < 1.0, f"largest speed {ratio:.3f} of the Rayleigh speed")
        self.expect(len(tips) == 2, f"{len(tips)} tips in the end")
        if len(tips) != 2:
            return
        gap = max(abs(tips[0, 0] - tips[1, 0]), abs(tips[0, 1] + tips[1, 1]))
        self.expect(gap < 1e-3 * SPACING, f"tips mirror each other: off by {gap:.1e} m")
        x = results["branch_point"][0]
        self.expect(0.06 < x < 0.08, f"branches at x = {1e3 * x:.2f} mm, t = {1e6 * results['branch_time']:.2f} us")
        drift = results["energy_drift_ratio"]
        self.expect(drift < 0.02, f"energies add up to {drift:.1e} of the work")

    def medium(self):
        """At dx = 0.25 mm it branches when and where it should; the finest run is 0.2 us and 0.6 mm off."""
        run = self.run("medium", 2, [], "medium")
        if not run:
            return
        results = pdxtools.read_summary(run[0])["results"]
        time, x = 1e6 * results.get("branch_time", 0.0), 1e3 * results.get("branch_point", [0.0])[0]
        self.expect(20.0 < time < 21.5, f"branches at {time:.2f} us")
        self.expect(66.5 < x < 68.5, f"at x = {x:.2f} mm")


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("ranks", "branch", "medium"), "PART"))
