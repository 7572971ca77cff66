"""What is known of the six problems, in SI units. Nothing here knows of meshes or particles."""

import math
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "hole_crack"))

import exact
import published

STRESS = 1e6  # far away [Pa]


def unit(a):
    """K of a straight crack of length 2 a [Pa m^0.5]."""
    return STRESS * math.sqrt(math.pi * a)


def hole():
    """Stress beside a hole [Kirsch, 1898] [Pa]."""
    return 3 * STRESS


def hole_crack(a=0.01175):
    """K_I of one crack from a hole of radius 10 mm: distributed dislocations [Pa m^0.5]."""
    return exact.factor(a / published.RADIUS, 1) * unit(a) * published.width(a)


def dislocation_stress(dx, dy):
    """(s_yy, s_xy) there of an opening dislocation, and of a slipping one, both over 2 mu / (pi (kappa + 1)); a row each."""
    square = (dx * dx + dy * dy) ** 2
    mixed = (dx * dx - dy * dy) / square
    return (dx * (dx * dx + 3 * dy * dy) / square, dy * mixed), (dy * mixed, dx * mixed)


def two_cracks(half=0.006, x=0.005, y=0.0055, nodes=60):
    """(K_I, K_II) of the outer and of the inner tip of the lower of two cracks along x with centres at (-x, -y) and (x, y), in an
    infinite plate: distributed dislocations, Gauss-Chebyshev quadrature [Erdogan and Gupta, 1972]."""
    k = np.arange(1, nodes + 1)
    sources, places = np.cos((2 * k - 1) * np.pi / (2 * nodes)), np.cos(np.arange(1, nodes) * np.pi / nodes)
    centres = ((-x / half, -y / half), (x / half, y / half))
    rows, right = [], []
    for here in centres:
        for component in (0, 1):  # s_yy, s_xy: none on the faces
            blocks = []
            for there in centres:
                dx = here[0] + places[:, None] - there[0] - sources
                opening, slipping = dislocation_stress(dx, np.full_like(dx, here[1] - there[1]))
                blocks += [opening[component], slipping[component]]
            rows.append(np.hstack(blocks) * np.pi / nodes)
            right += [-1.0 if component == 0 else 0.0] * (nodes - 1)
    closed = np.kron(np.eye(4), np.ones(nodes))  # both ends of a crack are closed
    density = np.linalg.solve(np.vstack([*rows, closed]), np.append(right, np.zeros(4)))[: 2 * nodes].reshape(2, nodes)

    def at_right(values):
        angle = (2 * k - 1) * np.pi / (4 * nodes)
        return np.sum(values * np.sin((2 * nodes - 1) * angle) / np.sin(angle)) / nodes

    left = [-math.pi * at_right(values[::-1]) * unit(half) for values in density]
    right = [math.pi * at_right(values) * unit(half) for values in density]
    return tuple(left), tuple(right)


def bend(force=100.0, span=0.08, depth=0.02, thickness=0.01, crack=0.008):
    """K_I of three-point bending at span / depth of 4, within 0.5 % [Srawley, 1976] [Pa m^0.5]."""
    x = crack / depth
    factor = 3 * math.sqrt(x) * (1.99 - x * (1 - x) * (2.15 - 3.93 * x + 2.7 * x * x)) / (2 * (1 + 2 * x) * (1 - x) ** 1.5)
    return force * span / (thickness * depth**1.5) * factor


def slanted(a=0.01, degrees=45.0):
    """(K_I, K_II) [Sih, Paris and Irwin, 1962]."""
    angle = math.radians(degrees)
    return unit(a) * math.cos(angle) ** 2, unit(a) * math.sin(angle) * math.cos(angle)


def block(young=70e9, density=2700.0, velocity=1.0, area=0.024**2, time=15e-6):
    """Work of the push: pressure rho c v, c of waves that cannot bulge at nu = 1/4, times area, velocity and time [J]."""
    speed = math.sqrt(1.2 * young / density)
    return density * speed * velocity * area * velocity * time
