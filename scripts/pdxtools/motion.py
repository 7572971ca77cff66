"""Material points as they move: a panel for each step of a run, points as the squares they have become, by stress."""
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from .fields import NotThere, read_step, step_count

PANEL = 2.6  # [inch]
COLOURS = "viridis"


def spacing(places):
    """Of the points of one body [m]."""
    gaps = np.diff(np.unique(np.round(places[:, 0], 12)))
    return gaps[gaps > 1e-9].min() if gaps.size else 1.0


def mises(stress):
    """From xx, xy, xz, yy, yz, zz."""
    xx, xy, xz, yy, yz, zz = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy**2 + yz**2 + xz**2))


def seen(block):
    """Which points are drawn, and along which two axes: all of the plane, of space the middle layer seen along y."""
    places = block.points
    if np.ptp(places[:, 2]) == 0.0:
        return np.ones(len(places), bool), [0, 1]
    middle = 0.5 * (places[:, 1].min() + places[:, 1].max())
    return np.abs(places[:, 1] - middle) < 0.75 * spacing(places), [0, 2]


def squares(block, chosen, along):
    """Corners of the squares of points, deformed with them [m]."""
    rows = [block[f"deformation_{'xyz'[axis]}"][chosen][:, along] for axis in along]
    deformation = np.stack(rows, axis=1)
    size = np.zeros(len(block.points))
    for body in np.unique(block["body"]):
        size[block["body"] == body] = spacing(block.points[block["body"] == body])
    corners = 0.5 * size[chosen, None, None] * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    at = (block.points + block["displacement"])[chosen][:, along]
    return at[:, None, :] + np.einsum("pij,pcj->pci", deformation, corners)


def unit_of(largest):
    return next(((factor, unit) for factor, unit in [(1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa")] if largest >= factor), (1.0, "Pa"))


def picture(run, steps):
    """@param steps numbers of steps with fields; empty: all"""
    drawn = []
    for number in steps or range(step_count(run)):
        time, blocks = read_step(run, number)
        if "points" not in blocks:
            raise NotThere(f"{run} has no material points")
        block = blocks["points"]
        chosen, along = seen(block)
        drawn.append((time, squares(block, chosen, along), mises(block["stress"][chosen])))
    corners = np.concatenate([shapes.reshape(-1, 2) for _, shapes, _ in drawn])
    metre, unit = (1e3, "mm") if np.ptp(corners, axis=0).max() < 0.5 else (1.0, "m")
    lower, upper = metre * corners.min(axis=0), metre * corners.max(axis=0)
    margin = 0.01 * (upper - lower).max()
    lower, upper = lower - margin, upper + margin
    flat = (upper - lower)[1] < 0.6 * (upper - lower)[0]
    count = len(drawn)
    shape = (count, 1) if flat else (1, count)
    height = PANEL * (upper - lower)[1] / (upper - lower)[0]
    size = (2.0 * PANEL + 1.0, count * max(2.0 * height, 0.4) + 0.5) if flat else (count * PANEL + 1.0, height + 0.6)
    figure, grid = plt.subplots(*shape, figsize=size, squeeze=False, layout="constrained", sharex=True, sharey=True)
    factor, stress_unit = unit_of(max(stress.max() for _, _, stress in drawn))
    look = {"cmap": COLOURS, "norm": Normalize(0.0, max(stress.max() for _, _, stress in drawn) / factor or 1.0)}
    for axes, (time, shapes, stress) in zip(grid.flat, drawn):
        axes.add_collection(PolyCollection(metre * shapes, array=stress / factor, linewidths=0, antialiaseds=False, rasterized=True, **look))
        axes.set_aspect("equal")
        axes.set_xlim(lower[0], upper[0])
        axes.set_ylim(lower[1], upper[1])
        axes.set_title(f"{time:.3g} s" if time >= 0.1 else f"{1e3 * time:.3g} ms", pad=3)
        axes.spines[["top", "right"]].set_visible(False)
        axes.locator_params(nbins=5)
        if flat:
            axes.set_yticks([])
    grid[-1, 0].set_xlabel(f"[{unit}]")
    figure.colorbar(plt.cm.ScalarMappable(**look), ax=grid, fraction=0.03, pad=0.02, label=f"von Mises stress [{stress_unit}]")
    return figure
