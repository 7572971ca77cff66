"""What the benchmarks share: runs on a pinned core, interleaved rounds, medians, tables and pictures."""
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import pdxtools
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

ROOT = pathlib.Path(__file__).resolve().parent.parent
COLOURS = ["#4477aa", "#ee6677", "#ccbb44", "#228833"]
MARKERS = "os^D"
plt.rcParams.update({"font.family": "STIXGeneral", "mathtext.fontset": "stix", "font.size": 10})


class Bench:
    def __init__(self, executable, rounds, out):
        self.executable, self.rounds, self.out = pathlib.Path(executable).resolve(), rounds, out
        self.results, self.lines = {}, []

    def run(self, arguments, ranks=1, keep=None, may_fail=False, wall=False):
        """Runs a scene; returns its summary. `keep`: directory for its fields. `may_fail`: the run is cut short. `wall`:
        wall time also on one rank, to compare with several."""
        with tempfile.TemporaryDirectory() as scratch:
            directory = keep or scratch
            command = [str(self.executable), *arguments, "-quiet", "-output_dir", str(directory)]
            if ranks > 1:
                command = ["mpirun", "-n", str(ranks), *command]
            elif hasattr(os, "sched_setaffinity"):
                command = ["taskset", "-c", str(max(os.sched_getaffinity(0))), *command]
            before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
            after, elapsed = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - begin
            if done.returncode and not may_fail:
                sys.exit(f"{' '.join(command)}\nfailed: {done.stderr}")
            summary = pdxtools.read_summary(directory)
            summary["user_seconds"] = after.ru_utime - before.ru_utime
            if ranks == 1 and not wall:  # processor time: what other processes took of the core is not the solver's
                busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
                share = min(1.0, busy / elapsed)
                summary["busy_share"] = share
                summary["wall_seconds"] = {name: share * value for name, value in summary["wall_seconds"].items()}
            return summary

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

    def rounds_of(self, sides):
        """Summaries of every side, a run of each per round."""
        runs = {name: [] for name in sides}
        for _ in range(self.rounds):
            for name, arguments in sides.items():
                runs[name].append(self.run(arguments))
        return runs

    def kernel_rates(self, program, chosen="."):
        """Items per second of processor time of each kernel of tests/PROGRAM, medians of interleaved rounds of one run."""
        command = [str(self.executable.parent / "tests" / program), "--benchmark_format=json", f"--benchmark_filter={chosen}",
                   f"--benchmark_repetitions={self.rounds}", "--benchmark_enable_random_interleaving=true",
                   "--benchmark_min_time=0.2"]
        if hasattr(os, "sched_setaffinity"):
            command = ["taskset", "-c", str(max(os.sched_getaffinity(0))), *command]
        report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        return {row["run_name"].split("/repeats")[0]: row["items_per_second"] for row in report["benchmarks"]
                if row.get("aggregate_name") == "median" and not row.get("error_occurred")}

    def table(self, title, header, rows):
        self.lines += [f"### {title}", "", "| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
        self.lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows] + [""]
        print("\n".join(self.lines[-len(rows) - 5:]), flush=True)

    def picture(self, name, x_label, curves, y_label):
        figure, axes = plt.subplots(figsize=(4.6, 3.4))
        for (label, points), colour, marker in zip(curves.items(), COLOURS, MARKERS):
            x, y = zip(*sorted(points))
            one_way = all(b > a for a, b in zip(y, y[1:])) or all(b < a for a, b in zip(y, y[1:]))
            axes.loglog(x, y, marker=marker, markersize=4, linewidth=1 if one_way else 0, color=colour, label=label)
        axes.set(xlabel=x_label, ylabel=y_label)
        axes.grid(True, which="major", linewidth=0.3)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.05, 1.0), ncols=2)
        figure.savefig(self.out / name, dpi=200, bbox_inches="tight")
        plt.close(figure)
