#!/usr/bin/env python3
"""Writes an XDMF file of one step and one block of a run, beside which the data stay in fields.h5: what meshio.read, and
whoever else cannot read a series of several blocks, takes.

usage: one_step.py OUT_DIR [--step -1] [--block mesh|particles|points|cut_cells] -o step.xdmf
"""

import argparse
import os
import pathlib
import sys
import xml.etree.ElementTree as xml


def grid_of(run, step, block):
    """The entry of fields.xdmf for one block of one step, and the names of its blocks."""
    steps = xml.parse(run / "fields.xdmf").getroot().findall("./Domain/Grid/Grid")
    try:
        grids = {grid.get("Name"): grid for grid in steps[step].findall("Grid")}
    except IndexError:
        sys.exit(f"one_step.py: {run} has {len(steps)} steps with fields, but not number {step}")
    if block and block not in grids:
        sys.exit(f"one_step.py: step {step} has no block {block}: choose from {', '.join(grids)}")
    return grids[block or next(iter(grids))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="OUT_DIR", type=pathlib.Path)
    parser.add_argument("--step", type=int, default=-1, help="number of the step, from 0, or -1 for the last")
    parser.add_argument("--block", help="default: the first")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path)
    options = parser.parse_args()
    try:
        grid = grid_of(options.run, options.step, options.block)
    except (OSError, xml.ParseError) as error:
        sys.exit(f"one_step.py: cannot read the run: {error}")
    beside = os.path.relpath(options.run.resolve(), options.output.resolve().parent)
    for item in grid.iter("DataItem"):
        item.text = os.path.normpath(os.path.join(beside, item.text.strip()))
    document = xml.Element("Xdmf", Version="3.0")
    xml.SubElement(document, "Domain").append(grid)
    xml.ElementTree(document).write(options.output, xml_declaration=True, encoding="utf-8")
    print(f"wrote {options.output}")


if __name__ == "__main__":
    main()
