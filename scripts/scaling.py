#!/usr/bin/env python3
"""Strong scaling of one scene in time: steps per second, speed-up and efficiency on 1, 2, 4 ... ranks.

usage: scaling.py [--ranks 1,2,4] [--rounds 3] [--executable build/release/pdxsolve] -- OPTIONS OF PDXSOLVE
Every number of ranks runs once per round; medians count, of the steps alone: set-up and output do not. PDX_LAUNCH is
what starts the ranks, followed by "-n N": srun in a job of Slurm, else mpirun. Needs no packages of Python.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
COLUMNS = ("ranks", "steps", "seconds", "steps/s", "speed-up", "efficiency")


def cores():
    """How many this process may use, or tasks of the job it is in."""
    tasks = os.environ.get("SLURM_NTASKS")
    if tasks:
        return int(tasks)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def rank_counts(most):
    """1, 2, 4, ... and `most` itself."""
    return sorted({2**k for k in range(most.bit_length()) if 2**k <= most} | {most})


def launch(count):
    words = os.environ.get("PDX_LAUNCH") or ("srun" if "SLURM_JOB_ID" in os.environ else "mpirun")
    return [*words.split(), "-n", str(count)]


def run(executable, options, count, place):
    """Number of steps, and wall time of all of them [s]."""
    scratch = os.environ.get("TMPDIR", place)  # seen by all nodes
    with tempfile.TemporaryDirectory(prefix="pdx_scaling_", dir=scratch) as directory:
        command = [*launch(count), str(executable), *options, "-quiet", "-output_dir", directory]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(command)}\nfailed: {done.stderr}")
        summary = json.loads((pathlib.Path(directory) / "summary.json").read_text(encoding="utf-8"))
        return summary["steps"], summary["wall_seconds"]["solve"]


def measure(executable, scenes, counts, rounds, place):
    """Rows of COLUMNS, as numbers, by name of a scene; `scenes` are options by name, as said in the directory `place`. All
    scenes on all numbers of ranks run in turn, round after round."""
    runs = {(name, count): [] for name in scenes for count in counts}
    for _ in range(rounds):
        for (name, count), samples in runs.items():
            samples.append(run(executable, scenes[name], count, place))
    rows = {name: [] for name in scenes}
    for (name, count), samples in runs.items():
        steps, seconds = samples[0][0], statistics.median(time for _, time in samples)
        first = rows[name][0] if rows[name] else (count, steps, seconds)
        gain = first[2] / seconds
        rows[name].append((count, steps, seconds, steps / seconds, gain, gain * first[0] / count))
    return rows


def words(row):
    """A row as it is printed."""
    count, steps, seconds, rate, gain, efficiency = row
    return [str(count), str(steps), f"{seconds:.3f}", f"{rate:.1f}", f"{gain:.2f}", f"{100 * efficiency:.0f}%"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--executable", default=ROOT / "build/release/pdxsolve", type=pathlib.Path)
    parser.add_argument("--ranks", help="numbers of ranks, separated by commas or spaces (1, 2, 4 ... up to all cores)")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("options", nargs="+", help="of pdxsolve, after --")
    arguments = parser.parse_args()
    counts = [int(word) for word in (arguments.ranks or "").replace(",", " ").split()] or rank_counts(cores())
    executable = arguments.executable.resolve()
    rows = measure(executable, {"": arguments.options}, counts, arguments.rounds, pathlib.Path.cwd())[""]
    for row in [COLUMNS, *map(words, rows)]:
        print(" ".join(f"{word:>11}" for word in row), flush=True)


if __name__ == "__main__":
    main()
