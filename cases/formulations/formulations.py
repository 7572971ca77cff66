"""What study.py and check.py of this case share: the variants, and what is read from a run of each scene."""

import pdxtools
import numpy as np

UPDATED = ["-mpm_formulation", "updated", "-mpm_shape"]
VARIANTS = {"updated, hats": [*UPDATED, "hat"], "updated, uGIMP": [*UPDATED, "gimp"],
            "updated, B-splines": [*UPDATED, "bspline"], "total": []}
SAFETY = {"pulse": 0.5, "flight": 0.1, "ringing": 0.1, "impact": 0.1, "disc": 0.1}  # shares of h / c, alike for all
# Independent prototypes (1-D in Python, 2-D in C++), variant by variant: energy after the flight and three turns, angular
# momentum after these, largest pull over the exact one; of the pulse, whose shape is not known, over that of `total`.
PROTOTYPES = {"flight": (-9.6e-2, -1.1e-3, -5.7e-4, -1e-9), "disc": (2.5e-2, 3e-3, 7e-5, 6e-7),
              "turned": (-4.9e-2, -3.4e-2, -2.3e-2, -1.6e-4), "impact": (2.11, 1.85, 1.62, 1.39),
              "pulse": (4.3, 3.8, 7.0, 1.0)}
SPEED, WIDTH, MIDDLE, HIGH, STRESS = 100.0, 2e-4, 7e-4, 1e-2, 1500.0  # [m/s], [s], [s], [m/s], [Pa]


def pulse(run):
    """Error of the velocity at the end, over its size."""
    time, blocks = pdxtools.read_step(run)
    points = blocks["points"]
    exact = HIGH * np.exp(-(((time - points.points[:, 0] / SPEED) - MIDDLE) / WIDTH) ** 2)
    return np.linalg.norm(points["velocity"][:, 0] - exact) / np.linalg.norm(exact)


def energy(run):
    """Change of strain and kinetic energy from the start to the end, over the former."""
    results = pdxtools.read_summary(run)["results"]
    return (results["kinetic_energy"] + results["strain_energy"]) / results["initial_energy"] - 1.0


def turned(run):
    """The same of angular momentum, from the first look."""
    angular = pdxtools.read_history(run)["angular_momentum_z"]
    return angular[-1] / angular[0] - 1.0


def impact(run):
    """The largest pull in any point at any time, over that of plane waves."""
    steps = range(pdxtools.step_count(run))
    return max(pdxtools.read_step(run, k)[1]["points"]["stress"][:, 0].max() for k in steps) / STRESS
