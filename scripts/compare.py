#!/usr/bin/env python3
"""Compares the displacements of two runs point by point, by the numbers that do not depend on the ranks.

usage: compare.py A B [--tolerance 1e-9]      A, B: output directories or fields.h5 files
The measure of a block is max |u_A - u_B| / max |u_A| over its points in the last step. Exit status: 0 if no block
passes the tolerance, 1 if one does, 2 if the two cannot be compared.
"""
import argparse
import sys

import pdxtools
import numpy as np


def difference(name, a, b):
    """Largest difference of displacement over the largest displacement; exits if the points are not the same."""
    order_a, order_b = np.argsort(a.natural_point), np.argsort(b.natural_point)
    numbers = a.natural_point[order_a]
    if not np.array_equal(numbers, b.natural_point[order_b]):
        refuse(f"block '{name}' has {len(a.points)} and {len(b.points)} points with other natural numbers")
    if np.any(np.diff(numbers) == 0):
        refuse(f"block '{name}' uses a natural number twice")
    if "displacement" not in a or "displacement" not in b:
        return None
    gap = np.linalg.norm(a["displacement"][order_a] - b["displacement"][order_b], axis=1)
    largest = np.linalg.norm(a["displacement"], axis=1).max()
    if not np.all(np.isfinite(gap)):
        return float("inf")
    return gap.max() / largest if largest > 0.0 else (0.0 if gap.max() == 0.0 else float("inf"))


def refuse(reason):
    print(f"compare.py: {reason}", file=sys.stderr)
    sys.exit(2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("a")
    parser.add_argument("b")
    parser.add_argument("--tolerance", type=float, default=1e-9, help="largest difference that passes [-]")
    options = parser.parse_args()
    try:
        steps = pdxtools.step_count(options.a), pdxtools.step_count(options.b)
        if steps[0] != steps[1]:
            refuse(f"{steps[0]} and {steps[1]} steps")
        blocks_a, blocks_b = pdxtools.read_step(options.a)[1], pdxtools.read_step(options.b)[1]
    except (OSError, IndexError, KeyError) as error:
        refuse(f"cannot read the runs: {error}")
    if blocks_a.keys() != blocks_b.keys():
        refuse(f"blocks {sorted(blocks_a)} and {sorted(blocks_b)}")

    worst, compared = 0.0, 0
    for name, block in blocks_a.items():
        value = difference(name, block, blocks_b[name])
        if value is None:
            continue
        compared += 1
        worst = max(worst, value)
        print(f"{name:<12} {len(block.points):>9} points   max difference {value:.3e}")
    if not compared:
        refuse("no block with a displacement")
    return 0 if worst <= options.tolerance else 1


if __name__ == "__main__":
    sys.exit(main())
