"""The public phase-field curve of this panel (repository modeIIShearPanel of PSAAPGroupLinder, phase_field/fd_fine_linear.csv, some
of its points), and what curves have in common whatever the toughness: with linear strains all displacements and forces go with
the square root of Gc."""

import pathlib

import numpy as np

import pdxtools

THICKNESS = 0.01  # [mm]
GC = 1e-3  # as said [N/mm]
FULL = 1.4e-3  # displacement of case.opts at load 1 [mm]


class Curve:
    def __init__(self, displacement, force):
        self.displacement, self.force = displacement, force
        self.slope = force[1] / displacement[1]  # [N/mm]
        self.top = int(np.argmax(force))
        behind = force[self.top :]
        self.low = self.top + int(np.argmin(behind))

    @property
    def peak(self):
        return self.force[self.top]

    @property
    def at_peak(self):
        return self.displacement[self.top]

    def secant(self):
        """Force over displacement, of what it was at first [-]."""
        return self.force[1:] / self.displacement[1:] / self.slope

    def dissipated(self):
        """Work less what is stored, in an elastic body with cracks [N mm]."""
        steps = 0.5 * (self.force[1:] + self.force[:-1]) * np.diff(self.displacement)
        return np.cumsum(steps) - 0.5 * self.force[1:] * self.displacement[1:]


def published():
    table = np.loadtxt(pathlib.Path(__file__).with_name("published.csv"), delimiter=",", skiprows=1)
    return Curve(*table.T)


def ours(run, full=FULL):
    history = pdxtools.read_history(run)
    start = np.zeros(1)
    return Curve(np.concatenate([start, full * history["load"]]), np.concatenate([start, history["reaction_top_x"]]))


def toughness_of(curve, run):
    """Energy that a curve dissipates per area of crack, with the crack's length at its secant stiffness taken from a run: from
    where it has grown by 0.3 mm [N/mm]."""
    mine, grown = ours(run), 1e3 * (pdxtools.read_history(run)["crack_length"] - 0.5e-3)
    order = np.argsort(mine.secant())
    length = np.interp(curve.secant(), mine.secant()[order], grown[order])
    first = int(np.argmax(length > 0.3))
    return curve.dissipated()[first] / (length[first] * THICKNESS)
