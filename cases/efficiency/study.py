#!/usr/bin/env python3
"""Measures what points that become particles save against particles only, in turns, and prints the table of the README:
processor time of whole runs without pictures, median of some rounds, at the paper's spacings and at half of them.

usage: study.py [--executable build/release/pdxsolve] [--out out/efficiency] [--only plate,hole,kalthoff] [--rounds 5]
"""

import os
import statistics

import efficiency
import case_study
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of backend)

SERIES = (("as far apart", 5, "#4477aa"), ("twice as far", 6, "#66ccee"), ("the paper", 7, "#bbbbbb"))  # column of the table


def seconds(arguments, scene, way, name, more):
    """Processor time of a run [s]."""
    before = os.times()
    variant = (scene + way, [*more, "-output_fields", "false"])
    if not case_study.run(arguments.executable, "efficiency", name, variant, arguments.out, timeout=900):
        raise SystemExit(1)
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


def picture(lines, path):
    """What is saved in each scene at half the paper's spacings, beside the paper's."""
    half = [line for line in lines if line[1] == "half"]
    figure, axes = plt.subplots(figsize=(4.6, 2.8))
    for k, (label, column, colour) in enumerate(SERIES):
        axes.bar([at + 0.27 * (k - 1) for at in range(len(half))], [float(line[column]) for line in half], 0.25, color=colour, label=label)
    axes.set_xticks(range(len(half)), [line[0] for line in half])
    axes.set(ylabel="time saved [%]", ylim=(0, 100))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8, ncol=3)
    figure.savefig(path, dpi=200, bbox_inches="tight")


def main():
    parser = case_study.Parser(__doc__, "efficiency", efficiency.SCENES)
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.read()
    arguments.out.mkdir(parents=True, exist_ok=True)
    lines = []
    for scene in arguments.only:
        for size in ("paper's", "half"):
            times = {way: [] for way in efficiency.WAYS}
            for _ in range(arguments.rounds):
                for way in efficiency.WAYS:
                    more = efficiency.half(scene, way) if size == "half" else []
                    name = f"{scene}{way}_{size[:4]}"
                    times[way].append(seconds(arguments, scene, way, name, more))
            middle = {way: statistics.median(some) for way, some in times.items()}
            saved = [f"{100.0 * (1.0 - middle[way] / middle['_particles']):.0f}" for way in ("", "_coarser")]
            lines.append([scene, size, *(f"{middle[way]:.2f}" for way in efficiency.WAYS), *saved, efficiency.SCENES[scene]])
    picture(lines, arguments.out / "saved.png")
    heads = [f"{words} [s]" for words in efficiency.WAYS.values()]
    case_study.print_table(["scene", "spacing", *heads, "saves [%]", "coarser [%]", "paper [%]"], lines)


if __name__ == "__main__":
    main()
