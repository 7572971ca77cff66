#!/usr/bin/env python3
"""Runs the pulse in full, one variant after the other, and prints the table: reflection, distance from elements alone
and from the exact pulse, energy of the patch, drift.

usage: study.py [--executable build/release/pdxsolve] [--out out/pulse] [--ranks 1] [--only rollers_case,...]
Each run leaves its directory in the output directory, for pictures.py; with --only none the table of what is there.
"""

import sys

import waves  # scripts/ are on the path from here on
import case_study

ROLLERS = ["-options_file", "cases/pulse/rollers.opts"]
# The plane pulse with the whole way from the source to the patch.
WAY = ["-mesh_upper", "0.5,0.1", "-mesh_cells", "150,50", "-ts_max_time", "5.61e-5"]
# name: options file and what is said after it
VARIANTS = {
    "fe_only": ("fe_only", []),
    "case": ("case", []),
    "paper": ("paper", []),
    "rollers_fe_only": ("fe_only", ROLLERS),
    "rollers_case": ("case", ROLLERS),
    "rollers_paper": ("paper", ROLLERS),
    "rollers_rest": ("case", [*ROLLERS, "-pd_skip_tolerance", "1e-14"]),
    "plane_fe_only": ("plane_fe_only", WAY),
    "plane_case": ("plane_case", WAY),
    "plane_paper": ("plane_paper", WAY),
}
# which run of elements alone a run is compared with
ALONE = {
    "case": "fe_only",
    "paper": "fe_only",
    "rollers_case": "rollers_fe_only",
    "rollers_paper": "rollers_fe_only",
    "rollers_rest": "rollers_fe_only",
    "plane_case": "plane_fe_only",
    "plane_paper": "plane_fe_only",
}
COLUMNS = [
    "run",
    "reflection, 56 µs [%]",
    "left behind, 79 µs [%]",
    "to elements alone, 56 µs [%]",
    "79 µs [%]",
    "to the exact pulse, 56 µs [%]",
    "79 µs [%]",
    "E_PD/E, most",
    "82 µs",
    "100 µs",
    "drift",
    "tiles skipped [%]",
    "time [s]",
]


def percent(value):
    return f"{100 * value:.3f}"


def line(out, name):
    """Cells of the table, or None if there is no such run."""
    here, alone = out / name, ALONE.get(name)
    reference = alone and out / alone
    summary = waves.pdxtools.read_summary(here)
    if not summary:
        return None
    results = summary["results"]
    t2, t3 = waves.TIMES[1:]
    short = name.startswith("plane")
    skipped, computed = (results.get(f"pd_tiles_{what}", 0) for what in ("skipped", "computed"))
    return [
        name,
        percent(waves.reflection(here, reference, t2)) if alone else "",
        "" if short or not alone else percent(waves.left_behind(here, t3) - waves.left_behind(reference, t3)),
        percent(waves.difference(here, reference, t2)) if alone else "",
        "" if short or not alone else percent(waves.difference(here, reference, t3)),
        percent(waves.difference(here, None, t2)),
        "" if short else percent(waves.difference(here, None, t3)),
        "" if not alone else f"{waves.pd_energy(here)[1].max():.4f}",
        "" if short or not alone else f"{waves.residual(here, waves.LATE):.2e}",
        "" if short or not alone else f"{waves.residual(here, 1e-4):.2e}",
        f"{results['energy_drift_ratio']:.1e}",
        f"{100 * skipped / (skipped + computed):.0f}" if skipped + computed else "",
        f"{summary['wall_seconds']['total']:.0f}",
    ]


if __name__ == "__main__":
    sys.exit(case_study.main(__doc__, "pulse", VARIANTS, COLUMNS, line, ranks=True))
