#!/usr/bin/env python3
"""Measures the static solver: speed as ratios within one run, and run time against error.

usage: bench.py [--executable build/release/pdxsolve] [--rounds 5] [--out out/bench] [--only speed,size,ranks,pareto]
The two sides of a ratio run in turn, round after round; the quoted numbers are medians. One-rank runs are pinned to a
core. Writes bench.json, table.md, pareto.png and size.png into the output directory.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import fields
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

ROOT = pathlib.Path(__file__).resolve().parent.parent
LENGTH = 5e-3  # side of the plate [m]
PLATE = ["-mesh_lower", "0,0", "-mesh_upper", f"{LENGTH},{LENGTH}", "-material_young", "1e9", "-material_poisson",
         "0.33333333333333333", "-material_thickness", "1e-3", "-bc_names", "clamp,load", "-bc_clamp_on", "left",
         "-bc_clamp_displacement", "0,0", "-bc_load_on", "right", "-bc_load_traction", "1e6,1e6", "-pd_horizon_ratio", "4"]
PAPER = ["-couple_scheme", "ghost", "-pd_calibration", "continuum", "-pd_surface_correction", "volume"]
ASSEMBLED = ["-pd_operator", "assembled", "-ksp_type", "cg", "-pc_type", "hypre"]


def elements(cells):
    return PLATE + ["-mesh_cells", f"{cells},{cells}"]


def coupled(cells, ratio):
    """The plate of part I: a patch over the middle 2/5, ratio particles per element side."""
    return elements(cells) + ["-pd_patches", "1.5e-3,1.5e-3,3.5e-3,3.5e-3", "-pd_spacing", repr(LENGTH / cells / ratio)]


def particles(count, cells=None):
    """Particles only, clamped by a layer of one horizon."""
    scene = PLATE + ["-pd_patches", "all", "-pd_spacing", repr(LENGTH / count), "-bc_clamp_layer"]
    return scene + (["-mesh_cells", f"{cells[0]},{cells[1]}"] if cells else [])


class Bench:
    def __init__(self, executable, rounds, out):
        self.executable, self.rounds, self.out = pathlib.Path(executable).resolve(), rounds, out
        self.results, self.lines = {}, []

    def run(self, arguments, ranks=1, keep=None):
        """Runs a scene; returns its summary. `keep`: directory for its fields."""
        with tempfile.TemporaryDirectory() as scratch:
            directory = keep or scratch
            command = [str(self.executable), *arguments, "-quiet", "-output_dir", str(directory)]
            if ranks > 1:
                command = ["mpirun", "-q", "-n", str(ranks), *command]
            elif hasattr(os, "sched_setaffinity"):
                command = ["taskset", "-c", str(max(os.sched_getaffinity(0))), *command]
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
            if done.returncode:
                sys.exit(f"{' '.join(command)}\nfailed: {done.stderr}")
            return fields.read_summary(directory)

    def interleave(self, sides):
        """Runs every side once per round; medians of solve, total [s], iterations and memory [MB] by side."""
        samples = {name: [] for name in sides}
        for _ in range(self.rounds):
            for name, (arguments, ranks) in sides.items():
                samples[name].append(self.run(arguments, ranks))
        median = statistics.median
        return {name: {"solve": median(s["wall_seconds"]["solve"] for s in runs),
                       "total": median(s["wall_seconds"]["total"] for s in runs),
                       "iterations": runs[0]["linear_iterations"], "unknowns": runs[0]["unknowns"]["total"],
                       "memory": median(s["peak_memory_mb"] - s["memory_mb"]["before_solve"] for s in runs)}
                for name, runs in samples.items()}

    def table(self, title, header, rows):
        self.lines += [f"### {title}", "", "| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
        self.lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows] + [""]
        print("\n".join(self.lines[-len(rows) - 5:]), flush=True)

    def speed(self):
        """Default solver against the assembled matrix under CG and BoomerAMG, assembly and set-up included."""
        scenes = {"coarse plate, h = 2 dx": (coupled(100, 2), 3.0, None), "fine plate, h = 5 dx": (coupled(100, 5), 9.0, None),
                  "particles only, 200 x 200": (particles(200), 12.0, 0.125)}
        rows = []
        for name, (scene, goal, memory_goal) in scenes.items():
            both = self.interleave({"default": (scene, 1), "assembled": (scene + ASSEMBLED, 1)})
            mine, other = both["default"], both["assembled"]
            ratio, memory = other["solve"] / mine["solve"], mine["memory"] / other["memory"]
            self.results[f"speed {name}"] = {**both, "ratio": ratio, "memory_ratio": memory,
                                             "whole_over_solve": mine["total"] / mine["solve"]}
            rows.append([name, mine["unknowns"], f"{other['solve']:.3f} ({other['iterations']} it.)",
                         f"{mine['solve']:.3f} ({mine['iterations']} it.)", f"**{ratio:.1f}** (goal {goal:g})",
                         f"{memory:.3f}" + (f" (goal {memory_goal})" if memory_goal else ""),
                         f"{mine['total'] / mine['solve']:.2f} (goal 2.5)"])
        self.table("Default solver against assembled CG + BoomerAMG, one core, rtol 1e-10",
                   ["scene", "unknowns", "assembled [s]", "default [s]", "ratio", "memory ratio", "whole run / solve"], rows)

    def size(self):
        """Iterations and time as the problem grows."""
        rows, curves = [], {}
        for name, make, values in (("coupled, h = 5 dx", lambda n: coupled(n, 5), (30, 50, 100, 200)),
                                   ("particles only", particles, (50, 100, 200, 400, 700))):
            for n in values:
                runs = self.interleave({"one": (make(n), 1), "two": (make(n), 2)})
                rows.append([name, runs["one"]["unknowns"], runs["one"]["iterations"], runs["two"]["iterations"],
                             f"{runs['one']['solve']:.4f}", f"{1e9 * runs['one']['solve'] / runs['one']['unknowns']:.0f}"])
                curves.setdefault(name, []).append((runs["one"]["unknowns"], runs["one"]["solve"]))
        self.results["size"] = curves
        self.table("Growth with size", ["scene", "unknowns", "iterations, 1 rank", "2 ranks", "solve [s]", "ns / unknown"], rows)
        self.picture("size.png", "unknowns", curves, "solve, assembly and set-up included [s]")

    def ranks(self):
        rows = []
        for name, scene in (("fine plate", coupled(100, 5)), ("four times larger", coupled(200, 5)),
                            ("particles only, 400 x 400", particles(400))):
            both = self.interleave({"one": (scene, 1), "two": (scene, 2)})
            ratio = both["one"]["solve"] / both["two"]["solve"]
            self.results[f"ranks {name}"] = {**both, "ratio": ratio}
            rows.append([name, both["one"]["unknowns"], f"{both['one']['solve']:.3f}", f"{both['two']['solve']:.3f}",
                         f"**{ratio:.2f}** (goal 1.6)"])
        self.table("Two ranks over one", ["scene", "unknowns", "1 rank [s]", "2 ranks [s]", "ratio"], rows)

    def pareto(self):
        """Solve time against the error to a fine elements-only solution, at points every 0.5 mm."""
        families = {"elements only": [elements(n) for n in (20, 40, 50, 100, 200)],
                    "particles only": [particles(50, (54, 50)), particles(100, (52, 50)), particles(200, (51, 50)),
                                       particles(400, (101, 100))],
                    "papers' scheme": [c + PAPER for c in self.coupled_range()], "default scheme": self.coupled_range()}
        truth = self.probe(elements(800))
        rows, curves = [], {}
        for name, scenes in families.items():
            for scene in scenes:
                error = np.linalg.norm(self.probe(scene) - truth) / np.linalg.norm(truth) * 100
                one = self.interleave({"one": (scene, 1)})["one"]
                rows.append([name, one["unknowns"], f"{error:.4f}", f"{one['solve']:.4f}", one["iterations"]])
                curves.setdefault(name, []).append((error, one["solve"]))
        self.results["pareto"] = curves
        self.table("Run time against error", ["method", "unknowns", "error [%]", "solve [s]", "iterations"], rows)
        self.picture("pareto.png", "error to a fine solution, vector norm [%]", curves, "solve, assembly and set-up included [s]")

    @staticmethod
    def coupled_range():
        return [coupled(50, 2), coupled(50, 4), coupled(100, 2), coupled(100, 5), coupled(200, 2), coupled(200, 4)]

    def probe(self, scene):
        """Displacement on the grid of 0.5 mm in the body, the clamped edge left out."""
        with tempfile.TemporaryDirectory() as directory:
            self.run(scene + ["-output_fields"], keep=directory)
            mesh = fields.read_step(directory)[1]["mesh"]
        place = np.rint(mesh.points[:, :2] / 5e-4)
        on = (np.abs(mesh.points[:, :2] - 5e-4 * place) < 1e-9).all(axis=1) & (place[:, 0] >= 1)
        order = np.lexsort((place[on, 0], place[on, 1]))
        return mesh["displacement"][on][order, :2]

    def picture(self, name, x_label, curves, y_label):
        plt.rcParams.update({"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10})
        figure, axes = plt.subplots(figsize=(4.6, 3.4))
        for (label, points), colour, marker in zip(curves.items(), ["#4477aa", "#ee6677", "#ccbb44", "#228833"], "os^D"):
            x, y = zip(*sorted(points))
            one_way = all(b > a for a, b in zip(y, y[1:])) or all(b < a for a, b in zip(y, y[1:]))
            axes.loglog(x, y, marker=marker, markersize=4, linewidth=1 if one_way else 0, color=colour, label=label)
        axes.set(xlabel=x_label, ylabel=y_label)
        axes.grid(True, which="major", linewidth=0.3)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=9)
        figure.savefig(self.out / name, dpi=200, bbox_inches="tight")
        plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=ROOT / "build/release/pdxsolve")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/bench")
    parser.add_argument("--only", default="speed,size,ranks,pareto")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    bench = Bench(arguments.executable, arguments.rounds, arguments.out)
    for part in arguments.only.split(","):
        getattr(bench, part)()
        (arguments.out / "table.md").write_text("\n".join(bench.lines) + "\n")
        (arguments.out / "bench.json").write_text(json.dumps(bench.results, indent=1))


if __name__ == "__main__":
    main()
