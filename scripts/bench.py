#!/usr/bin/env python3
"""Measures the solvers: speed as ratios within one run, and run time against error.

usage: bench.py [--executable build/release/pdxsolve] [--rounds 5] [--out out/bench] [--only PART,PART]
Parts without cracks: speed, size, ranks, pareto. With cracks: coupled and direct (coupled against particles only, default
and direct solver), statics (elements eliminated or kept, relocation, ranks), run (dcb row 3), sequence (a crack that grows from solve to solve), notch_pareto,
beam_pareto. In time: kernels (of bonds), elements (their kernels), carried (bonds to elements against those between
particles), layout (a change of it), program (whole runs, one and two ranks), pulse_pareto, scaling (on 1, 2, 4 ... ranks up
to --ranks; PDX_LAUNCH says what starts them, see scaling.py), points (material points: kernels and program), peers (a plate in
LAMMPS, where it is installed).
The two sides of a ratio run in turn, round after round; the quoted numbers are medians. One-rank runs are pinned to a
core. Writes bench.json, table.md and pictures into the output directory.
"""
import argparse
import json
import pathlib
import tempfile

import pdxtools
import numpy as np
from bench_fracture import FractureBench
from bench_machine import ROOT
from bench_motion import MotionBench
from bench_peers import PeerBench
from bench_points import PointBench
from bench_statics import StaticBench
from scaling import cores

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


class AllBench(FractureBench, StaticBench, MotionBench, PointBench, PeerBench):
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
            mesh = pdxtools.read_step(directory)[1]["mesh"]
        place = np.rint(mesh.points[:, :2] / 5e-4)
        on = (np.abs(mesh.points[:, :2] - 5e-4 * place) < 1e-9).all(axis=1) & (place[:, 0] >= 1)
        order = np.lexsort((place[on, 0], place[on, 1]))
        return mesh["displacement"][on][order, :2]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=ROOT / "build/release/pdxsolve")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/bench")
    parser.add_argument("--only", default="speed,size,ranks,pareto,coupled,direct,statics,run,sequence,notch_pareto,beam_pareto,"
                        "kernels,elements,carried,layout,program,pulse_pareto,scaling,points,peers")
    parser.add_argument("--increments", type=int, default=StaticBench.increments, help="statics: of dcb while it grows (%(default)s)")
    parser.add_argument("--package", default="cholmod", help="direct: -pc_factor_mat_solver_type of both sides")
    parser.add_argument("--ranks", type=int, default=cores(), help="scaling: the most (%(default)s)")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    bench = AllBench(arguments.executable, arguments.rounds, arguments.out)
    bench.increments = arguments.increments
    bench.package, bench.most_ranks = arguments.package, arguments.ranks
    for part in arguments.only.split(","):
        getattr(bench, {"run": "whole_run"}.get(part, part))()
        (arguments.out / "table.md").write_text("\n".join(bench.lines) + "\n")
        (arguments.out / "bench.json").write_text(json.dumps(bench.results, indent=1))


if __name__ == "__main__":
    main()
