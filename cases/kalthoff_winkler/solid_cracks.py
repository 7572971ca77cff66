"""What damaged particles of the plate in space say of its cracks."""

import numpy as np

TIPS = ((0.05, 0.125), (0.05, 0.075))  # of the notches [m]
DAMAGED = 0.3  # of particles beside a crack


def crack_angle(points, damage, tip):
    """Angle [degrees] to its notch of the crack from a tip: the line through the tip with the least squares of the
    distances of damaged particles, those of the other crack and of the right edge left out."""
    way = points[:, :2] - tip
    outward = np.sign(tip[1] - 0.1)
    way[:, 1] *= outward
    near = (damage > DAMAGED) & (way[:, 1] > 0.0) & (points[:, 0] < 0.095)
    values, vectors = np.linalg.eigh(way[near].T @ way[near])
    x, y = vectors[:, np.argmax(values)]
    return np.degrees(np.arctan2(abs(y), x * np.sign(y)))


def layers(points):
    """Masks of the layers of particles, from the back to the front."""
    heights = np.round(points[:, 2], 9)
    return [heights == z for z in np.unique(heights)]


def angles(points, damage):
    """Of both cracks in each layer [degrees]: layers x 2."""
    return np.array([[crack_angle(points[k], damage[k], tip) for tip in TIPS] for k in layers(points)])
