#!/usr/bin/env python3
"""Writes plate.msh: 600 x 600 mm with a hole of radius 10 mm in the middle. Rings of cells around the hole up to a square of 31.5
mm, squares on either side of it where cracks end, longer cells further out. With an odd number of cells along the square, cracks
along x run through their middle.

usage: mesh.py [--cells 21] [--layers 8] [--output plate.msh]
"""

import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import case_meshes
from published import HALF, RADIUS, SQUARE

RATIO = 1.2  # of the thickness of a ring of cells to that of the ring inside


def layers_at(count, ratio=RATIO):
    """Where a crack can end between rings: distances from the hole [m]."""
    return [(SQUARE - RADIUS) * (ratio**k - 1) / (ratio**count - 1) for k in range(count + 1)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=21, help="along a side of the square")
    parser.add_argument("--layers", type=int, default=8, help="between the hole and the square")
    parser.add_argument("--output", type=pathlib.Path, default=HERE / "plate.msh")
    arguments = parser.parse_args()
    if arguments.cells % 2 == 0:
        parser.error("--cells must be odd")
    step = 2 * SQUARE / arguments.cells
    inside = [SQUARE * (2 * k / arguments.cells - 1) for k in range(1, arguments.cells)]

    def lines(fine):
        right = [SQUARE + x for x in case_meshes.graded(fine, step, HALF - SQUARE, 1.5) if x >= 0]
        return [-x for x in reversed(right)] + inside + right

    mesh = case_meshes.Mesh()
    mesh.ring(RADIUS, [-SQUARE, *inside, SQUARE], arguments.layers, RATIO)
    mesh.rectangle(lines(step * round(0.015 / step)), lines(step), lambda x, y: max(abs(x), abs(y)) < SQUARE)
    mesh.write(arguments.output, RADIUS)


if __name__ == "__main__":
    main()
