#!/usr/bin/env python3
"""Runs the pulse in full, one variant after the other, and prints the table: reflection, distance from elements alone
and from the exact pulse, energy of the patch, drift.

usage: study.py [--executable build/release/pdxsolve] [--out out/pulse] [--ranks 1] [--only rollers_case,...]
Each run leaves its directory in the output directory, for pictures.py; with --only none the table of what is there.
"""

import argparse
import pathlib
import subprocess
import sys
import time

import waves

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROLLERS = ["-options_file", "cases/pulse/rollers.opts"]
# The plane pulse with the whole way from the source to the patch.
WAY = ["-mesh_upper", "0.5,0.1", "-mesh_cells", "150,50", "-ts_max_time", "5.61e-5"]
# name: options file, what is said after it, the run of elements alone that it is compared with
VARIANTS = {
    "fe_only": ("fe_only", [], None),
    "case": ("case", [], "fe_only"),
    "paper": ("paper", [], "fe_only"),
    "rollers_fe_only": ("fe_only", ROLLERS, None),
    "rollers_case": ("case", ROLLERS, "rollers_fe_only"),
    "rollers_paper": ("paper", ROLLERS, "rollers_fe_only"),
    "rollers_rest": ("case", [*ROLLERS, "-pd_skip_tolerance", "1e-14"], "rollers_fe_only"),
    "plane_fe_only": ("plane_fe_only", WAY, None),
    "plane_case": ("plane_case", WAY, "plane_fe_only"),
    "plane_paper": ("plane_paper", WAY, "plane_fe_only"),
}
HEAD = [
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


def run(executable, ranks, name, directory):
    """True if the run ended well."""
    file, options, _ = VARIANTS[name]
    command = [*(["mpirun", "-q", "-n", str(ranks)] if ranks > 1 else []), executable]
    command += ["-options_file", f"cases/pulse/{file}.opts", *options, "-output_dir", str(directory), "-quiet"]
    begin = time.monotonic()
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    print(f"{name}: status {done.returncode} in {time.monotonic() - begin:.1f} s {done.stderr.strip()}", flush=True)
    return done.returncode == 0


def percent(value):
    return f"{100 * value:.3f}"


def line(out, name):
    """Cells of the table."""
    alone = VARIANTS[name][2]
    here, reference = out / name, alone and out / alone
    summary = waves.fields.read_summary(here)
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


def table(out):
    print("|", " | ".join(HEAD), "|")
    print("|---" * len(HEAD) + "|")
    for name in VARIANTS:
        if (out / name / "summary.json").exists():
            print("|", " | ".join(line(out, name)), "|")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=str(ROOT / "build/release/pdxsolve"))
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/pulse")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--only", default=",".join(VARIANTS), help="runs, separated by commas; none: only the table")
    arguments = parser.parse_args()
    names = [name for name in arguments.only.split(",") if name and name != "none"]
    unknown = [name for name in names if name not in VARIANTS]
    if unknown:
        parser.error(f"no run {unknown[0]}: choose from {', '.join(VARIANTS)}")
    executable, out = str(pathlib.Path(arguments.executable).resolve()), arguments.out.resolve()
    done = [run(executable, arguments.ranks, name, out / name) for name in names]
    table(out)
    return 0 if all(done) else 1


if __name__ == "__main__":
    sys.exit(main())
