"""What a run writes beside its fields: summary.json, curves as CSV, options.opts, citations.bib."""

import csv
import dataclasses
import json
import re

import numpy as np

from .fields import fields_path


def directory_of(run):
    return fields_path(run).parent


def read_summary(run):
    """The run's summary.json; empty if it has none."""
    path = directory_of(run) / "summary.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def table_of(path):
    """The head of a curve as (name, unit), and its rows."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    head = [re.fullmatch(r"([^ ]*)(?: \[(.*)\])?", name.strip()) for name in rows[0]]
    return [(match[1], match[2] or "-") for match in head], rows[1:]


def read_curve(path):
    """Columns of a curve (history.csv, crack_path.csv, probe_NAME.csv) by name without unit."""
    head, rows = table_of(path)
    return dict(zip([name for name, _ in head], np.array(rows, dtype=float).reshape(-1, len(head)).T))


def read_units(path):
    """Units of a curve's columns by name."""
    return dict(table_of(path)[0])


def read_history(run):
    """Columns of history.csv by name without unit."""
    return read_curve(directory_of(run) / "history.csv")


def read_crack_paths(run):
    """The way of each tip by its number: columns of crack_path.csv. Empty if the run followed none."""
    path = directory_of(run) / "crack_path.csv"
    if not path.exists():
        return {}
    columns = read_curve(path)
    tips = columns.pop("tip")
    return {int(tip): {name: values[tips == tip] for name, values in columns.items()} for tip in np.unique(tips)}


def read_probe(run, name):
    """Columns of a probe. Of a line, `along` has the places and every other column a row a time: (times x places)."""
    columns = read_curve(directory_of(run) / f"probe_{name}.csv")
    if "along" not in columns:
        return columns
    places = np.unique(columns["along"])
    shape = (-1, len(places))
    table = {key: values.reshape(shape) for key, values in columns.items()}
    return {key: values[:, 0] if key in ("step", "time", "load") else values for key, values in table.items()} | {
        "along": places
    }


def read_probes(run):
    """All probes of a run by name."""
    paths = sorted(directory_of(run).glob("probe_*.csv"))
    names = [path.stem.removeprefix("probe_") for path in paths]
    return {name: read_probe(run, name) for name in names}


@dataclasses.dataclass(frozen=True)
class Option:
    name: str
    value: str
    place: str  # where it was given: "case.opts, line 3"; "" if left at its default
    room: str

    @property
    def given(self):
        return bool(self.place)


def unquoted(value):
    return value[1:-1] if len(value) > 1 and value[0] == value[-1] and value[0] in "\"'" else value


def read_options(run):
    """All options of a run in the order of options.opts, those left at their default too."""
    path = directory_of(run) / "options.opts"
    if not path.exists():
        return []
    options, room = [], ""
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("# --- "):
            room = line.removeprefix("# --- ").strip()
        elif match := re.fullmatch(r"# (-[A-Za-z]\w*) ?(.*)", line):
            options.append(Option(match[1], match[2], "", room))
        elif match := re.fullmatch(r"""(-\w+)(?: +("[^"]*"|'[^']*'|\S+))? +# (.*)""", line):
            options.append(Option(match[1], unquoted(match[2] or ""), match[3], room))
    return options


def read_citations(run):
    """What a run should cite: (why, BibTeX entry) each."""
    path = directory_of(run) / "citations.bib"
    if not path.exists():
        return []
    parts = re.split(r"(?m)^% ", path.read_text(encoding="utf-8"))[2:]  # the head is the first
    return [tuple(part.strip().split("\n", 1)) for part in parts]
