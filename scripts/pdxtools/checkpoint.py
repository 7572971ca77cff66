"""checkpoint.h5: the state of an explicit run at one step, by numbers and tables."""

import dataclasses
import pathlib

import h5py
import numpy as np

from .fields import text_of


@dataclasses.dataclass(frozen=True)
class Checkpoint:
    numbers: dict  # what the clock and the books have come to: "time" [s], "step", "relocations" ...
    options: dict  # what makes the scene this one, a line each by name
    scene: dict  # as it stood
    made_by: dict  # version, commit, compiler, host, ranks
    tables: dict  # shape of every other table by its path

    @property
    def time(self):
        return self.numbers["time"]

    @property
    def step(self):
        return int(self.numbers["step"])


def lines_of(dataset):
    return bytes(np.asarray(dataset)[:, 0]).decode().splitlines()


def named(lines):
    return dict(line.split(" = ", 1) if " = " in line else (line, "") for line in lines)


def read_checkpoint(path):
    """The head of a checkpoint, given the file or the directory of its run. Its hashes are not looked at: the program does
    that when it goes on from it."""
    path = pathlib.Path(path)
    with h5py.File(path / "checkpoint.h5" if path.is_dir() else path, "r") as file:
        values = np.asarray(file["numbers"])[:, 0]
        numbers = dict(zip(lines_of(file["number_names"]), map(float, values)))
        tables = {}
        file.visititems(lambda name, item: tables.update({name: item.shape}) if isinstance(item, h5py.Dataset) else None)
        texts = {name: named(lines_of(file[name])) for name in ("options", "scene")}
        for name in ("numbers", "number_names", "options", "scene"):
            tables.pop(name)
        made_by = {name: text_of(value) for name, value in file.attrs.items()}
    return Checkpoint(numbers, texts["options"], texts["scene"], made_by, tables)
