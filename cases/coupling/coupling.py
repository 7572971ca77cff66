"""What check.py and study.py of the coupling know: its runs, and what they read from them."""

import csv
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import pdxtools
import numpy as np

SPEED = np.sqrt(1.0 / (1.0 - 1.0 / 9.0))  # of plane waves [spacings per unit of time]
PEAK = 1e-6  # of the pulse [spacings]
WIDTHS = (8, 16)  # of the pulse, between its peak and where it has fallen to 1/e [spacings]
ARRIVED = 240  # where its peak is when it is looked at: its tail has left the block, what comes back is on its way [spacings]
STEP = 0.4
BLOCK = "160,16,200,48"
BAND = "160,2,200,62"  # all but the cells at the rollers
ASIDE = "310,30,314,34"  # where nothing comes to: no block
CARRIERS = ("points", "elements")
COUPLINGS = {
    "energy": [],
    "face_mass": ["-couple_face_mass", "1"],
    "handshake": {"points": ["-mpm_coupling", "handshake"], "elements": ["-couple_scheme", "ghost"]},
}
# Cells of the ringing square, 2 x 2 spacings each, without a pattern.
NUMBERS = np.random.default_rng(7).permutation(14 * 14)[:60]
SCATTERED = ",".join(f"{6 + 2 * (n % 14)},{6 + 2 * (n // 14)},{8 + 2 * (n % 14)},{8 + 2 * (n // 14)}" for n in sorted(NUMBERS))
PATTERNS = {"block": "12,12,28,28", "scattered": SCATTERED}


def coupled(coupling, carrier):
    words = COUPLINGS[coupling]
    return words if isinstance(words, list) else words[carrier]


def pulse(carrier, width, coupling, block=BLOCK):
    """What is said after points.opts or elements.opts. Coupling "alone": no block."""
    begin = 3.5 * width / SPEED
    steps = int(np.ceil((begin + ARRIVED / SPEED) / STEP))
    words = ["-bc_push_history_time", repr(begin), "-bc_push_history_width", repr(width / SPEED)]
    words += ["-ts_dt", repr(STEP), "-ts_max_steps", str(steps), "-ts_max_time", "1e9", "-probe_line_every", str(steps)]
    if coupling == "alone":
        return [*words, "-pd_patches", ASIDE]
    return [*words, "-pd_patches", block, *coupled(coupling, carrier)]


def ringing(carrier, pattern, coupling):
    """What is said after points_drift.opts or elements_drift.opts."""
    return ["-pd_patches", PATTERNS[pattern], *coupled(coupling, carrier)]


def moved(run):
    """Places on the middle line and displacement along it when the peak is at ARRIVED, over the peak."""
    with open(pathlib.Path(run) / "probe_line.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = [name.split(" ")[0] for name in rows[0]]
    table = np.array(rows[1:], dtype=float)
    last = table[table[:, names.index("step")] == table[-1, names.index("step")]]
    return 1.0 + last[:, names.index("along")], last[:, names.index("displacement_x")] / PEAK


def reflection(run):
    """Largest displacement in front of the block, over the peak: all that comes back is there, and nothing else."""
    x, u = moved(run)
    return np.abs(u[x < 160]).max()


def left_behind(run, alone, width):
    """Largest difference from the strip without a block behind the pulse, in the block and before it, over the peak."""
    x, u = moved(run)
    return np.abs(u - moved(alone)[1])[x < ARRIVED - 4 * width].max()


def drift(run):
    """Of the energy in 1e4 steps, and the stable step."""
    results = pdxtools.read_summary(run)["results"]
    return results["energy_drift_ratio"], results["stable_step"]
