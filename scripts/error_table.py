#!/usr/bin/env python3
"""Prints the errors and costs of runs, from their summary.json, beside the errors a paper quotes."""

import argparse
import sys

import pdxtools

COLUMNS = ("run", "ranks", "unknowns", "max error %", "mean error %", "paper max %", "iterations", "solve s")


def row(run):
    """One table row of `name:paper's maximum error in %:output directory`."""
    name, paper, directory = run.split(":", 2)
    summary = pdxtools.read_summary(directory)
    if not summary:
        raise OSError(f"{directory} has no summary.json")
    results = summary["results"]
    return (
        name,
        str(summary["ranks"]),
        str(summary["unknowns"]["total"]),
        f"{results['max_relative_error_percent']:.4g}",
        f"{results['mean_relative_error_percent']:.4g}",
        paper,
        str(summary["linear_iterations"]),
        f"{summary['wall_seconds']['solve']:.2f}",
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="+", metavar="NAME:PAPER_PERCENT:OUT_DIR")
    arguments = parser.parse_args()
    try:
        table = [COLUMNS] + [row(run) for run in arguments.runs]
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"error_table: {type(error).__name__}: {error}")
    widths = [max(len(line[i]) for line in table) for i in range(len(COLUMNS))]
    for line in table:
        print("  ".join(cell.rjust(width) for cell, width in zip(line, widths)))


if __name__ == "__main__":
    main()
