"""Pictures of the last step of one or more runs: elements, particles or both, clouds, material points, solids seen along z.
Each of KINDS takes runs and a Look, and returns a figure."""
import dataclasses

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm, Normalize  # noqa: E402
from matplotlib.ticker import LogFormatterSciNotation  # noqa: E402

from .fields import NotThere, read_step  # noqa: E402
from .motion import picture as motion_picture  # noqa: E402
from .records import read_summary  # noqa: E402

STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 9, "axes.titlesize": 9,
         "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.direction": "out",
         "savefig.dpi": 200, "savefig.bbox": "tight", "savefig.pad_inches": 0.04, "savefig.facecolor": "white"}
DISPLACEMENT_COLOURS, ERROR_COLOURS, ENERGY_COLOURS, DAMAGE_COLOURS = "viridis", "magma_r", "cividis", "YlOrRd"
RANK_COLOURS = ["#4477aa", "#ee6677", "#ccbb44", "#228833", "#66ccee", "#aa3377", "#bbbbbb", "#997700"]
PANEL = 2.9  # [inch]
PLAIN_COLOUR, CUT_COLOUR, PARTICLE_COLOUR, POINT_COLOUR = "white", "#f2d13c", "#2f6fb3", "0.88"
PLAIN, CUT, COVERED = 0, 1, 2  # values of the mesh's field "use"
LEAST_GAP = 0.8  # [pt] particles nearer to each other on paper are drawn without a dot
COMMON_SCALE = 3.0  # runs share a colour scale if their maxima differ by less than this factor
PREFIXES = [(1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")]


@dataclasses.dataclass(frozen=True)
class Look:
    scale: float = 0.0  # magnification of displacements; 0: chosen
    error: str = "auto"  # colours of the error map: auto, linear, log
    steps: tuple = ()  # of motion: numbers of the steps that are drawn; none: all


class NoElements:
    """Stands for the mesh of a body without elements."""

    points, cells = np.zeros((0, 3)), np.zeros((0, 4), int)

    def __contains__(self, name):
        return name in ("displacement", "rank")

    def __getitem__(self, name):
        return np.zeros((0, 3) if name == "displacement" else 0)


class Run:
    """One run, ready to draw: lengths already in the unit of the axes."""

    def __init__(self, directory, number=-1):
        """Throws NotThere for a step without anything to draw, OSError and IndexError as `read_step`."""
        self.directory = directory
        self.summary = read_summary(directory)
        self.time, blocks = read_step(directory, number)
        self.mesh, self.cut = blocks.get("mesh", NoElements()), blocks.get("cut_cells")
        self.particles = next((blocks[name] for name in ("particles", "points") if name in blocks), None)
        self.points = blocks.get("points") if "particles" in blocks else None  # beside particles
        if not self.particles and not len(self.mesh.cells):
            raise NotThere(f"{directory} has neither elements nor particles")
        use = self.mesh["use"] if "use" in self.mesh else np.zeros(len(self.mesh.cells))
        self.plain, self.covered = self.mesh.cells[use == PLAIN], self.mesh.cells[use == COVERED]
        bodies = [block.points[:, :2] for block in (self.mesh, self.particles, self.points) if block]
        self.extent = np.ptp(np.vstack(bodies), axis=0).max()
        self.metre, self.unit = (1e3, "mm") if self.extent < 0.5 else (1.0, "m")

    def largest(self, name):
        """Largest magnitude of a displacement that is drawn, or value of a field of the mesh."""
        if name != "displacement":
            return np.nanmax(np.abs(self.mesh[name]))
        parts = [magnitude(self.mesh)[np.unique(self.plain)]]
        parts += [magnitude(block) for block in (self.particles, self.points) if block]
        return max((p.max() for p in parts if p.size), default=0.0)

    def spacing(self):
        """Distance of neighbouring particles [m], 0 without particles."""
        return self.spacing_of(self.particles)

    def spacing_of(self, block):
        if not block or len(block.points) < 2:
            return 0.0
        gaps = np.diff(np.unique(np.round(block.points[:, 0] / self.extent, 9)))
        if not gaps.size:
            return 0.0
        area = np.prod(np.ptp(block.points[:, :2], axis=0))
        layers = len(np.unique(np.round(block.points[:, 2] / self.extent, 9)))
        even = np.sqrt(area * layers / len(block.points))  # where they lie anywhere, a gap may be very small
        return max(gaps.min() * self.extent, 0.5 * even)

    def label(self):
        if not self.spacing():
            return self.summary.get("case", "")
        return rf"$\Delta x^{{\mathrm{{PD}}}}$ = {self.spacing() * self.metre:.3g} {self.unit}"


def magnitude(block):
    return np.linalg.norm(block["displacement"], axis=1)


def prefixed(value, unit):
    """Factor and name of the unit in which `value` reads well."""
    for factor, letter in PREFIXES:
        if value >= factor:
            return 1.0 / factor, letter + unit
    return 1.0, unit


def magnification(run):
    """1, 2 or 5 times a power of ten that makes the largest displacement about 6 % of the plate."""
    largest = run.largest("displacement")
    if largest == 0.0:
        return 1.0
    wanted = 0.06 * run.extent / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return power * max(step for step in (1, 2, 5) if step * power <= wanted * (1 + 1e-9))


def moved(run, block, scale):
    """Points of a block in the unit of the axes, displacements magnified."""
    x = block.points[:, :2] + (scale * block["displacement"][:, :2] if scale else 0.0)
    return x * run.metre


def extent_of(run, scale):
    """All that is drawn of a run, for the limits of axes."""
    parts = [moved(run, run.mesh, scale)[np.unique(run.plain)]]
    parts += [moved(run, block, scale) for block in (run.particles, run.points, run.cut) if block]
    return np.vstack(parts)


def triangles(cells):
    return np.vstack([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])


def edges(cells):
    """Every edge of the cells once, and how many of the cells share it."""
    pairs = np.vstack([cells[:, [i, (i + 1) % 4]] for i in range(4)])
    return np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)


def shared_norms(maxima, make):
    """A colour scale per run; the same one for all where their maxima are near each other."""
    if max(maxima) <= COMMON_SCALE * min(maxima):
        maxima = [max(maxima)] * len(maxima)
    return [make(m) for m in maxima]


def prepare(axes, run, title):
    axes.set_aspect("equal")
    axes.set_title(title, pad=5)
    axes.set_xlabel(f"$x$ [{run.unit}]", labelpad=1)
    axes.set_ylabel(f"$y$ [{run.unit}]", labelpad=1)
    axes.locator_params(nbins=6)
    axes.spines[["top", "right"]].set_visible(False)


def colour_bar(axes, mappable, label):
    bar = axes.figure.colorbar(mappable, cax=axes.inset_axes([1.03, 0.0, 0.04, 1.0]), label=label)  # as high as the body
    bar.outline.set_linewidth(0.5)
    bar.ax.tick_params(width=0.5)
    if isinstance(mappable.norm, LogNorm):
        bar.ax.yaxis.set_major_formatter(LogFormatterSciNotation())
    return bar


def draw_edges(axes, x, cells, **look):
    pairs, _ = edges(cells)
    axes.add_collection(LineCollection(x[pairs], **{"colors": "0.25", "linewidths": 0.12, "alpha": 0.4, **look}))


def corners_around(x, half):
    return x[:, None, :] + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def draw_points(axes, run, scale, values=None, **look):
    """Material points beside particles, as squares: pale, or each by a value."""
    if not run.points:
        return
    corners = corners_around(moved(run, run.points, scale), 0.5 * run.spacing_of(run.points) * run.metre)
    colours = {"facecolors": POINT_COLOUR} if values is None else {"array": values}
    axes.add_collection(PolyCollection(corners, linewidths=0, antialiaseds=False, snap=False, rasterized=True, **colours, **look))


def draw_particles(axes, run, x, values, **look):
    """A square of its own colour per particle; neighbours overlap a little, so magnified strains open no gaps."""
    squares = PolyCollection(corners_around(x, 0.6 * run.spacing() * run.metre), array=values, linewidths=0, antialiaseds=False, snap=False,
                             rasterized=True, **look)  # fmt: skip
    axes.add_collection(squares)
    return squares


def draw_dots(axes, run, x):
    """A small dot per particle, where there is room to see one; call when the limits of the axes are set."""
    gap = 72.0 * PANEL * run.spacing() * run.metre / np.ptp(axes.get_xlim())  # between particles, on paper [pt]
    if gap > LEAST_GAP:
        axes.scatter(x[:, 0], x[:, 1], s=(0.4 * min(gap, 3.0)) ** 2, c="0.15", alpha=0.55, linewidths=0,
                     rasterized=True)


def set_limits(axes, x):
    lower, upper = x.min(axis=0), x.max(axis=0)
    margin = 0.03 * (upper - lower).max()
    axes.set_xlim(lower[0] - margin, upper[0] + margin)
    axes.set_ylim(lower[1] - margin, upper[1] + margin)


def draw_displacement(axes, run, scale, norm):
    factor, unit = prefixed(norm.vmax, "m")
    norm = Normalize(0.0, factor * norm.vmax)
    look = {"cmap": DISPLACEMENT_COLOURS, "norm": norm}
    x = moved(run, run.mesh, scale)
    set_limits(axes, extent_of(run, scale))
    if len(run.plain):
        axes.tripcolor(x[:, 0], x[:, 1], triangles(run.plain), factor * magnitude(run.mesh), shading="gouraud",
                       rasterized=True, **look)
        draw_edges(axes, x, run.plain)
    if run.cut:
        x = moved(run, run.cut, scale)
        axes.tripcolor(x[:, 0], x[:, 1], triangles(run.cut.cells), factor * magnitude(run.cut), shading="gouraud",
                       rasterized=True, **look)
        draw_edges(axes, x, run.cut.cells)
    if run.points:
        draw_points(axes, run, scale, factor * magnitude(run.points), **look)
    if run.particles:
        x = moved(run, run.particles, scale)
        draw_particles(axes, run, x, factor * magnitude(run.particles), **look)
        draw_dots(axes, run, x)
    prepare(axes, run, f"{run.label()}, deformation × {scale:g}")
    colour_bar(axes, plt.cm.ScalarMappable(**look), rf"$|\,\mathbf{{u}}\,|$ [{unit}]")


def error_norms(runs, colours):
    """Colour scales of the error maps; `auto` is logarithmic where most of a plate is far below its maximum."""
    errors = [np.abs(run.mesh["relative_error_percent"]) for run in runs]
    largest = [np.nanmax(error) or 1.0 for error in errors]
    if colours == "auto":
        colours = "log" if any(np.nanmedian(e) < 0.01 * m for e, m in zip(errors, largest)) else "linear"
    if colours == "linear":
        return shared_norms(largest, lambda m: Normalize(0.0, m))
    return shared_norms(largest, lambda m: LogNorm(1e-3 * m, m))


def draw_error(axes, run, norm):
    x = moved(run, run.mesh, 0.0)
    error = np.abs(run.mesh["relative_error_percent"])
    shown = np.clip(error, norm.vmin, norm.vmax)
    corners = triangles(run.mesh.cells)
    corners = corners[np.isfinite(error[corners]).all(axis=1)]
    set_limits(axes, x)
    surface = axes.tripcolor(x[:, 0], x[:, 1], corners, np.nan_to_num(shown), shading="gouraud", rasterized=True,
                             cmap=ERROR_COLOURS, norm=norm)
    pairs, count = edges(run.covered) if len(run.covered) else (np.empty((0, 2), int), np.empty(0))
    axes.add_collection(LineCollection(x[pairs[count == 1]], colors="0.2", linewidths=0.5))
    prepare(axes, run, f"relative error, max {np.nanmax(error):.3g} %")
    colour_bar(axes, surface, r"$|\mathrm{error}|$ [%]")


def plate(runs, options):
    with_error = all("relative_error_percent" in run.mesh for run in runs)
    columns = 2 if with_error else 1
    figure, grid = panels(len(runs), columns)
    common = options.scale or min(magnification(run) for run in runs)
    norms = shared_norms([run.largest("displacement") for run in runs], lambda m: Normalize(0.0, m or 1.0))
    for row, run, norm in zip(grid, runs, norms):
        draw_displacement(row[0], run, common, norm)
    if with_error:
        norms = error_norms(runs, options.error)
        for row, run, norm in zip(grid, runs, norms):
            draw_error(row[1], run, norm)
            row[1].set(xlim=row[0].get_xlim(), ylim=row[0].get_ylim())
    return figure


def draw_cells(axes, x, cells, colour, **look):
    axes.add_collection(PolyCollection(x[cells], **{"facecolors": colour, "edgecolors": "0.35", "linewidths": 0.25,
                                                    **look}))


def crack(runs, options):
    figure, grid = panels(1, len(runs))
    for axes, run in zip(grid[0], runs):
        scale = options.scale or magnification(run)
        x = moved(run, run.mesh, scale)
        set_limits(axes, extent_of(run, scale))
        draw_cells(axes, x, run.plain, PLAIN_COLOUR)
        if run.cut:
            draw_cells(axes, moved(run, run.cut, scale), run.cut.cells, CUT_COLOUR)
        draw_points(axes, run, scale)
        if run.particles:
            x = moved(run, run.particles, scale)
            gap = 72.0 * PANEL * run.spacing() / run.extent  # between particles, on paper [pt]
            axes.scatter(x[:, 0], x[:, 1], s=(0.8 * gap) ** 2, c=PARTICLE_COLOUR, linewidths=0, rasterized=True)
        prepare(axes, run, f"{run.label()}, deformation × {scale:g}")
    return figure


def damage(runs, options):
    for run in runs:
        if not run.particles or "damage" not in run.particles:
            raise NotThere(f"{run.directory} has no particles with a damage: nothing in it breaks")
    figure, grid = panels(1, len(runs))
    largest = max(run.particles["damage"].max() for run in runs) or 1.0
    for axes, run in zip(grid[0], runs):
        scale = options.scale  # as given; none: bodies as they were
        set_limits(axes, extent_of(run, scale))
        if len(run.plain):
            draw_edges(axes, moved(run, run.mesh, scale), run.plain, colors="0.6", linewidths=0.3)
        draw_points(axes, run, scale)
        order = np.argsort(run.particles["damage"])  # of a solid the most damaged layer is seen
        squares = draw_particles(axes, run, moved(run, run.particles, scale)[order], run.particles["damage"][order],
                                 cmap=DAMAGE_COLOURS, norm=Normalize(0.0, largest))
        prepare(axes, run, run.label())
        colour_bar(axes, squares, "damage [-]")
    return figure


def energy(runs, _options):
    for run in runs:
        if not run.particles or "strain_energy_density" not in run.particles:
            raise NotThere(f"{run.directory} has no particles with a strain energy density")
    figure, grid = panels(1, len(runs))
    values = [run.particles["strain_energy_density"] for run in runs]
    factor, letter = energy_unit(max(v.max() for v in values))
    lowest, highest = (factor * pick for pick in (min(v.min() for v in values), max(v.max() for v in values)))
    for axes, run, density in zip(grid[0], runs, values):
        x = moved(run, run.particles, 0.0)
        set_limits(axes, extent_of(run, 0.0))
        draw_points(axes, run, 0.0)
        if len(run.plain):
            draw_edges(axes, moved(run, run.mesh, 0.0), run.plain, colors="0.6", linewidths=0.3)
        squares = draw_particles(axes, run, x, factor * density, cmap=ENERGY_COLOURS, norm=Normalize(lowest, highest))
        prepare(axes, run, run.label())
        colour_bar(axes, squares, f"strain energy density [{letter}J/m³]")
    return figure


def energy_unit(largest):
    for factor, letter in [(1e6, "M"), (1e3, "k")]:
        if largest >= factor:
            return 1.0 / factor, letter
    return 1.0, ""


def ranks(runs, _options):
    figure, grid = panels(1, len(runs))
    for axes, run in zip(grid[0], runs):
        count = int(max(block["rank"].max() for block in (run.mesh, run.particles, run.points) if block and len(block["rank"]))) + 1
        colours = ListedColormap([RANK_COLOURS[i % len(RANK_COLOURS)] for i in range(count)])
        look = {"cmap": colours, "norm": BoundaryNorm(np.arange(count + 1) - 0.5, count)}
        x = moved(run, run.mesh, 0.0)
        set_limits(axes, extent_of(run, 0.0))
        plain = run.mesh["use"] == PLAIN if "use" in run.mesh else np.ones(len(run.mesh.cells), bool)
        cells = PolyCollection(x[run.plain], array=run.mesh["rank"][plain], edgecolors="white", linewidths=0.1,
                               alpha=0.6, rasterized=True, **look)
        axes.add_collection(cells)
        if run.points:
            draw_points(axes, run, 0.0, run.points["rank"], **look)
        if run.particles:
            draw_particles(axes, run, moved(run, run.particles, 0.0), run.particles["rank"], **look)
        prepare(axes, run, f"{count} rank{'s' if count > 1 else ''}, elements pale, particles full")
        bar = colour_bar(axes, plt.cm.ScalarMappable(**{"norm": look["norm"], "cmap": colours}), "owner")
        bar.set_ticks(range(count))
        bar.ax.tick_params(which="both", length=0)
    return figure


def panels(rows, columns):
    figure, grid = plt.subplots(rows, columns, figsize=(1.28 * PANEL * columns, 1.1 * PANEL * rows), squeeze=False,
                                layout="constrained")
    figure.get_layout_engine().set(wspace=0.05, hspace=0.03)
    return figure, grid


def motion(runs, options):
    return motion_picture(runs[0].directory, options.steps)


KINDS = {"plate": plate, "crack": crack, "damage": damage, "energy": energy, "ranks": ranks, "motion": motion}


def draw(kind, runs, path, look=Look()):
    """Draws runs into a file, whose name says the format."""
    with plt.rc_context(STYLE):
        figure = KINDS[kind](runs, look)
        figure.savefig(path, dpi=110 if kind == "motion" else None)
        plt.close(figure)
