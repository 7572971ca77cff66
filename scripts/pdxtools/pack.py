"""Rewrites the fields.h5 of a run that has ended compressed, so that all that read it read it as before: ParaView, h5py,
the scripts, a restart that goes on in it. Values stay the same to the last bit.

usage: {name} OUT_DIR [...] [--level 4]
"""

import argparse
import os
import pathlib
import sys

import h5py

from .fields import fields_path

LEAST = 32768  # [B] smaller tables stay as they are
CHUNK = 1 << 20  # [B] of values


def copied(source, target, level, places):
    """Groups, attributes and tables; one that has several names is written once."""
    for name, value in source.attrs.items():
        target.attrs[name] = value
    for name, item in source.items():
        if isinstance(item, h5py.Group):
            copied(item, target.create_group(name), level, places)
        elif item.id in places:
            target[name] = target.file[places[item.id]]
        else:
            small = item.nbytes < LEAST
            rows = max(1, min(len(item), CHUNK // max(1, item.dtype.itemsize * item.shape[1]))) if not small else None
            packing = {} if small else {"chunks": (rows, item.shape[1]), "compression": "gzip", "compression_opts": level,
                                        "shuffle": True}  # fmt: skip
            table = target.create_dataset(name, data=item[()], dtype=item.dtype, track_times=False, **packing)
            for key, value in item.attrs.items():
                table.attrs[key] = value
            places[item.id] = table.name


def pack(run, level=4):
    """Sizes of the file before and after [B]. OSError where there is none, or no room for both."""
    path = fields_path(run)
    part = path.with_name(path.name + ".part")
    before = path.stat().st_size
    try:
        with h5py.File(path, "r") as source, h5py.File(part, "w") as target:
            copied(source, target, level, {})
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    return before, path.stat().st_size


def main():
    name = pathlib.Path(sys.argv[0]).name
    parser = argparse.ArgumentParser(description=__doc__.format(name=name), formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="OUT_DIR")
    parser.add_argument("--level", type=int, default=4, choices=range(1, 10), metavar="1..9", help="of gzip")
    options = parser.parse_args()
    for run in options.runs:
        try:
            before, after = pack(run, options.level)
        except OSError as error:
            sys.exit(f"{name}: cannot pack the fields of {run}: {error}")
        print(f"{fields_path(run)}: {before / 1e6:.2f} MB, now {after / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
