#!/usr/bin/env python3
"""Measures what points that become particles save against particles only, in turns, and prints the table of the README:
processor time of whole runs without pictures, median of some rounds, at the paper's spacings and at half of them.

usage: study.py [--executable build/release/pdxsolve] [--out out/efficiency] [--only plate,hole,kalthoff] [--rounds 5]
"""

import os
import statistics

import efficiency
import case_study


def seconds(arguments, scene, way, name, more):
    """Processor time of a run [s]."""
    before = os.times()
    variant = (scene + way, [*more, "-output_fields", "false"])
    if not case_study.run(arguments.executable, "efficiency", name, variant, arguments.out, timeout=900):
        raise SystemExit(1)
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


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
    heads = [f"{words} [s]" for words in efficiency.WAYS.values()]
    case_study.print_table(["scene", "spacing", *heads, "saves [%]", "coarser [%]", "paper [%]"], lines)


if __name__ == "__main__":
    main()
