"""fields.h5: one group a step, in it one a block (mesh, cut_cells, particles, points) with points, cells and fields."""

import pathlib

import h5py
import numpy as np

CELL_USES = {0: "element", 1: "cut by a crack", 2: "covered by particles", 3: "material points"}  # `use` of mesh
PARTICLE_KINDS = {0: "inner", 1: "near a border, a crack or a side", 2: "held"}  # `kind` of particles
TENSOR = ("xx", "xy", "xz", "yy", "yz", "zz")  # columns of a symmetric tensor


class NotThere(ValueError):
    """A run has not what was asked for; the text says what it has."""


class Block:
    """One set of points with its cells and fields; scalars are flat, vectors and tensors have a column each.

    points [m] (count x 3), cells (count x 4, or x 1 for bare points), natural_point: numbers of the points that do not
    depend on the number of ranks, fields and units by name.
    """

    def __init__(self, group):
        data = {name: np.asarray(item) for name, item in group.items()}
        self.points = data.pop("points")
        self.cells = data.pop("cells")
        self.natural_point = data.pop("natural_point")[:, 0]
        self.fields = {name: values[:, 0] if values.shape[1] == 1 else values for name, values in data.items()}
        self.units = {name: text_of(group[name].attrs.get("unit", "")) for name in self.fields}

    def __contains__(self, name):
        return name in self.fields

    def __getitem__(self, name):
        if name not in self.fields:
            raise NotThere(f"no field {name}: there are {', '.join(sorted(self.fields))}")
        return self.fields[name]

    def on_cells(self, name):
        """Whether a field has a value a cell, not a point."""
        return len(self[name]) == len(self.cells) != len(self.points)


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def fields_path(run):
    """The fields.h5 of a run, given its directory or the file itself."""
    path = pathlib.Path(run)
    return path / "fields.h5" if path.is_dir() else path


def step_names(file):
    return sorted(name for name in file if name.startswith("step"))


def read_step(run, number=-1):
    """Time (or load factor) and blocks by name of one step, by default the last one. OSError where there is no file,
    IndexError where there is no such step."""
    with h5py.File(fields_path(run), "r") as file:
        step = file[step_names(file)[number]]
        return float(step.attrs["time"]), {name: Block(group) for name, group in step.items()}


def step_times(run):
    """Time [s] (or load factor) of each step."""
    with h5py.File(fields_path(run), "r") as file:
        return np.array([float(file[name].attrs["time"]) for name in step_names(file)])


def step_count(run):
    with h5py.File(fields_path(run), "r") as file:
        return len(step_names(file))


def step_at(run, time):
    """Number of the stored step nearest to a time [s] (or load factor)."""
    return int(np.argmin(np.abs(step_times(run) - time)))
