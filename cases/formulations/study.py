#!/usr/bin/env python3
"""Runs the formulations of material points side by side and prints the table of the README; draws run time against error.

usage: study.py [--executable build/release/pdxsolve] [--out out/formulations] [--only pulse,flight,ringing,impact,disc]
The environment lets Open MPI run (`. scripts/mpi_env.sh`). Steps are as long for all (formulations.SAFETY), but those of
the picture: half of each one's own limit.
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_study
import pdxtools
import formulations
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

SPACINGS = (2e-3, 1e-3, 0.5e-3, 0.25e-3)  # [m] of the picture
ROUNDS = 3  # the quickest counts: other processes only make runs longer
READ = {"pulse": (formulations.pulse,), "flight": (formulations.energy,), "ringing": (formulations.energy,),
        "impact": (formulations.impact,), "disc": (formulations.energy, formulations.turned)}
COLOURS, MARKERS = ("#4477aa", "#ee6677", "#ccbb44", "#228833"), "os^D"


def run(arguments, scene, variant, name, more=()):
    options = [*formulations.VARIANTS[variant], *more]
    if not case_study.run(arguments.executable, "formulations", name, (scene, options), arguments.out, timeout=900):
        sys.exit(1)
    return arguments.out / name


def table(arguments):
    lines = []
    for k, variant in enumerate(formulations.VARIANTS):
        line = [variant]
        for scene in arguments.only:
            found = run(arguments, scene, variant, f"{scene}_{k}", ["-ts_safety", str(formulations.SAFETY[scene]), "-output_history_interval", "50"])
            line.append(", ".join(f"{read(found):.3g}" for read in READ[scene]))
        lines.append(line)
    case_study.print_table(["", *arguments.only], lines)


def picture(arguments):
    """Seconds of all steps of the pulse against its error, as points get nearer to each other."""
    figure, axes = plt.subplots(figsize=(4.6, 3.4))
    lines = []
    for k, variant in enumerate(formulations.VARIANTS):
        errors, seconds = [], []
        for spacing in SPACINGS:
            name = f"pareto_{k}_{spacing:g}"
            rounds = []
            for _ in range(ROUNDS):
                found = run(arguments, "pulse", variant, name, ["-mpm_spacing", repr(spacing), "-ts_safety", "0.5"])
                rounds.append(pdxtools.read_summary(found)["wall_seconds"]["solve"])
            errors.append(formulations.pulse(found))
            seconds.append(min(rounds))
            lines.append([variant, f"{1e3 * spacing:g}", f"{errors[-1]:.4f}", f"{seconds[-1]:.3f}"])
        axes.loglog(errors, seconds, marker=MARKERS[k], markersize=4, linewidth=1, color=COLOURS[k], label=variant)
    axes.set(xlabel="error of the pulse, vector norm over its size", ylabel="all steps, one core [s]")
    axes.grid(True, which="major", linewidth=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(arguments.out / "pareto.png", dpi=200, bbox_inches="tight")
    case_study.print_table(["", "spacing [mm]", "error", "steps [s]"], lines)


def main():
    arguments = case_study.Parser(__doc__, "formulations", READ).read()
    arguments.out.mkdir(parents=True, exist_ok=True)
    table(arguments)
    if "pulse" in arguments.only:
        picture(arguments)


if __name__ == "__main__":
    main()
