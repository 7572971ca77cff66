"""K and T of a crack in an infinite plate pulled along y, at an angle to x [Sih, Paris and Irwin, 1962]."""

import math

HALF = 0.01  # of the crack [m]
STRESS = 1e6  # [Pa]
K0 = STRESS * math.sqrt(math.pi * HALF)  # of a crack along x [Pa m^0.5]


def points(degrees):
    """What `-crack_crack_points` takes."""
    x, y = HALF * math.cos(math.radians(degrees)), HALF * math.sin(math.radians(degrees))
    return f"{-x:.15g},{-y:.15g},{x:.15g},{y:.15g}"


def modes(degrees):
    """K_I, K_II [Pa m^0.5] and the T-stress [Pa]."""
    angle = math.radians(degrees)
    cosine, sine = math.cos(angle), math.sin(angle)
    return K0 * cosine**2, K0 * sine * cosine, STRESS * (sine**2 - cosine**2)
