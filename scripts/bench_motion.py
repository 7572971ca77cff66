"""The benchmarks of explicit dynamics: bond kernels, the whole program, ranks."""
import json
import os
import subprocess

from bench_machine import Bench, plt

CRITICAL = ("strips", "list", "list_gathered", "strips_avx2", "strips_avx512", "strips_portable", "whole_step")
SIZES = {"plate320_48": "320 x 320, 48 neighbours", "plate320_28": "320 x 320, 28 neighbours",
         "plate88_48": "88 x 88, 48 neighbours", "cube47_122": "47 x 47 x 47, 122 neighbours"}
PLATE = {"count": (800, 320), "reach": 4.5}  # of cases/branching: sites, and horizon of its bonds in spacings
STEPS = 300


def directed_bonds(count, reach):
    """Ends of bonds between all sites of a lattice that are nearer to each other than `reach` spacings."""
    steps = range(-int(reach), int(reach) + 1)
    return sum((count[0] - abs(i)) * (count[1] - abs(j)) for i in steps for j in steps if 0 < i * i + j * j < reach**2)


class MotionBench(Bench):
    def kernel_rates(self):
        """Directed bonds per second of processor time of each kernel, medians of interleaved rounds of one run."""
        command = [str(self.executable.parent / "tests/bench_explicit_kernel"), "--benchmark_format=json",
                   f"--benchmark_repetitions={self.rounds}", "--benchmark_enable_random_interleaving=true",
                   "--benchmark_min_time=0.2"]
        if hasattr(os, "sched_setaffinity"):
            command = ["taskset", "-c", str(max(os.sched_getaffinity(0))), *command]
        report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        return {row["run_name"].split("/repeats")[0]: row["items_per_second"] for row in report["benchmarks"]
                if row.get("aggregate_name") == "median" and not row.get("error_occurred")}

    def kernels(self):
        rates = self.kernel_rates()
        self.results["kernels"] = rates
        goals = {("plate320_48", "list"): 9, ("plate320_48", "list_gathered"): 5, ("plate88_48", "list"): 7}
        rows = []
        for size, name in SIZES.items():
            rate = {kernel: rates.get(f"{size}/{kernel}") for kernel in CRITICAL}

            def over(other):
                goal = goals.get((size, other))
                return f"**{rate['strips'] / rate[other]:.1f}**" + (f" (goal {goal})" if goal else "")

            wide = f"{rate['strips_avx2'] / rate['strips_avx512']:.2f}" if rate["strips_avx512"] else "-"
            rows.append([name, f"{rate['strips'] / 1e9:.2f}", over("list"), over("list_gathered"), wide,
                         f"{rate['strips'] / rate['whole_step']:.2f}"])
        self.table("Explicit bond kernel, finite stretch, overstretched bonds watched, one core",
                   ["particles", "lane strips [1e9 bonds/s]", "over the scalar list", "over the gathered list",
                    "AVX2 over AVX-512 (goal 0.8)", "whole step / forces (goal 1.3)"], rows)
        self.kernel_picture(rates)

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
        rates = self.kernel_rates()
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
