#!/usr/bin/env python3
"""Quenches a short strip from 300 and 600 degrees and asserts that the first bond breaks where the closed form of the heat says,
that cracks come in from the cooled side, some of which stop early, and that from the hotter strip there are more and longer
ones; and that the same bonds break on any number of ranks.

usage: check.py [--executable build/release/pdxsolve] [ranks] [onset] [cracks]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import pdxtools
import shock

HALF, SCATTER = 4e-3, 0.05  # of smoke.opts [m], [-]


class Check(case_check.Check):
    """The parts of the check, each a method."""

    case = "cold_shock"

    def ranks(self):
        """The same bonds break at each load, however many ranks there are."""
        runs = [self.run("smoke", ranks, ["-thermal_duration", "0.02s", "-load_steps", "6"]) for ranks in (1, 2, 3)]
        if None in runs:
            return
        one, *others = [pdxtools.read_history(run[0]) for run in runs]
        for ranks, other in zip((2, 3), others):
            alike = list(one["bonds_broken"]) == list(other["bonds_broken"])
            self.expect(alike, f"{ranks} ranks: {other['bonds_broken'][-1]:.0f} bonds, {one['bonds_broken'][-1]:.0f} on one")

    def cracks(self):
        cool, hot = self.run_at_once(("smoke", 1), ("smoke", 1, ["-thermal_initial", "600"], "hot"))
        if not cool or not hot:
            return
        found = {}
        for name, run in (("300", cool[0]), ("600", hot[0])):
            lengths = shock.cracks(run)[:, 1]
            self.expect(len(lengths) >= 3, f"{name} C: {len(lengths)} cracks from the long side")
            self.expect(lengths.max() < HALF, f"{name} C: none goes through ({1e3 * lengths.max():.2f} mm): the middle is pressed together")
            self.expect(lengths.min() < 0.5 * lengths.max(), f"{name} C: some stop early, at {1e3 * lengths.min():.2f} mm")
            found[name] = lengths
        self.expect(len(found["600"]) > len(found["300"]), "more cracks from the hotter strip")
        self.expect(found["600"].sum() > 1.2 * found["300"].sum(), "and longer ones, all in all")

    def onset(self):
        """Far from its ends a strip is stretched at the surface by alpha times what that is colder than the mean; the first
        bonds break there, those whose own stretch is the least."""
        dx = 0.2e-3  # the outermost particles are half of it below the surface
        for initial, duration in ((300.0, "6ms"), (600.0, "2ms")):
            cooling = ["-thermal_initial", str(initial), "-thermal_duration", duration, "-thermal_pace", "even"]
            run = self.run("smoke", 1, [*cooling, "-load_steps", "30", "-pd_release", "all"], f"onset_{initial:.0f}")
            if not run:
                continue
            history = pdxtools.read_history(run[0])
            weakest = (1.0 - SCATTER) * pdxtools.read_summary(run[0])["results"]["critical_stretch"][0]
            early, late = 0.0, 1.0
            for _ in range(40):
                middle = 0.5 * (early + late)
                early, late = (middle, late) if shock.strain(initial, middle, HALF, dx / 2) < weakest else (early, middle)
            first = next(k for k, bonds in enumerate(history["bonds_broken"]) if bonds)
            time = history["time"][first]
            self.expect_between(f"{initial:.0f} C: first bonds break at {1e3 * time:.3f} ms, of closed form", time / late, 0.98, 1.08)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("ranks", "onset", "cracks"), "PART"))
