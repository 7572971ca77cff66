"""What check.py and study.py of this case have in common: scenes, ways to run them, and what is read of a run."""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import numpy as np
import pdxtools

SCENES = {"plate": 37.1, "hole": 34.2, "kalthoff": 32.3}  # what the paper's Table 1 saves [%]
WAYS = {"": "as far apart as particles", "_coarser": "twice as far", "_particles": "particles only"}


def half(scene, way):
    """Options that halve all spacings and the step."""
    spacing, step = {"plate": (5e-4, 1.2e-8), "hole": (5e-4, 1.2e-8), "kalthoff": (1e-3, 5e-8)}[scene]
    points = 2.0 * spacing if way == "_coarser" else spacing
    options = ["-pd_spacing", repr(0.5 * spacing), "-ts_dt", repr(0.5 * step)]
    if way != "_particles" or scene == "hole":
        options += ["-mpm_spacing", repr(0.5 * points)]
    return options


def first_break(run):
    """When the first bond had broken, to a look of the history [s]."""
    curve = pdxtools.read_history(run)
    return curve["time"][curve["bonds_broken"] > 0][0]


def reach(run):
    """How far the crack that runs to the upper right, or to the right, has come: the damaged particle farthest out [m]."""
    _, blocks = pdxtools.read_step(run, -1)
    particles = blocks["particles"]
    x = particles.points[particles["damage"] > 0.35]
    return x[np.argmax(x[:, 0] + x[:, 1])][:2]

