"""The benchmarks of cracks: coupled against particles only, a growing crack, a whole run, run time against error."""
import statistics

from bench_machine import Bench

ASSEMBLED = ["-pd_operator", "assembled"]
REBUILT = ASSEMBLED + ["-ksp_type", "cg", "-pc_type", "hypre", "-snes_lag_preconditioner", "1"]
PAPER = ["-couple_scheme", "ghost", "-pd_calibration", "continuum", "-pd_surface_correction", "volume"]
OPENING = 1.5e-6 / 200  # of an increment of dcb [m]
INCREMENTS = 116  # cover the first 60 in which bonds break
SEQUENCE = 50  # solves after a break
REFERENCE_PEAK = 1843.7  # N/m, linear elastic fracture mechanics at the first length
REFERENCE_J = 12.8930  # double_notch [Pa m]
NOTCH_MESH = 0.1 / 33  # [m]


def scene(path):
    return ["-options_file", f"cases/{path}.opts"]


def dcb(name, increments):
    """The first increments of the 200."""
    u = repr(OPENING * increments)
    return scene(f"dcb/{name}") + ["-load_steps", str(increments), "-bc_top_displacement", f"0,{u}",
                                   "-bc_bottom_displacement", f"0,-{u}"]


def notch(spacing, extra=()):
    return scene("double_notch/coupled") + ["-pd_spacing", repr(spacing), *extra]


def notch_particles(spacing):
    return scene("double_notch/pd_only") + ["-pd_spacing", repr(spacing), "-bc_anchor_box", f"{0.1 - spacing!r},0,0.1,{spacing!r}",
                                            "-post_j_contours", "0.02"]


def median(values):
    return statistics.median(list(values))


def growing(summary):
    """Mean time of the solves in increments in which bonds broke [s], the first increment left out; and how many."""
    seconds, broken = summary["results"]["solve_seconds"]["list"], summary["results"]["solve_bonds_broken"]["list"]
    increments, begin = [], 0
    for k, changes in enumerate(broken):
        if changes == 0:  # quiet: the increment ends
            increments.append((seconds[begin:k + 1], sum(broken[begin:k + 1])))
            begin = k + 1
    chosen = [times for times, changes in increments[1:] if changes > 0]
    solves = [time for times in chosen for time in times]
    return (statistics.mean(solves) if solves else float("nan")), len(chosen)


class FractureBench(Bench):
    package = "cholmod"  # for direct solvers, on both sides

    def pairs(self, extra, increments):
        """(title, paper's speed-up, coupled runs, runs of particles only) of the three pairs of part I."""
        beams = self.rounds_of({name: dcb(name, increments) + extra for name in ("row1", "row3", "pd_only")})
        plates = self.rounds_of({"coupled": scene("double_notch/coupled") + ["-pd_spacing", repr(NOTCH_MESH / 6), *extra],
                                 "pd_only": scene("double_notch/pd_only") + extra})
        return [("dcb row 1", 16.7, beams["row1"], beams["pd_only"]), ("dcb row 3", 5.3, beams["row3"], beams["pd_only"]),
                ("double_notch", 5.0, plates["coupled"], plates["pd_only"])]

    def compare_pairs(self, kind, extra, increments, seconds, goal):
        """@param goal (paper's speed-up, ratio of unknowns) -> speed-up to reach"""
        rows = []
        for title, papers, mine, other in self.pairs(extra, increments):
            unknowns = [runs[0]["unknowns"]["total"] for runs in (mine, other)]
            ratio = unknowns[1] / unknowns[0]
            for what, measure in seconds.items():
                times = [median(measure(run) for run in runs) for runs in (mine, other)]
                if any(time != time for time in times):
                    continue  # nothing breaks here
                gain = times[1] / times[0]
                self.results[f"{kind} {title}, {what}"] = {"coupled": times[0], "particles": times[1], "speed_up": gain,
                                                           "unknowns": unknowns, "over_unknowns": gain / ratio}
                rows.append([f"{title}, {what}", f"{unknowns[1]} / {unknowns[0]}", f"{times[1]:.4f}", f"{times[0]:.4f}",
                             f"**{gain:.1f}** (goal {goal(papers, ratio):.1f})", f"{ratio:.2f}", f"{gain / ratio:.2f}", papers])
        return rows

    HEADER = ["scene", "unknowns, particles only / coupled", "particles only [s]", "coupled [s]", "speed-up", "ratio of unknowns",
              "speed-up / ratio", "the papers' speed-up"]

    def coupled(self):
        """Coupled against particles only with the default solver: cold, and in increments in which bonds break."""
        rows = self.compare_pairs("coupled", [], INCREMENTS,
                                  {"first solve": lambda run: run["results"]["solve_seconds"]["list"][0]
                                   if "solve_seconds" in run["results"] else run["wall_seconds"]["solve"],
                                   "growing, per solve": lambda run: growing(run)[0]
                                   if "solve_seconds" in run["results"] else float("nan")},
                                  lambda papers, ratio: 0.8 * ratio)
        self.table("Coupled against particles only, default solver, one core", self.HEADER, rows)

    def direct(self):
        """The same pairs with a direct solver: assembly, factorisation and solve of the first increment."""
        extra = ASSEMBLED + ["-pc_type", "cholesky", "-ksp_type", "preonly", "-pc_factor_mat_solver_type", self.package]
        rows = self.compare_pairs("direct", extra, 1, {"first solve": lambda run: run["wall_seconds"]["solve"]},
                                  lambda papers, ratio: papers)
        self.table(f"Coupled against particles only, direct solver ({self.package}), one core", self.HEADER, rows)

    def whole_run(self):
        """All increments of dcb row 3 in units of one assembled cold solve of the first."""
        runs = self.rounds_of({"assembled": dcb("row3", 1) + ASSEMBLED, "default": dcb("row3", 200)})
        cold, whole = (median(run["wall_seconds"]["solve"] for run in runs[name]) for name in ("assembled", "default"))
        one = runs["default"][0]
        self.results["run"] = {"assembled": cold, "default": whole, "ratio": whole / cold}
        self.table("The 200 increments of dcb row 3 over one assembled cold solve, one core",
                   ["solves", "linear iterations", "bonds broken", "whole run [s]", "assembled CG + BoomerAMG, first increment [s]",
                    "ratio"],
                   [[one["results"]["passes"], one["linear_iterations"], one["bonds_broken"], f"{whole:.2f}", f"{cold:.3f}",
                     f"**{whole / cold:.1f}** (goal at most 40)"]])

    def sequence(self):
        """A crack that grows by about ten bonds from solve to solve; the assembled side does the first few only."""
        plate = ["-options_file", "tests/bench/sequence.opts"]
        passes = 6
        mine, other = [], []
        for _ in range(self.rounds):
            mine.append(self.run(plate)["results"])
            other.append(self.run(plate + REBUILT + ["-load_passes", str(passes), "-load_halvings", "0"], may_fail=True))
        after = slice(1, SEQUENCE + 1)
        kept = median(statistics.mean(run["solve_seconds"]["list"][after]) for run in mine)
        rebuilt = median(statistics.mean(run["results"]["solve_seconds"]["list"][1:]) for run in other)
        builds, solves = other[0]["factorizations"], len(other[0]["results"]["solve_seconds"]["list"])
        iterations, broken = mine[0]["solve_iterations"]["list"][after], mine[0]["solve_bonds_broken"]["list"][:SEQUENCE]
        cold = other[0]["results"]["solve_iterations"]["list"][1:]
        self.results["sequence"] = {"kept": kept, "rebuilt": rebuilt, "ratio": rebuilt / kept, "iterations": max(iterations),
                                    "broken": broken, "builds": [builds, solves]}
        self.table(f"{SEQUENCE} solves of 200 x 200 particles, each after {min(broken)} to {max(broken)} bonds broke at the tip, "
                   "one core",
                   ["assembled CG + BoomerAMG rebuilt each time, per solve [s]", "default, per solve [s]", "ratio",
                    "most iterations", "bonds broken"],
                   [[f"{rebuilt:.3f} ({builds} set-ups in {solves} solves, at most {max(cold)} it.)", f"{kept:.4f}",
                     f"**{rebuilt / kept:.1f}** (goal 12)", f"**{max(iterations)}** (goal 20)", sum(broken)]])

    def notch_pareto(self):
        """Solve time of double_notch against the error of J on the contour of 0.02 m."""
        shares = (4, 6, 8, 12, 16)
        families = {"default scheme": [(NOTCH_MESH / n, notch(NOTCH_MESH / n)) for n in shares],
                    "papers' scheme": [(NOTCH_MESH / n, notch(NOTCH_MESH / n, PAPER)) for n in shares],
                    "particles only": [(dx, notch_particles(dx)) for dx in (1e-3, 5e-4, 2.5e-4)]}
        rows, curves = [], {}
        for name, scenes in families.items():
            for spacing, arguments in scenes:
                runs = self.rounds_of({"one": arguments})["one"]
                seconds = median(run["wall_seconds"]["solve"] for run in runs)
                j = runs[0]["results"]["j_integral"]
                error = abs(j / REFERENCE_J - 1) * 100
                rows.append([name, f"{spacing * 1e3:.4f}", runs[0]["unknowns"]["total"], f"{j:.4f}", f"{error:.3f}",
                             f"{seconds:.4f}"])
                curves.setdefault(name, []).append((error, seconds))
        self.results["notch_pareto"] = curves
        self.table("double_notch: run time against error of J", ["method", "dx [mm]", "unknowns", "J [Pa m]", "error [%]",
                                                                "solve [s]"], rows)
        self.picture("notch_pareto.png", "error of J [%]", curves, "solve, assembly and set-up included [s]")

    def beam_pareto(self):
        """Run time of dcb against the distance of its peak force from linear fracture mechanics; one run each, whatever
        the rounds. Finer spacings at one horizon ratio m stay where they are; m is what brings the peak down."""
        fine, finer = 0.15e-3 / 42, 2.5e-6
        families = {"default scheme, m = 4, finer dx": [("row3", dx, 4) for dx in (5e-6, fine, finer)],
                    "default scheme, larger m": [("row3", finer, m) for m in (3, 4, 5, 6)],
                    "papers' scheme, m = 4": [("paper_row3", 5e-6, 4)],
                    "particles only, m = 4, finer dx": [("pd_only", dx, 4) for dx in (5e-6, fine)]}
        rows, curves = [], {}
        for name, scenes in families.items():
            for row, spacing, ratio in scenes:
                run = self.run(scene(f"dcb/{row}") + ["-pd_spacing", repr(spacing), "-pd_horizon_ratio", str(ratio)])
                results, seconds = run["results"], run["wall_seconds"]["solve"]
                peak = results["peak_reaction_per_thickness"]["top"][1]
                error = abs(peak / REFERENCE_PEAK - 1) * 100
                rows.append([name, f"{spacing * 1e6:.2f}", ratio, run["unknowns"]["total"], f"{peak:.1f}", f"{error:.1f}",
                             f"{results['crack_length'] * 1e3:.4f}", results["passes"], f"{seconds:.2f}"])
                curves.setdefault(name, []).append((error, seconds))
        self.results["beam_pareto"] = curves
        self.table("dcb, patch of row 3: peak force and final crack length against run time of 200 increments",
                   ["method", "dx [um]", "m", "unknowns", "peak [N/m]", "above LEFM [%]", "final crack length [mm]", "solves",
                    "solve [s]"], rows)
        self.picture("beam_pareto.png", "peak force above linear fracture mechanics [%]", curves, "200 increments [s]")
