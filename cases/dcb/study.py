#!/usr/bin/env python3
"""Runs the ten rows of Table 3 with the default and with the papers' scheme, m = 6, and particles only, one after the
other on one rank, and prints the table. Run times are compared within one invocation only.

usage: study.py [--executable build/release/pdxsolve] [--out out/dcb] [--only row3,paper_row3,pd_only] [--csv FILE]
Each run leaves its directory in the output directory, for pictures.py; the table's numbers go into results.csv beside
this file, where runs that are not repeated keep their lines.
"""

import csv
import datetime
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "scripts"))

import case_study
import pdxtools

ROWS = range(1, 11)
# The paper's Table 3: peak force per thickness [N/m], final crack [mm], speed-up over particles only.
PAPER = {
    "row1": (2099, 0.6512, 16.71),
    "row2": (2092, 0.6512, 8.34),
    "row3": (2086, 0.6487, 5.31),
    "row4": (2081, 0.6487, 3.85),
    "row5": (2079, 0.6487, 2.71),
    "row6": (2076, 0.6487, 2.13),
    "row7": (2076, 0.6487, 1.75),
    "row8": (2116, 0.6461, 12.70),
    "row9": (2072, 0.6487, 12.00),
    "row10": (2059, 0.6487, 4.57),
    "pd_only": (2050, 0.6437, 1.0),
}
# name: options file and what is said after it
VARIANTS = {f"row{k}": (f"row{k}", []) for k in ROWS}
VARIANTS |= {f"paper_row{k}": (f"paper_row{k}", []) for k in ROWS}
VARIANTS |= {"m6": ("row3", ["-pd_horizon_ratio", "6"]), "pd_only": ("pd_only", [])}
COLUMNS = [
    "case",
    "invocation",
    "unknowns",
    "peak_N_per_m",
    "peak_N",
    "peak_at_um",
    "first_intact_mm",
    "farthest_broken_mm",
    "bonds_broken",
    "passes",
    "newton_iterations",
    "linear_iterations",
    "factorizations",
    "fracture_energy_nJ",
    "energy_set_free_nJ",
    "solve_s",
    "total_s",
]


def run(arguments, name):
    """Runs a variant on one rank; its summary, or None if it did not end well."""
    file, options = VARIANTS[name]
    variant = file, [*options, "-output_fields", "-output_interval", "20"]
    done = case_study.run(arguments.executable, "dcb", name, variant, arguments.out, timeout=arguments.timeout)
    return pdxtools.read_summary(arguments.out / name) if done else None


def numbers(name, invocation, summary):
    """A line of results.csv."""
    results = summary["results"]
    tip, start = results["tips"][0], results["tips"][0]["start"][0]
    values = [
        name,
        invocation,
        summary["unknowns"]["total"],
        f"{results['peak_reaction_per_thickness']['top'][1]:.1f}",
        f"{results['peak_reaction']['top'][1]:.4f}",
        f"{1.5 * results['peak_reaction_load']['top'][1]:.4f}",
        f"{1e3 * (start + tip.get('first_intact', float('nan'))):.4f}",
        f"{1e3 * (start + tip['farthest_broken']):.4f}",
        summary["bonds_broken"],
        results["passes"],
        summary["newton_iterations"],
        summary["linear_iterations"],
        summary["factorizations"],
        f"{1e9 * results['fracture_energy']:.2f}",
        f"{1e9 * (results['external_work'] - results['strain_energy'] - results['fracture_energy']):.2f}",
        f"{summary['wall_seconds']['solve']:.2f}",
        f"{summary['wall_seconds']['total']:.2f}",
    ]
    return dict(zip(COLUMNS, map(str, values)))


def read(path):
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as file:
        return {line["case"]: line for line in csv.DictReader(file)}


def write(path, lines):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(lines[name] for name in VARIANTS if name in lines)


def table(lines):
    """The lines beside the paper's, with ratios to particles only of the same invocation."""
    print("| run | unknowns | P [N/m] | paper | at v [um] | a_f [mm] | paper | time [s] | speed-up | paper | unknowns |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    full = lines.get("pd_only")
    for name in VARIANTS:
        if name not in lines:
            continue
        line = lines[name]
        force, crack, speed = PAPER.get(name.removeprefix("paper_"), ("", "", ""))
        ratio = unknowns = ""
        if full:
            unknowns = f"{int(full['unknowns']) / int(line['unknowns']):.2f}"
            if full["invocation"] == line["invocation"]:
                ratio = f"{float(full['total_s']) / float(line['total_s']):.2f}"
        span = f"{line['first_intact_mm']} .. {line['farthest_broken_mm']}"
        cells = [name, line["unknowns"], line["peak_N_per_m"], force, line["peak_at_um"], span, crack]
        print("|", " | ".join(map(str, [*cells, line["total_s"], ratio, speed, unknowns])), "|")


def main():
    parser = case_study.Parser(__doc__, "dcb", VARIANTS)
    parser.add_argument("--csv", type=pathlib.Path, default=HERE / "results.csv")
    parser.add_argument("--timeout", type=float, default=7200.0, help="of one run [s]")
    arguments = parser.read()

    invocation = datetime.datetime.now().isoformat(timespec="seconds")
    lines = read(arguments.csv)
    for name in arguments.only:
        summary = run(arguments, name)
        if summary:
            lines[name] = numbers(name, invocation, summary)
            write(arguments.csv, lines)
    table(lines)
    return 0 if all(name in lines for name in arguments.only) else 1


if __name__ == "__main__":
    sys.exit(main())
