"""What is known of a strip that is cooled, and the cracks of a run."""

import functools
import math

import pdxtools
import numpy as np

CONDUCTIVITY, CAPACITY, DENSITY, TRANSFER, EXPANSION, AMBIENT = 31.0, 880.0, 3980.0, 65e3, 7.5e-6, 20.0
SHORTEST = 0.5e-3  # what counts as a crack [m]
LONG = 2 / 3  # of the deepest: one of the first class
END = 2e-3  # what begins nearer to the cooled end is left out of distances [m]
GAP = 1.3  # between classes of length: ratio of neighbours in order of length


@functools.cache
def roots(biot, count=60):
    """z tan z = Bi, by bisection."""
    found = []
    for n in range(count):
        low, high = n * math.pi, (n + 0.5) * math.pi
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if middle * math.sin(middle) * (-1) ** n < biot * math.cos(middle) * (-1) ** n else (low, middle)
        found.append(low)
    return np.array(found)


def share(depth, time, half):
    """Of the first difference of temperatures, what is left at a depth below the surface of a strip that is 2 half thick
    [Carslaw and Jaeger, Conduction of Heat in Solids, 3.11]."""
    z = roots(TRANSFER * half / CONDUCTIVITY)
    fourier = CONDUCTIVITY / (CAPACITY * DENSITY) * time / half**2
    weights = 4.0 * np.sin(z) / (2.0 * z + np.sin(2.0 * z)) * np.exp(-(z**2) * fourier)
    return float(np.sum(weights * np.cos(z * (1.0 - depth / half))))


def strain(initial, time, half, depth):
    """By which a strip without cracks is stretched there beyond what is free, along itself and far from its ends [-]."""
    mean = np.mean([share(half * (k + 0.5) / 400, time, half) for k in range(400)])
    return EXPANSION * (initial - AMBIENT) * (mean - share(depth, time, half))


def cracks(run, shortest=SHORTEST):
    """Cracks from the long side, in order along it: places of mouths and how deep they come [m]."""
    found = [
        (crack["mouth"][0], crack["tip"][1])
        for crack in pdxtools.read_summary(run)["results"]["new_cracks"]
        if crack["mouth"][1] < 1e-9 and crack["tip"][1] >= shortest
    ]
    return np.array(sorted(found)).reshape(-1, 2)


def classes(depths):
    """How many classes of length there are: lengths in order, parted where one is GAP times the one before."""
    depths = np.sort(depths)
    return 1 + int(np.sum(depths[1:] > GAP * depths[:-1]))
