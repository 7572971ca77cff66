"""K of cracks along x from a hole in a plate pulled along y, over s sqrt(pi a); a is counted from the hole, of radius R."""

import math

import numpy as np

RADIUS, SQUARE, HALF = 0.01, 0.01575, 0.3  # of the hole, of the square around it and of the plate: half of each [m]
STRESS = 1e6  # [Pa]

# Two cracks, by collocation [Newman, NASA TN D-6376, 1971]: (R + a) / R, K over s sqrt(pi (R + a)).
NEWMAN = np.array([(1.02, 0.4514), (1.04, 0.6082), (1.06, 0.7104), (1.08, 0.7843), (1.1, 0.84), (1.15, 0.9322), (1.2, 0.9851),
                   (1.25, 1.0168), (1.3, 1.0358), (1.4, 1.0536), (1.5, 1.0582), (1.8, 1.0495), (2.0, 1.0409), (2.2, 1.0336),
                   (2.5, 1.0252), (3.0, 1.0161), (4.0, 1.0077)])  # fmt: skip


def newman(a):
    """Two cracks, between the points of the table through K over that of an edge crack, which is smooth."""
    x = NEWMAN[:, 0] - 1.0
    factor = NEWMAN[:, 1] * np.sqrt((1.0 + x) / x)
    return float(np.exp(np.interp(math.log(a / RADIUS), np.log(x), np.log(factor))))


def bowie(a, cracks):
    """One or two cracks: formulas for Bowie's figures of 1956 [Tada, Paris and Irwin, Handbook]; "better than 1 %".

    That for two stands in public codes as it does here. That for one was not found again; its ends are right: 3 x 1.1215 for s = 0,
    a short crack where the stress is threefold, and 1 / sqrt(2) for s = 1, a crack without its hole."""
    s = a / (RADIUS + a)
    if cracks == 2:
        return 0.5 * (3 - s) * (1 + 1.243 * (1 - s) ** 3)
    return (1 + 0.2 * (1 - s) + 0.3 * (1 - s) ** 6) * (2.243 - 2.64 * s + 1.352 * s**2 - 0.248 * s**3)


def no_hole(a, cracks):
    """A straight crack as long as hole and cracks together, which opens less: a lower bound."""
    return math.sqrt((RADIUS + a if cracks == 2 else RADIUS + 0.5 * a) / a)


def width(a):
    """Of a plate that is not infinite [Feddersen, 1966], of hole and two cracks; 0.5 % at most here."""
    return 1.0 / math.sqrt(math.cos(0.5 * math.pi * (RADIUS + a) / HALF))


def unit(a):
    return STRESS * math.sqrt(math.pi * a)
