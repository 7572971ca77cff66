#!/usr/bin/env python3
"""Runs the formulations of material points side by side and asserts that each does as well as independent prototypes, within a
fifth, and that the pulse is of second order.

usage: check.py [--executable build/release/pdxsolve] [pulse] [flight] [impact] [disc]      default: all
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Exit status: 0 if all holds, 1 if not.
"""

import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import formulations

ROOM = 1.2  # over what prototypes lost
SPLINES = "updated, B-splines"  # no node has the velocity of the end there: what drives it is of first order
LEAST = 1e-5  # of an energy: the oscillation of central differences that both together leave out


class Check(case_check.Check):
    """The parts of the check, each a scene."""

    case = "formulations"

    def of_each(self, scene, options=()):
        """(number, variant, output directory) of a run of each variant."""
        for k, (variant, more) in enumerate(formulations.VARIANTS.items()):
            step = ["-ts_safety", str(formulations.SAFETY[scene])]
            run = self.run(scene, 1, [*step, *more, *options], f"{scene}_{k}_{'_'.join(options)}")
            if run:
                yield k, variant, run[0]

    def pulse(self):
        """Errors at two spacings: the order, and each against `total`."""
        fine, coarse = ({variant: formulations.pulse(run) for _, variant, run in self.of_each("pulse", options)}
                        for options in ((), ("-mpm_spacing", "2e-3")))
        for variant, error in fine.items():
            least = 1.0 if variant == SPLINES else 1.8
            self.expect_between(f"{variant}: order", np.log2(coarse[variant] / error), least, 2.4)
        for k, (variant, error) in enumerate(fine.items()):
            if variant == SPLINES:
                continue
            most = ROOM * formulations.PROTOTYPES["pulse"][k]
            self.expect_between(f"{variant}: error over that of total", error / fine["total"], 0.99, most)

    def flight(self):
        self.no_worse("flight", "flight", formulations.energy)

    def disc(self):
        self.no_worse("disc", "disc", formulations.energy)

    def no_worse(self, scene, what, read):
        for k, variant, run in self.of_each(scene, ("-output_history_interval", "50")):
            most = max(LEAST, ROOM * abs(formulations.PROTOTYPES[what][k]))
            self.expect_between(f"{variant}: energy", abs(read(run)), 0.0, most)
            if scene == "disc":
                most = ROOM * abs(formulations.PROTOTYPES["turned"][k])
                self.expect_between(f"{variant}: angular momentum", abs(formulations.turned(run)), 0.0, most)

    def impact(self):
        for k, variant, run in self.of_each("impact"):
            expected = formulations.PROTOTYPES["impact"][k]
            self.expect_between(f"{variant}: largest pull", formulations.impact(run), 1.0, ROOM * expected)


if __name__ == "__main__":
    sys.exit(case_check.main(__doc__, Check, ("pulse", "flight", "impact", "disc"), "SCENE"))
