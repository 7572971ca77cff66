"""Curves of a run over time or load: columns of history.csv that belong together in one picture each."""

import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
import numpy as np  # noqa: E402

from .records import read_crack_paths, read_history, read_probes, read_units  # noqa: E402

STYLE = {"font.family": "sans-serif", "font.size": 9, "axes.titlesize": 10, "axes.titleweight": "bold", "axes.titlelocation": "left",
         "axes.linewidth": 0.6, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "grid.linewidth": 0.3,
         "grid.color": "0.8", "lines.linewidth": 1.3, "legend.frameon": False, "legend.fontsize": 8, "svg.fonttype": "none",
         "svg.hashsalt": "pdxtools"}  # fmt: skip
COLOURS = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#aa3377", "#66ccee", "#777777", "#994400"]
PREFIXES = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")]
# Title, columns, and whether those that are zero throughout are left out.
GROUPS = [
    ("Forces of supports", r"reaction_.*|force(_.*)?|contact_force.*"),
    ("Energies", r"energy_(?!residual|scheme|relocated).*|work"),
    ("What the energies leave over", r"energy_(residual|scheme|relocated)"),
    ("Length of cracks", r"crack_length|tip_between_.*"),
    ("Speed of the fastest tip", r"crack_speed"),
    ("Places of tips", r"tip\d+_[xyz]"),
    ("Tips of cracks", r"crack_tips"),
    ("Broken bonds", r"bonds_broken"),
    ("Particles, elements and points", r"particles|elements|points"),
    ("Changes of the layout", r"relocations"),
    ("Momentum", r"momentum_.*"),
    ("Angular momentum", r"angular_momentum.*"),
    ("Mean velocity of bodies", r"velocity_.*"),
    ("J", r"j_.*|energy_release.*"),
    ("Stress intensity of tips", r"tip\d+_k[12]"),
    ("T-stress of tips", r"tip\d+_t_stress"),
    ("Solves", r"newton.*|linear.*|iterations.*|halvings"),
]


def prefixed(largest, unit):
    """What to multiply by, and the unit's name then. Numbers without a unit, and degrees, stay as they are."""
    if unit in ("", "-", "%", "degrees") or not np.isfinite(largest) or largest <= 0.0 or "^" in unit or "1/" in unit:
        return 1.0, unit
    for factor, letter in PREFIXES:
        if largest >= factor:
            return 1.0 / factor, letter + unit
    return 1.0, unit


def abscissa(columns):
    """Name of the column that others are drawn over."""
    return next(name for name in ("time", "load", "step") if name in columns)


def largest_of(arrays):
    values = np.concatenate([np.abs(a[np.isfinite(a)]) for a in arrays] or [np.zeros(0)])
    return values.max() if values.size else 0.0


def readable(name):
    return name.replace("_", " ")


def draw_columns(axes, columns, names, units):
    """The columns `names` over time or load; those that say nothing all the time are left out unless all do."""
    names = [name for name in names if largest_of([columns[name]]) > 0.0] or names[:1]
    over = abscissa(columns)
    x_factor, x_unit = prefixed(largest_of([columns[over]]), units[over])
    factor, unit = prefixed(largest_of([columns[name] for name in names]), units[names[0]])
    for k, name in enumerate(names):
        axes.plot(x_factor * columns[over], factor * columns[name], label=readable(name), color=COLOURS[k % len(COLOURS)],
                  linestyle="-" if k < len(COLOURS) else "--")  # fmt: skip
    axes.set_xlabel(over if x_unit == "-" else f"{over} [{x_unit}]")
    axes.set_ylabel(readable(names[0]) if unit == "-" else f"[{unit}]")
    if len(names) > 1:
        axes.legend()


def grouped(columns, units):
    """Title and names of columns of each picture, columns of one unit together."""
    left = [name for name in columns if name not in ("step", "time", "load")]
    for title, pattern in GROUPS:
        names = [name for name in left if re.fullmatch(pattern, name)]
        for unit in dict.fromkeys(units[name] for name in names):
            yield title, [name for name in names if units[name] == unit]
        left = [name for name in left if name not in names]
    for name in left:
        yield readable(name), [name]


def figure_of(title, draw, aspect=0.62):
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(4.6, 4.6 * aspect), layout="constrained")
        draw(axes)
        axes.set_title(title)
    return figure


def history_figures(run):
    """A figure for each group of columns of history.csv; none if the run has no rows."""
    try:
        columns, units = read_history(run), read_units(run / "history.csv")
    except FileNotFoundError:
        return
    if len(columns["step"]) > 1:
        for title, names in grouped(columns, units):
            yield figure_of(title, lambda axes, names=names: draw_columns(axes, columns, names, units))


def probe_figures(run):
    """A figure for each probe and unit; of a line the last values along it."""
    for name, columns in read_probes(run).items():
        units = read_units(run / f"probe_{name}.csv")
        values = [column for column in columns if column not in ("step", "time", "load", "along")]
        for unit in dict.fromkeys(units[value] for value in values):
            mine = [value for value in values if units[value] == unit]
            if "along" in columns:
                last = {value: columns[value][-1] for value in mine} | {"time": columns["along"]}
                names = units | {"time": "m"}
                figure = figure_of(f"Probe {name}, the end", lambda axes, c=last, m=mine, u=names: draw_columns(axes, c, m, u))
                figure.axes[0].set_xlabel(figure.axes[0].get_xlabel().replace("time", "along"))
            else:
                figure = figure_of(f"Probe {name}", lambda axes, c=columns, m=mine, u=units: draw_columns(axes, c, m, u))
            yield figure


def crack_figure(run):
    """The way of each tip in the plane, or None."""
    paths = {tip: path for tip, path in read_crack_paths(run).items() if len(path["x"]) > 1}
    if not paths:
        return None
    factor, unit = prefixed(largest_of([np.concatenate((path["x"], path["y"])) for path in paths.values()]), "m")

    def draw(axes):
        for k, (tip, path) in enumerate(paths.items()):
            axes.plot(factor * path["x"], factor * path["y"], ".-", markersize=2, linewidth=0.8, label=f"tip {tip}",
                      color=COLOURS[k % len(COLOURS)])  # fmt: skip
        axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", aspect="equal")
        axes.legend()

    return figure_of("Ways of the tips", draw)
