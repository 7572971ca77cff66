"""What every study.py of a running crack does: runs variants on one rank, prints a table of what the cracks did."""

import argparse
import pathlib
import subprocess
import sys

import fields

ROOT = pathlib.Path(__file__).resolve().parents[1]
COLUMNS = ("run", "unknowns", "steps", "start [us]", "branches [us]", "at [mm]", "max speed [m/s]", "of c_R",
           "angle [deg]", "grown tips [mm]", "residual", "time [s]")  # fmt: skip


def line(name, summary):
    """A line of the table from a summary.json."""
    r = summary["results"]

    def of(key, factor=1.0, digits=2):
        return f"{factor * r[key]:.{digits}f}" if key in r else "-"

    branch = ", ".join(f"{1e3 * x:.2f}" for x in r["branch_point"]) if "branch_point" in r else "-"
    grown = ", ".join(f"{1e3 * tip['grown']:.2f}" for tip in r["tips"])
    return [name, summary["unknowns"]["total"], summary["steps"], of("crack_start_time", 1e6), of("branch_time", 1e6),
            branch, of("max_crack_speed", 1.0, 0), of("max_crack_speed_ratio", 1.0, 3), of("crack_angle_degrees", 1.0, 1),
            grown, f"{r['energy_drift_ratio']:.1e}", f"{summary['wall_seconds']['total']:.1f}"]  # fmt: skip


def main(description, case, variants):
    """Variants are options files and what is said after them, by name. Returns the exit status."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=str(ROOT / "build/release/pdxsolve"))
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / case)
    parser.add_argument("--only", default=",".join(variants), help="runs, separated by commas; none: only the table")
    arguments = parser.parse_args()
    names = [name for name in arguments.only.split(",") if name and name != "none"]
    unknown = [name for name in names if name not in variants]
    if unknown:
        parser.error(f"no run {unknown[0]}: choose from {', '.join(variants)}")
    failed = 0
    for name in names:
        file, options = variants[name]
        command = [str(pathlib.Path(arguments.executable).resolve()), "-options_file", f"cases/{case}/{file}.opts", *options]
        command += ["-case", f"{case}_{name}", "-output_dir", str(arguments.out.resolve() / name), "-quiet"]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        print(f"{name}: status {done.returncode} {done.stderr.strip()}", file=sys.stderr, flush=True)
        failed += done.returncode != 0
    print("|", " | ".join(COLUMNS), "|")
    print("|", "|".join("---" for _ in COLUMNS), "|", sep="")
    for name in variants:
        summary = fields.read_summary(arguments.out / name)
        if summary.get("status") == "done":
            print("|", " | ".join(map(str, line(name, summary))), "|")
    return 1 if failed else 0
