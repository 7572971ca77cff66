"""Reads what a run of pdxsolve leaves on disk: fields.h5 and summary.json (see src/README.md, room io)."""
import csv
import json
import pathlib
import sys

import right_python  # noqa: F401  (goes on under another python3 where this one lacks the modules below)

try:
    import h5py
    import numpy as np
except ImportError as missing:
    sys.exit(f"{missing}: the scripts need h5py, numpy and matplotlib (Debian: python3-h5py python3-numpy "
             "python3-matplotlib, with /usr/bin/python3)")


class Block:
    """One set of points with its cells and fields; scalars are flat, vectors and tensors have a column each."""

    def __init__(self, group):
        data = {name: np.asarray(item) for name, item in group.items()}
        self.points = data.pop("points")
        self.cells = data.pop("cells")
        self.natural_point = data.pop("natural_point")[:, 0]
        self.fields = {name: values[:, 0] if values.shape[1] == 1 else values for name, values in data.items()}

    def __contains__(self, name):
        return name in self.fields

    def __getitem__(self, name):
        return self.fields[name]


def fields_path(run):
    """The fields.h5 of a run, given its directory or the file itself."""
    path = pathlib.Path(run)
    return path / "fields.h5" if path.is_dir() else path


def read_step(run, number=-1):
    """Time (or load factor) and blocks by name of one step, by default the last one."""
    with h5py.File(fields_path(run), "r") as file:
        step = file[sorted(file)[number]]
        return float(step.attrs["time"]), {name: Block(group) for name, group in step.items()}


def step_count(run):
    with h5py.File(fields_path(run), "r") as file:
        return len(file)


def read_summary(run):
    """The run's summary.json; empty if it has none."""
    path = fields_path(run).with_name("summary.json")
    return json.loads(path.read_text()) if path.exists() else {}


def read_curve(path):
    """Columns of a curve (history.csv, crack_path.csv) by name without unit."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = [name.split(" ")[0] for name in rows[0]]
    return dict(zip(names, np.array(rows[1:], dtype=float).reshape(-1, len(names)).T))


def read_history(run):
    """Columns of history.csv by name without unit."""
    return read_curve(pathlib.Path(run) / "history.csv")
