"""What check.py, study.py and pictures.py read from the runs of the pulse."""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import numpy as np

AMPLITUDE, PEAK, WIDTH = 1e-4, 1.2e-5, 4e-6  # of the right side [m, s, s]
YOUNG, POISSON, DENSITY, LENGTH = 200e9, 1.0 / 3.0, 7850.0, 0.5
SPEED = np.sqrt(YOUNG / (1.0 - POISSON**2) / DENSITY)  # of plane waves in plane stress [m/s]
PATCH = 0.2, 0.3  # [m]
TIMES = 1.9e-5, 5.61e-5, 7.9e-5  # of the paper's Fig. 7 [s]
LATE = 8.2e-5  # the pulse has left the patch by three widths [s]


def exact(x, time):
    """u_x of the plane pulse [m]."""
    return AMPLITUDE * np.exp(-(((time - PEAK) - (LENGTH - x) / SPEED) / WIDTH) ** 2)


def blocks_at(run, time):
    """Time and blocks of the stored step nearest to `time` [s]."""
    return pdxtools.read_step(run, pdxtools.step_at(run, time))


def on_nodes(run, time):
    """Time, places of all nodes [m] in their natural order, and displacements there [m]: under a patch the particles
    are interpolated, as the paper does for its Eq. 29."""
    time, blocks = blocks_at(run, time)
    mesh = blocks["mesh"]
    order = np.argsort(mesh.natural_point)
    return time, mesh.points[order, :2], mesh["displacement"][order, :2]


def on_line(run, time):
    """Time, x [m] and u_x [m] of the nodes nearest to half the height."""
    time, x, u = on_nodes(run, time)
    middle = np.unique(x[:, 1])[len(np.unique(x[:, 1])) // 2]
    line = np.flatnonzero(np.abs(x[:, 1] - middle) < 1e-9)
    line = line[np.argsort(x[line, 0])]
    return time, x[line, 0], u[line, 0]


def source_side(x):
    return x > PATCH[1] + 1e-9


def reflection(run, reference, time):
    """Largest |u_x - u_x of elements alone| on the line between source and patch, over the amplitude."""
    _, x, u = on_line(run, time)
    _, _, alone = on_line(reference, time)
    return np.abs(u - alone)[source_side(x)].max() / AMPLITUDE


def left_behind(run, time):
    """Largest |u_x| on the line between source and patch, over the amplitude."""
    _, x, u = on_line(run, time)
    return np.abs(u)[source_side(x)].max() / AMPLITUDE


def difference(run, reference, time):
    """Largest distance on the line, over the amplitude; to the exact pulse if `reference` is None."""
    time, x, u = on_line(run, time)
    other = exact(x, time) if reference is None else on_line(reference, time)[2]
    return np.abs(u - other).max() / AMPLITUDE


def pd_energy(run):
    """Time [s] and energy of the patch and its interface, kinetic and strain, over the largest input."""
    columns = pdxtools.read_history(run)
    inside = columns["energy_kinetic_particles"] + columns["energy_bonds"] + columns["energy_interface"]
    return columns["time"], inside / columns["work"].max()


def residual(run, time):
    at, share = pd_energy(run)
    return float(np.interp(time, at, share))
