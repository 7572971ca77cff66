"""K of one or two cracks from a hole in an infinite plate, by distributed dislocations: the field of a dislocation beside a circular
hole with a free border is known as a series, the integral equation is solved by Gauss-Chebyshev quadrature [Erdogan and Gupta,
1972]. Four digits of Newman's figures for two cracks come out; of one crack there is no table as good."""

import math

import numpy as np


def border(places, sources, terms):
    """Stress across the x-axis that the hole (radius 1) adds to that of dislocations of unit strength on the axis: a row for each
    place, a column for each source. Potentials are series in 1 / z; free of forces, and of any opening of the hole itself."""
    m = np.arange(terms, dtype=float)
    first = -(sources[:, None] ** -(m + 1))
    phi = np.zeros((len(sources), terms))
    phi[:, 2:] = first[:, 2:] * (m[2:] - 1) + (m[2:] - 2) * sources[:, None] ** -(m[2:] - 1)
    psi = np.zeros((len(sources), terms + 2))
    psi[:, 2] = 2 * first[:, 0]
    psi[:, 3:] = phi[:, 1:] * (1 + m[1:]) + first[:, 1:]
    powers = np.sign(places)[:, None] ** np.arange(terms + 2) * np.abs(places)[:, None] ** -np.arange(terms + 2.0)
    return powers[:, :terms] @ (phi * (2 - m)).T + powers @ psi.T


def factor(ratio, cracks, nodes=40, terms=4000):
    """K over s sqrt(pi a), of a / R."""
    k = np.arange(1, nodes + 1)
    half = 0.5 * ratio
    sources = 1 + half * (1 + np.cos((2 * k - 1) * np.pi / (2 * nodes)))
    places = 1 + half * (1 + np.cos(np.arange(1, nodes) * np.pi / nodes))
    kernel = 2 / (places[:, None] - sources) + border(places, sources, terms)
    if cracks == 2:  # the other crack is the mirror image
        kernel += 2 / (-places[:, None] - sources) + border(-places, sources, terms)
    else:  # the hole takes up what the mouth of the crack is open by
        kernel -= (2 / places + 2 / places**3)[:, None]
    alone = 1 + 0.5 / places**2 + 1.5 / places**4  # of the plate with its hole [Kirsch, 1898]
    quarter = (2 * k - 1) * np.pi / (4 * nodes)
    at_mouth = (-1.0) ** (k + nodes) * np.tan(quarter)  # no more than a bounded density there
    system = np.vstack([kernel * half * np.pi / nodes, at_mouth])
    density = np.linalg.solve(system, np.append(-alone, 0.0))
    at_tip = np.sum(-((-1.0) ** k) * density / np.tan(quarter)) / nodes
    return 2 * math.pi * abs(at_tip) * math.sqrt(half / ratio)
