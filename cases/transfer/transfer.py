"""What check.py and study.py of the transfer know: its runs, and what they read from them."""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import numpy as np

ELEMENT = 2e-3  # h [m]
YOUNG, POISSON, DENSITY = 200e9, 1.0 / 3.0, 7850.0
SPEED = np.sqrt(YOUNG / (1.0 - POISSON**2) / DENSITY)  # of plane waves in plane stress [m/s]
EVERY = 20  # steps from one change to the next
COURANT = 0.8  # spacings that such a wave runs in a step
# What changes hands: x0, y0, x1, y1 [h]; what stays [m]; when all has left it [h / SPEED]
BLOCK = {"strip": (20, 1, 40, 25), "low": (20, 1, 40, 13), "plate": (24, 24, 36, 36)}
STAYS = {"strip": "0.152,0.024,0.156,0.028", "plate": "0.004,0.004,0.008,0.008"}
LOW = ["-mesh_upper", "0.16,0.028", "-mesh_cells", "80,14", "-pd_patches", "0.152,0.012,0.156,0.016"]
END = {"strip": 78, "low": 78, "plate": 26}
PEAK = {"strip": 1e6 / DENSITY / SPEED, "plate": 1.0}  # [m/s]
BUMP = 2.0  # half of its width [h]
RATIOS = (2, 5, 10)
KINDS = {"strip": ("elements", "particles", "changes"), "low": ("changes",), "plate": ("elements", "changes")}


def options(scene, ratio, kind):
    """What is said after the options file of the scene. At the end the block is elements again."""
    turns = int(np.ceil(END[scene] * ratio / COURANT / (2 * EVERY)))
    steps, step = 2 * EVERY * turns + EVERY // 2, COURANT * ELEMENT / ratio / SPEED
    block = ",".join(f"{ELEMENT * x:g}" for x in BLOCK[scene])
    words = ["-pd_spacing", f"{ELEMENT / ratio:.10g}", "-ts_dt", f"{step:.9e}", "-ts_max_steps", str(steps)]
    words += ["-output_times", f"{(steps - 1) * step:.9e}", "-output_history_interval", str(EVERY)]
    if scene == "low":
        words += LOW
    if scene == "plate":
        words += bump()
    if kind == "particles":
        words += ["-pd_patches", f"{block},{STAYS[scene]}"]
    if kind == "changes":
        words += ["-layout_renew_interval", str(EVERY), "-layout_renew_box", block]
    return words


def bump():
    """The nodes of the bump, each with its velocity."""
    reach = int(2.5 * BUMP)
    middle = np.add(BLOCK["plate"][:2], BLOCK["plate"][2:]) // 2
    names, words, near = [], [], 0.4 * ELEMENT  # of no other node, but of particles
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            if i * i + j * j > reach * reach:
                continue
            x, y = ELEMENT * (middle + (i, j))
            name = f"n{len(names)}"
            names.append(name)
            words += [f"-bc_{name}_box", f"{x - near:.9g},{y - near:.9g},{x + near:.9g},{y + near:.9g}"]
            words += [f"-bc_{name}_initial_velocity", f"{PEAK['plate'] * np.exp(-(i * i + j * j) / BUMP**2):.9g},0"]
    return ["-bc_names", ",".join(names), *words]


def velocity(run):
    """Places of the nodes [h] and their mean velocity over the last step [m/s], in natural order."""
    times, moved = [], []
    for number in (-2, -1):
        time, blocks = pdxtools.read_step(run, number)
        mesh = blocks["mesh"]
        order = np.argsort(mesh.natural_point)
        times.append(time)
        moved.append(mesh["displacement"][order, :2])
    return mesh.points[order, :2] / ELEMENT, (moved[1] - moved[0]) / (times[1] - times[0])


def gained(run):
    """What each change gave, over all the energy there is."""
    results = pdxtools.read_summary(run)["results"]
    whole = results["external_work"] + results["initial_energy"]
    return np.diff(pdxtools.read_history(run)["energy_relocated"]) / whole


def gained_without_sides(run, low):
    """What all changes gave in a strip without sides along the wave: from two heights."""
    high = BLOCK["strip"][3] - BLOCK["strip"][1]
    ratio = high / (BLOCK["low"][3] - BLOCK["low"][1])
    return (ratio * gained(run).sum() - gained(low).sum()) / (ratio - 1)


class Transfer:
    """Runs of one scene, by kind: what changes of the block do to energy, to what is left there and to the wave. A wave of
    elements is slower than one of particles; what a block should do that is both by turns lies half way."""

    def __init__(self, scene, runs):
        energy = gained(runs["changes"])
        self.relocations = pdxtools.read_summary(runs["changes"])["relocations"]
        self.energy = energy.sum()
        self.energy_each = np.abs(energy[np.abs(energy) > 1e-5]).mean()  # where there is something
        lower, upper = np.reshape(BLOCK[scene], (2, 2))
        moved = {kind: velocity(run) for kind, run in runs.items()}
        x = moved["changes"][0]
        between = np.mean([moved[kind][1] for kind in KINDS[scene][:-1]], axis=0)
        gap, wanted = (np.linalg.norm(v, axis=1) for v in (moved["changes"][1] - between, between))
        around = ((x >= lower - 2) & (x <= upper + 2)).all(axis=1)
        self.noise = gap[around].max() / PEAK[scene]
        ahead = x[:, 0] > upper[0] + 2
        self.pulse = np.sqrt((gap[ahead] ** 2).sum() / (wanted[ahead] ** 2).sum())
