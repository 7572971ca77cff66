"""Pictures of cracks that run: damage at some times, and curves over time. For cases/*/pictures.py."""

import pdxtools
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

STYLE = {"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 9, "savefig.dpi": 160,
         "savefig.bbox": "tight", "axes.spines.top": False, "axes.spines.right": False}  # fmt: skip
COLOURS = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#aa3377"]
plt.rcParams.update(STYLE)


def lattice_image(axes, sites, values):
    """Particles of one lattice as squares coloured by their damage; what is between them stays clear. Sites in the axes'
    unit."""
    spacing = np.diff(np.unique(np.round(sites[:, 0], 9))).min()
    lower = sites.min(axis=0)
    column, row = np.round((sites - lower) / spacing).astype(int).T
    image = np.full((row.max() + 1, column.max() + 1), np.nan)
    image[row, column] = values
    upper = sites.max(axis=0)
    half = spacing / 2
    return axes.imshow(image, origin="lower", cmap="viridis", vmin=0, vmax=0.6, interpolation="nearest",
                       extent=(lower[0] - half, upper[0] + half, lower[1] - half, upper[1] + half))  # fmt: skip


def draw_damage(axes, run, time):
    """Damage of the particles at the stored step nearest to a time; elements stay white."""
    now, blocks = pdxtools.read_step(run, pdxtools.step_at(run, time))
    particles, x = blocks["particles"], blocks["mesh"].points[:, :2] * 1e3
    seen = lattice_image(axes, particles.points[:, :2] * 1e3, particles["damage"] + particles["precrack"])
    axes.set(xlim=(x[:, 0].min(), x[:, 0].max()), ylim=(x[:, 1].min(), x[:, 1].max()), aspect="equal",
             xlabel="$x$ [mm]", ylabel="$y$ [mm]")  # fmt: skip
    axes.set_title(f"{1e6 * now:.2f} µs", fontsize=9)
    return seen


def damage_maps(run, times, path, columns=2, size=(4.2, 2.2)):
    rows = -(-len(times) // columns)
    figure, grid = plt.subplots(rows, columns, figsize=(size[0] * columns, size[1] * rows), squeeze=False,
                                layout="constrained")  # fmt: skip
    for axes, time in zip(grid.flat, times):
        seen = draw_damage(axes, run, time)
    figure.colorbar(seen, ax=grid, fraction=0.02, pad=0.01, label="damage, precrack included")
    figure.savefig(path)
    plt.close(figure)


def curves(runs, name, factor, axes):
    """One column of history.csv over time for runs by label."""
    for colour, (label, run) in zip(COLOURS, runs.items()):
        columns = pdxtools.read_history(run)
        axes.plot(1e6 * columns["time"], factor * columns[name], color=colour, linewidth=1, label=label)
    axes.set(xlabel="time [µs]", xlim=(0, None))
    axes.grid(linewidth=0.3)


def energies(run, axes, unit=(1.0, "J")):
    """Where the energy is, over time."""
    h = pdxtools.read_history(run)
    parts = {
        "kinetic": h["energy_kinetic_elements"] + h["energy_kinetic_particles"],
        "strain": h["energy_elements"] + h["energy_bonds"] + h["energy_interface"],
        "broken bonds": h["energy_fracture"],
        "work": h["work"],
        "residual": h["energy_residual"],
    }
    for colour, (label, values) in zip(COLOURS, parts.items()):
        axes.plot(1e6 * h["time"], unit[0] * values, color=colour, linewidth=1, label=label)
    axes.set(xlabel="time [µs]", ylabel=f"energy [{unit[1]}]", xlim=(0, None))
    axes.grid(linewidth=0.3)
    axes.legend(frameon=False, fontsize=8)


def speed_and_energies(runs, rayleigh, energy_run, path, quoted=()):
    """Speed of the fastest tip for runs by label, beside Rayleigh waves [m/s] and speeds that others quote [m/s]; and
    where the energy of one run is. Runs that are not there are left out."""
    figure, (speed, energy) = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained")
    there = {label: run for label, run in runs.items() if (run / "history.csv").exists()}
    curves(there, "crack_speed", 1.0, speed)
    speed.axhline(rayleigh, color="k", linewidth=0.8, label="Rayleigh waves")
    for value in quoted:
        speed.axhline(value, color="0.5", linewidth=0.8, linestyle=":", label=f"{value:g} m/s")
    speed.set(ylabel="speed of the fastest tip [m/s]", ylim=(0, None))
    speed.legend(frameon=False, fontsize=8)
    energies(energy_run, energy)
    figure.savefig(path)
    plt.close(figure)
