#!/usr/bin/env pvpython
"""Sets up the usual view of a run in ParaView: elements as a grid, cut elements and particles where they have moved to,
particles coloured by damage where they have one. Run by pvpython, or in ParaView by Tools, Python Shell, Run Script.

usage: pvpython paraview_view.py OUT_DIR [--state case.pvsm] [-o picture.png] [--step -1] [--scale S]
Reads fields.xdmf; from ParaView 5.12 on the files of pdxsolve-vtkhdf instead, where they are beside it.
"""

import argparse
import os
import pathlib
import sys

from paraview import simple

GRID, CUT = (0.75, 0.75, 0.73), (0.95, 0.82, 0.24)
BLOCKS = ("mesh", "cut_cells", "particles", "points")
SHARE = 0.05  # of the body's size that the largest displacement is drawn as


def sources(run):
    """A source for each block by its name, and the times of all."""
    files = sorted(run.glob("fields_*.vtkhdf"))
    version = simple.GetParaViewVersion()
    if files and (version.major, version.minor) >= (5, 12):
        readers = {path.stem.removeprefix("fields_"): simple.OpenDataFile(str(path)) for path in files}
        return readers, list(next(iter(readers.values())).TimestepValues)
    reader = simple.XDMFReader(registrationName=run.name, FileNames=[str(run / "fields.xdmf")])
    reader.UpdatePipeline()
    found, times = {}, list(reader.TimestepValues)
    for block in BLOCKS:  # of which the reader gives all that the run has in one
        names = [block] + [f"{block}{k}" for k in range(1, len(times))]  # the reader numbers them by steps
        taken = simple.ExtractBlock(registrationName=block, Input=reader, Selectors=[f"/Root/{name}" for name in names])
        taken.UpdatePipeline(times[-1] if times else 0.0)
        if taken.GetDataInformation().GetNumberOfPoints() > 0:
            found[block] = taken
    return found, times


def names_of(source):
    return [source.PointData.GetArray(k).Name for k in range(source.PointData.GetNumberOfArrays())]


def field(source, stem):
    """The full name of a field, which XDMF has with its unit."""
    return next((name for name in names_of(source) if name.split(" [")[0] == stem), None)


def size_of(sources_by_name):
    bounds = [source.GetDataInformation().GetBounds() for source in sources_by_name.values()]
    return max(max(b[1] for b in bounds) - min(b[0] for b in bounds), max(b[3] for b in bounds) - min(b[2] for b in bounds))


def magnification(sources_by_name):
    largest = 0.0
    for source in sources_by_name.values():
        name = field(source, "displacement")
        if name:
            largest = max(largest, *(abs(value) for k in range(2) for value in source.PointData[name].GetRange(k)))
    return SHARE * size_of(sources_by_name) / largest if largest else 1.0


def show(source, block, scale, view):
    moved = source
    displacement = field(source, "displacement")
    if displacement:
        moved = simple.WarpByVector(registrationName=f"{block}, moved", Input=source, Vectors=["POINTS", displacement], ScaleFactor=scale)
    if block == "mesh":
        moved = simple.Threshold(registrationName="elements", Input=moved, Scalars=["CELLS", "use"], ThresholdMethod="Between",
                                 LowerThreshold=0, UpperThreshold=0)  # fmt: skip
    look = simple.Show(moved, view)
    if block in ("mesh", "cut_cells"):
        look.Representation = "Surface With Edges" if block == "cut_cells" else "Wireframe"
        look.ColorArrayName = ["POINTS", ""]  # one colour
        look.AmbientColor = look.DiffuseColor = CUT if block == "cut_cells" else GRID
        return
    look.Representation, look.PointSize = "Points", 3
    damage = field(source, "damage") or displacement
    simple.ColorBy(look, ("POINTS", damage))
    look.SetScalarBarVisibility(view, True)
    simple.GetColorTransferFunction(damage).ApplyPreset("Viridis (matplotlib)", True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="OUT_DIR", type=pathlib.Path)
    parser.add_argument("--state", help="keep the view in this file")
    parser.add_argument("-o", "--output", help="draw it into this picture")
    parser.add_argument("--step", type=int, default=-1, help="number of the step, from 0, or -1 for the last")
    parser.add_argument("--scale", type=float, default=0.0, help="of displacements (default: chosen)")
    options = parser.parse_args()
    if options.output and sys.platform == "linux" and not os.environ.get("DISPLAY"):
        print("no DISPLAY: a ParaView that draws by X alone, as Debian's, ends here; xvfb-run -a pvpython ... lends it one", file=sys.stderr)
    blocks, times = sources(options.run.resolve())
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    view = simple.GetActiveViewOrCreate("RenderView")
    view.ViewSize = [1200, 700]
    if times:
        scene.AnimationTime = view.ViewTime = times[options.step]
    for source in blocks.values():
        source.UpdatePipeline(view.ViewTime)
    scale = options.scale or magnification(blocks)
    for block, source in blocks.items():
        show(source, block, scale, view)
    simple.ResetCamera(view)
    print(f"blocks {', '.join(blocks)}, {len(times)} steps, time {view.ViewTime:.6g}, displacements times {scale:.4g}")
    if options.state:
        simple.SaveState(options.state)
    if options.output:
        simple.Render(view)
        simple.SaveScreenshot(options.output, view)


if __name__ == "__main__":
    main()
