"""Describes the fields of a run as VTKHDF, for ParaView 5.12 (VTK 9.3) and newer: `fields_BLOCK.vtkhdf` for each block
beside fields.h5. The files are small: what they show stays in fields.h5, which must lie beside them; --whole copies it in,
compressed. What does not change from step to step is named once.

usage: {name} OUT_DIR [--whole]
Older ones read fields.xdmf alone: ParaView 5.11 of Debian 12 has VTKHDF without time.
"""

import argparse
import pathlib
import sys

import h5py
import numpy as np

from .fields import fields_path, step_names

VERTEX, QUADRILATERAL = 1, 9  # types of cells in VTK
TENSOR_ORDER = (0, 3, 5, 1, 4, 2)  # VTK's xx, yy, zz, xy, yz, xz in ours
GEOMETRY = ("points", "cells", "natural_point")
SMALL = {"compression": "gzip", "shuffle": True}


class Table:
    """One quantity of all steps: rows of its datasets one behind the other, each dataset once."""

    def __init__(self):
        self.sources, self.starts, self.rows = [], {}, 0

    def place(self, dataset):
        """First row of a dataset in the table."""
        start = self.starts.get(dataset.id)
        if start is None:
            start = self.starts[dataset.id] = self.rows
            self.sources.append(dataset)
            self.rows += len(dataset)
        return start

    def write(self, group, name, whole, flat=False):
        """As a table of views into fields.h5, or of copies. `flat`: all numbers in one row."""
        first = self.sources[0]
        columns = first.shape[1]
        order = TENSOR_ORDER if columns == 6 else None
        shape = (self.rows * columns,) if flat else (self.rows,) if columns == 1 else (self.rows, columns)
        if whole:
            values = np.concatenate([source[()] for source in self.sources])
            values = values[:, order] if order else values
            group.create_dataset(name, data=values.reshape(shape), **(SMALL if values.size else {}))
            return
        layout = h5py.VirtualLayout(shape, first.dtype)
        for source in self.sources:
            view = h5py.VirtualSource(pathlib.Path(source.file.filename).name, source.name, source.shape, source.dtype)
            rows = slice(self.starts[source.id], self.starts[source.id] + len(source))
            if flat or columns == 1:
                layout[rows.start * columns : rows.stop * columns] = view
            else:
                for column in range(columns):
                    layout[rows, column] = view[:, order[column] if order else column]
        group.create_virtual_dataset(name, layout)


class Series:
    """One block of all steps."""

    def __init__(self, steps, name):
        self.name, self.steps = name, steps
        self.blocks = [step.get(name) for step in steps]
        there = [block for block in self.blocks if block is not None]
        self.fields = [field for field in there[0] if field not in GEOMETRY and all(field in block for block in there)]
        self.on_cells = {field: len(there[0][field]) == len(there[0]["cells"]) != len(there[0]["points"]) for field in self.fields}
        self.corners = there[0]["cells"].shape[1]

    def write(self, path, whole):
        points, cells, fields = Table(), Table(), {field: Table() for field in self.fields}
        parts, part_of, offsets = [], {}, {field: [] for field in self.fields}
        for block in self.blocks:
            key = block is not None and (block["points"].id, block["cells"].id)
            if key not in part_of:
                part_of[key] = len(parts)
                parts.append((0, 0, points.rows, cells.rows) if block is None else
                             (len(block["points"]), len(block["cells"]), points.place(block["points"]), cells.place(block["cells"])))  # fmt: skip
            for field in self.fields:
                offsets[field].append(0 if block is None else fields[field].place(block[field]))
        with h5py.File(path, "w") as file:
            root = file.create_group("VTKHDF")
            root.attrs["Version"] = np.array([2, 0])
            root.attrs.create("Type", np.bytes_("UnstructuredGrid"), dtype=h5py.string_dtype("ascii", len("UnstructuredGrid")))
            self.write_cells(root, parts, cells, whole)
            points.write(root, "Points", whole)
            for field, table in fields.items():
                table.write(root.require_group("CellData" if self.on_cells[field] else "PointData"), field, whole)
            self.write_steps(root, parts, [part_of[block is not None and (block["points"].id, block["cells"].id)] for block in self.blocks],
                             offsets)  # fmt: skip

    def write_cells(self, root, parts, cells, whole):
        counts = np.array([part[:2] for part in parts])
        root["NumberOfPoints"], root["NumberOfCells"] = counts[:, 0], counts[:, 1]
        root["NumberOfConnectivityIds"] = self.corners * counts[:, 1]
        ends = [self.corners * np.arange(count + 1, dtype=np.int32) for count in counts[:, 1]]  # of one type with the next
        root.create_dataset("Offsets", data=np.concatenate(ends), **SMALL)
        kind = VERTEX if self.corners == 1 else QUADRILATERAL
        root.create_dataset("Types", data=np.full(cells.rows, kind, np.uint8), **SMALL)
        cells.write(root, "Connectivity", whole, flat=True)

    def write_steps(self, root, parts, part_of, offsets):
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = len(self.steps)
        steps["Values"] = np.array([float(step.attrs["time"]) for step in self.steps])
        steps["PartOffsets"] = np.array(part_of)
        steps["NumberOfParts"] = np.ones(len(part_of), int)
        place = np.array([parts[part] for part in part_of])
        steps["PointOffsets"] = place[:, 2]
        steps["CellOffsets"] = place[:, 3:]
        steps["ConnectivityIdOffsets"] = self.corners * place[:, 3:]
        for field, starts in offsets.items():
            kind = "CellDataOffsets" if self.on_cells[field] else "PointDataOffsets"
            steps.require_group(kind)[field] = np.array(starts)


def write(run, whole=False):
    """Writes the files of a run and returns their paths. OSError where it has no fields."""
    path = fields_path(run)
    written = []
    with h5py.File(path, "r") as file:
        steps = [file[name] for name in step_names(file)]
        for name in dict.fromkeys(block for step in steps for block in step):
            written.append(path.with_name(f"fields_{name}.vtkhdf"))
            Series(steps, name).write(written[-1], whole)
    return written


def main():
    name = pathlib.Path(sys.argv[0]).name
    parser = argparse.ArgumentParser(description=__doc__.format(name=name), formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="OUT_DIR")
    parser.add_argument("--whole", action="store_true", help="files that need no fields.h5 beside them, compressed")
    options = parser.parse_args()
    try:
        for path in write(options.run, options.whole):
            print(f"wrote {path}, {path.stat().st_size / 1e3:.1f} kB")
    except (OSError, KeyError) as error:
        sys.exit(f"{name}: cannot read the fields of {options.run}: {error}")


if __name__ == "__main__":
    main()
