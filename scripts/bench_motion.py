"""The benchmarks of explicit dynamics: kernels of bonds and elements, the whole program, run time against error, ranks."""
import os
import statistics
import sys
import tempfile

import numpy as np
import scaling
from bench_machine import COLOURS, MARKERS, ROOT, Bench, plt

sys.path.insert(0, str(ROOT / "cases/pulse"))
import waves  # noqa: E402  (its directory had to be said first)

CRITICAL = ("strips", "list", "list_gathered", "strips_avx2", "strips_avx512", "strips_portable", "whole_step")
SIZES = {"plate320_48": "320 x 320, 48 neighbours", "plate320_28": "320 x 320, 28 neighbours",
         "plate88_48": "88 x 88, 48 neighbours", "cube47_122": "47 x 47 x 47, 122 neighbours"}
PLATE = {"count": (800, 320), "reach": 4.5}  # of cases/branching: sites, and horizon of its bonds in spacings
STEPS = 300
ROLLERS = ["-options_file", "cases/pulse/rollers.opts"]
PULSE_RATIO = 5  # particles along the side of an element
PULSE_MESHES = (2, 3, 4, 6, 8)  # elements in 10 mm
BEHIND = waves.TIMES[2]  # the pulse has gone through the patch [s]
# Steps that take some seconds on one rank.
SCALING = {
    "branching, 256,000 particles": ["-options_file", "cases/branching/full.opts", "-ts_max_steps", "300"],
    "pulse, 125,000 particles, 31,250 elements":
        ["-options_file", "cases/pulse/case.opts", *ROLLERS, "-ts_max_steps", "400", "-output_fields", "false"],
}

# Patches among elements: a box, and what grows by conversion.
CARRIED = {
    "central_crack, patch of 430 x 110":
        ["-options_file", "cases/central_crack/coupled.opts", "-options_file", "cases/central_crack/pulled.opts",
         "-ts_max_steps", "300"],
    "kalthoff_winkler, points": ["-options_file", "cases/kalthoff_winkler/points.opts", "-output_fields", "false"],
}

# A cell far from patch and crack changes hands every few steps, in plates around the same patch.
CELL = 0.05 / 49  # side of an element of cases/central_crack [m]
AWAY = 15  # cells from the middle to the one that changes hands
PLATES = {"1 x": 49, "4 x": 99, "16 x": 197}  # elements along a side; odd, so that the patch fits
BEGIN, CHANGED, EVERY = 20, 200, 5  # steps before any change, with changes, from one to the next


def changing(cells, steps, every=0):
    """cases/central_crack in a plate of cells x cells elements; with `every`, one of them changes hands so often."""
    half = 0.5 * cells * CELL
    scene = ["-options_file", "cases/central_crack/coupled.opts", "-options_file", "cases/central_crack/pulled.opts",
             "-mesh_cells", f"{cells},{cells}", "-mesh_lower", f"{-half!r},{-half!r}", "-mesh_upper", f"{half!r},{half!r}",
             "-output_history_interval", "1000000", "-ts_max_steps", str(steps)]
    if every:
        lower, upper = (AWAY - 0.501) * CELL, (AWAY + 0.501) * CELL
        scene += ["-layout_renew_interval", str(every), "-layout_renew_box", f"{lower!r},{lower!r},{upper!r},{upper!r}"]
    return scene


def pulse(variant, mesh):
    """The plate with rollers in elements of 10 mm / mesh, to the time at which the error is read."""
    return ["-options_file", f"cases/pulse/{variant}.opts", *ROLLERS, "-mesh_cells", f"{50 * mesh},{25 * mesh}",
            "-pd_spacing", repr(1e-2 / mesh / PULSE_RATIO), "-ts_max_time", repr(BEHIND), "-output_times", repr(BEHIND)]


def directed_bonds(count, reach):
    """Ends of bonds between all sites of a lattice that are nearer to each other than `reach` spacings."""
    steps = range(-int(reach), int(reach) + 1)
    return sum((count[0] - abs(i)) * (count[1] - abs(j)) for i in steps for j in steps if 0 < i * i + j * j < reach**2)


class MotionBench(Bench):
    def kernels(self):
        rates = self.kernel_rates("bench_explicit_kernel")
        self.results["kernels"] = rates
        goals = {("plate320_48", "list"): 9, ("plate320_48", "list_gathered"): 5, ("plate88_48", "list"): 7}
        rows = []
        for size, name in SIZES.items():
            rate = {kernel: rates.get(f"{size}/{kernel}") for kernel in CRITICAL}

            def over(other):
                goal = goals.get((size, other))
                return f"**{rate['strips'] / rate[other]:.1f}**" + (f" (goal {goal})" if goal else "")

            # powers of the stretch against root and division, for bonds up to .0025 and up to .0099
            powers = " / ".join(f"{rates[f'{size}/{kernel}'] / rates[f'{size}/strips_root']:.2f}"
                                for kernel in ("strips", "strips_seventh"))
            wide = f"{rate['strips_avx2'] / rate['strips_avx512']:.2f}" if rate["strips_avx512"] else "-"
            rows.append([name, f"{rate['strips'] / 1e9:.2f}", over("list"), over("list_gathered"), f"**{powers}** (goal 1.2)",
                         wide, f"{rate['strips'] / rate['whole_step']:.2f}"])
        self.table("Explicit bond kernel, finite stretch, overstretched bonds watched, one core",
                   ["particles", "lane strips [1e9 bonds/s]", "over the scalar list", "over the gathered list",
                    "powers of the stretch, up to .0025 / .0099, over root and division",
                    "AVX2 over AVX-512 (goal 0.8)", "whole step / forces (goal 1.3)"], rows)
        self.kernel_picture(rates)

    def elements(self):
        """Forces of elements in explicit steps: rectangles in rows, skewed cells in lanes, against what they replace."""
        rates = self.kernel_rates("bench_element_kernel")
        self.results["elements"] = rates
        before = {"finite": ("one_by_one", "one_by_one_skewed"), "linear": ("shared_stiffness", "kept_stiffness_skewed")}
        goals = {"finite": ("6", "16"), "linear": ("4", "14")}
        rows = []
        for size, name in (("plate49", "49 x 49"), ("plate500", "500 x 500")):
            for strain, old in before.items():
                for kernel, replaced, goal in zip(("rows", "lanes"), old, goals[strain]):
                    nanoseconds = {key: 1e9 / rates[f"{size}/{strain}/{key}"] for key in
                                   (replaced, *(f"{kernel}_{v}" for v in ("avx512", "avx512_energy", "avx2", "portable")))
                                   if f"{size}/{strain}/{key}" in rates}
                    shown = [f"{nanoseconds[key]:.2f}" if key in nanoseconds else "-" for key in
                             (replaced, f"{kernel}_avx512", f"{kernel}_avx512_energy", f"{kernel}_avx2", f"{kernel}_portable")]
                    fastest = min(nanoseconds.get(f"{kernel}_{v}", np.inf) for v in ("avx512", "avx2", "portable"))
                    rows.append([name, f"{strain}, {'rectangles' if kernel == 'rows' else 'skewed'}", shown[0],
                                 f"{shown[1]} (goal {goal})", *shown[2:], f"**{nanoseconds[replaced] / fastest:.1f}**"])
        self.table("Forces of elements, ns per element, one core",
                   ["elements", "strain, cells", "one by one", "AVX-512", "its energy", "AVX2", "portable", "times faster"],
                   rows)

        self.whole_steps_of_elements()

    def whole_steps_of_elements(self):
        """pulse in elements only, all that a run does but set-up: per element and step, with and without history."""
        scene, counts, cells = ["-options_file", "cases/pulse/fe_only.opts", *ROLLERS, "-output_fields", "false"], (400, 1600), 250 * 125
        spent = {"with": [], "without": []}
        for _ in range(self.rounds):
            for name, more in (("with", []), ("without", ["-output_history", "false"])):
                few, many = (self.run([*scene, *more, "-ts_max_steps", str(count)])["wall_seconds"] for count in counts)
                seconds = sum(many[part] - few[part] for part in ("solve", "output"))
                spent[name].append(1e9 * seconds / (counts[1] - counts[0]) / cells)
        shown = {name: statistics.median(values) for name, values in spent.items()}
        self.results["elements whole steps"] = shown
        self.table("pulse, 31,250 elements only, whole program, one core",
                   ["energies every 10 steps [ns per element and step]", "no history [ns]"],
                   [[f"**{shown['with']:.1f}** (goal 10)", f"{shown['without']:.1f}"]])

    def kernel_picture(self, rates):
        figure, axes = plt.subplots(figsize=(6.2, 3.2))
        kernels = {"strips_avx512": "strips, AVX-512", "strips_avx2": "strips, AVX2", "strips_portable": "strips, portable",
                   "list_gathered": "list, gathered", "list": "list, scalar"}
        colours = ["#4477aa", "#66ccee", "#ccbb44", "#ee6677", "#bbbbbb"]
        for k, (kernel, label) in enumerate(kernels.items()):
            heights = [(rates.get(f"{size}/{kernel}") or 0) / 1e9 for size in SIZES]
            axes.bar([x + 0.16 * (k - 2) for x in range(len(SIZES))], heights, 0.15, label=label, color=colours[k])
        axes.set_xticks(range(len(SIZES)), [name.replace(", ", "\n") for name in SIZES.values()])
        axes.set_ylabel("directed bonds per second [1e9]")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=8)
        figure.savefig(self.out / "kernels.png", dpi=200, bbox_inches="tight")
        plt.close(figure)

    def program(self):
        """Steps of cases/branching with everything a run does, against the kernel alone; and on two ranks."""
        scene = ["-options_file", "cases/branching/case.opts", "-ts_max_steps", str(STEPS), "-output_fields",
                 "-output_interval", "100", "-output_history", "-output_history_interval", "10"]
        rates = self.kernel_rates("bench_explicit_kernel")
        both = {ranks: [] for ranks in (1, 2)}
        for _ in range(self.rounds):
            for ranks, runs in both.items():
                summary = self.run(scene, ranks, wall=True)
                runs.append(summary["wall_seconds"]["solve"] + summary["wall_seconds"]["output"])
        seconds = {ranks: sorted(runs)[len(runs) // 2] for ranks, runs in both.items()}
        bonds = directed_bonds(**PLATE) * STEPS / seconds[1]
        share = bonds / rates["plate320_48/strips"]
        self.results["program"] = {"bonds_per_second": bonds, "share": share, "seconds": seconds}
        self.table(f"cases/branching, particles only, {STEPS} steps: breaking, energies every 10 steps, fields every 100",
                   ["1 rank [s]", "1e9 bonds/s", "of the kernel's rate (goal 0.6)", "2 ranks [s]", "2 ranks over 1 (goal 1.8)"],
                   [[f"{seconds[1]:.2f}", f"{bonds / 1e9:.2f}", f"**{share:.2f}**", f"{seconds[2]:.2f}",
                     f"**{seconds[1] / seconds[2]:.2f}**"]])

    def carried(self):
        """Forces of bonds from particles to elements or grids over those between particles, as the program's log has them."""
        rows = []
        for name, scene in CARRIED.items():
            shares, spent = [], []
            for _ in range(self.rounds):
                with tempfile.TemporaryDirectory() as directory:
                    log = os.path.join(directory, "log.txt")
                    self.run([*scene, "-log_view", f":{log}"])
                    with open(log, encoding="utf-8") as lines:
                        seconds = {line.split()[0]: float(line.split()[3]) for line in lines
                                   if line.startswith(("couple_force ", "pd_force "))}
                shares.append(seconds["couple_force"] / seconds["pd_force"])
                spent.append(seconds["couple_force"])
            share = statistics.median(shares)
            self.results[f"carried {name}"] = {"share": share, "seconds": statistics.median(spent)}
            rows.append([name, f"{statistics.median(spent):.3f}", f"**{share:.3f}** (goal 0.1)"])
        self.table("Carried bonds, forces of explicit steps", ["scene", "carried bonds [s]", "over the lattice's"], rows)

    def layout(self):
        """Processor time of a change of layout far from all else over that of a step, as the plate grows."""
        rows = []
        for ranks in (1, 2):
            for name, cells in PLATES.items():
                steps, changes = [], []
                for _ in range(self.rounds):
                    runs = [self.run(changing(cells, *how), ranks)
                            for how in ((BEGIN,), (BEGIN + CHANGED,), (BEGIN + CHANGED, EVERY))]
                    short, whole, changed = (run["user_seconds"] / ranks for run in runs)
                    steps.append((whole - short) / CHANGED)
                    changes.append((changed - whole) / runs[2]["relocations"])
                step, change = statistics.median(steps), statistics.median(changes)
                ratio = statistics.median(c / s for c, s in zip(changes, steps))
                self.results[f"layout {name}, {ranks} ranks"] = {"step": step, "change": change, "ratio": ratio}
                rows.append([f"{name}, {cells}²", ranks, f"{1e3 * step:.2f}", f"{1e3 * change:.2f}", f"**{ratio:.1f}** (goal 3)"])
        self.table("A cell far from the patch of cases/central_crack changes hands: processor time per rank",
                   ["elements", "ranks", "a step [ms]", "a change [ms]", "in steps"], rows)

    def stable_step(self, scene):
        """The program's own choice without -ts_dt: 0.9 of the limit [s]."""
        return 0.9 * self.run(scene + ["-ts_max_steps", "1", "-ts_dt", "1e-12"])["results"]["stable_step"]

    def pulse_pareto(self):
        """Run time of the pulse against its distance from the exact one behind the patch. Steps are 0.9 of each
        scene's own limit, and once for elements only that of the particles on the same mesh."""
        families = {"elements only": [(n, "fe_only", "fe_only") for n in (*PULSE_MESHES, 12)],
                    "elements only, the particles' steps": [(n, "fe_only", "case") for n in PULSE_MESHES],
                    "papers' scheme": [(n, "paper", "paper") for n in PULSE_MESHES],
                    "default scheme": [(n, "case", "case") for n in PULSE_MESHES]}
        steps = {(variant, n): self.stable_step(pulse(variant, n)) for members in families.values()
                 for n, _, variant in members}
        scenes = {(name, n): (pulse(variant, n), steps[limited_by, n])
                  for name, members in families.items() for n, variant, limited_by in members}
        runs, errors = {key: [] for key in scenes}, {}
        for _ in range(self.rounds):
            for key, (scene, step) in scenes.items():
                with tempfile.TemporaryDirectory() as directory:
                    runs[key].append(self.run(scene + ["-ts_dt", repr(step)], keep=directory))
                    errors[key] = 100 * waves.difference(directory, None, BEHIND)
        rows, curves = [], {}
        for (name, n), samples in runs.items():
            seconds = statistics.median(run["wall_seconds"]["solve"] for run in samples)
            rows.append([name, f"{10 / n:.2f}", samples[0]["unknowns"]["total"], f"{1e9 * scenes[name, n][1]:.0f}",
                         samples[0]["steps"], f"{errors[name, n]:.3f}", f"{seconds:.3f}"])
            curves.setdefault(name, []).append((errors[name, n], seconds))
        self.results["pulse_pareto"] = curves
        self.table("pulse: run time against distance from the exact pulse behind the patch",
                   ["method", "h [mm]", "unknowns", "step [ns]", "steps", "error [%]", "steps [s]"], rows)
        self.picture("pulse_pareto.png", "largest distance from the exact pulse, of its amplitude [%]", curves,
                     "all steps, one core [s]")

    most_ranks = 1

    def scaling(self):
        """Wall time of steps on more and more ranks, medians of interleaved rounds."""
        counts, load = scaling.rank_counts(self.most_ranks), os.getloadavg()[0]
        measured = scaling.measure(self.executable, SCALING, counts, self.rounds, ROOT)
        self.results["scaling"] = measured
        rows = [[name, *scaling.words(row)] for name, scene in measured.items() for row in scene]
        self.table(f"Strong scaling, steps alone, wall time; {scaling.cores()} cores, load {load:.1f} beforehand",
                   ["scene", *scaling.COLUMNS], rows)
        self.scaling_picture(measured, counts)

    def scaling_picture(self, measured, counts):
        figure, axes = plt.subplots(figsize=(4.6, 3.4))
        ends = [counts[0], counts[-1]]
        axes.plot(ends, ends, color="0.5", linewidth=0.8, linestyle="--", label="ideal")
        for (name, scene), colour, marker in zip(measured.items(), COLOURS, MARKERS):
            axes.plot([row[0] for row in scene], [row[4] for row in scene], marker=marker, markersize=4, linewidth=1,
                      color=colour, label=name)
        if len(counts) > 4:  # up to 8 ranks and more
            axes.set_xscale("log", base=2)
            axes.set_yscale("log", base=2)
        else:
            axes.set(xlim=(0, 1.05 * counts[-1]), ylim=(0, 1.05 * counts[-1]))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_ticks(counts, [str(count) for count in counts])
        axes.minorticks_off()
        axes.set(xlabel="ranks", ylabel="times faster than one rank")
        axes.grid(True, which="major", linewidth=0.3)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.05, 1.0))
        figure.savefig(self.out / "scaling.png", dpi=200, bbox_inches="tight")
        plt.close(figure)
