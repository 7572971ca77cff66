"""Draws the last step of one or more runs: elements, particles or both, clouds, material points, solids seen along z.

usage: {name} OUT_DIR [...] -o picture.png [--kind plate|crack|damage|energy|ranks|motion] [--scale S] [--error linear|log]
  plate   a row per run: the deformed plate coloured by |u|, and the error against the reference [XPD1 Fig. 5]
  crack   the deformed mesh, elements that a crack cuts and particles in colours of their own [XPD1 Fig. 11]
  damage  share of the broken bonds of each particle, elements pale
  energy  strain energy density of the particles
  ranks   mesh and particles coloured by the rank that owns them
  motion  material points of one run as they are at its steps with fields, or those of --steps, by stress
"""

import argparse
import pathlib
import sys

from . import draw
from .fields import NotThere, fields_path


def main():
    name = pathlib.Path(sys.argv[0]).name
    parser = argparse.ArgumentParser(description=__doc__.format(name=name), formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="OUT_DIR")
    parser.add_argument("-o", "--output", required=True, help="picture to write (.png, .pdf, .svg)")
    parser.add_argument("--kind", choices=list(draw.KINDS), default="plate")
    parser.add_argument("--step", type=int, default=-1, help="number of the step, from 0, or -1 for the last")
    parser.add_argument("--scale", type=float, default=0.0, help="magnification of displacements (default: chosen)")
    parser.add_argument("--error", choices=["auto", "linear", "log"], default="auto", help="colours of the error map")
    parser.add_argument("--steps", default="", help="of motion: which of the steps with fields, from 0, with commas; -1 is the last")
    options = parser.parse_args()
    for run in options.runs:
        if not fields_path(run).exists():
            sys.exit(f"{name}: {fields_path(run)} is not there: give the directory of a run with -output_fields")
    try:
        runs = [draw.Run(directory, options.step) for directory in options.runs]
        steps = tuple(int(step) for step in options.steps.split(",") if step)
        draw.draw(options.kind, runs, options.output, draw.Look(options.scale, options.error, steps))
    except NotThere as error:
        sys.exit(f"{name}: {error}")
    except (OSError, IndexError, ValueError) as error:
        sys.exit(f"{name}: cannot read the runs: {error}")
    print(f"wrote {options.output}")


if __name__ == "__main__":
    main()
