"""Fields for other programs: as VTKHDF says it (the layout of https://docs.vtk.org, VTKHDF 2.0), and packed. What a reader
finds at the places that the format names is what fields.h5 has; and what stays as it was stands in the file once."""

import subprocess
import sys

import numpy as np
import program
from program import pdxtools
from torn import COUPLED, TORN

import h5py

FIELDS = {"-output_fields": "", "-output_interval": "100", "-crack_notch_points": "0,0.26,0.45,0.26"}
CORNERS = {"mesh": 4, "cut_cells": 4, "particles": 1}
TENSOR = [pdxtools.TENSOR.index(name) for name in ("xx", "yy", "zz", "xy", "yz", "xz")]  # VTK's order


class Vtkhdf(program.ProgramTest):
    CRACKS_REACH_BORDERS = CRACKS_LIE_ON_ROWS = True

    def command(self, module, *words):
        done = subprocess.run([sys.executable, "-m", f"pdxtools.{module}", *map(str, words)], cwd=program.ROOT / "scripts",
                              capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(done.returncode, 0, done.stderr)

    def assert_shown(self, run, name):
        corners = CORNERS[name]
        steps = [pdxtools.read_step(run, k) for k in range(pdxtools.step_count(run))]
        with h5py.File(run / f"fields_{name}.vtkhdf") as file:
            root, times = file["VTKHDF"], file["VTKHDF/Steps"]
            self.assertEqual((root.attrs["Type"], list(root.attrs["Version"])), (b"UnstructuredGrid", [2, 0]))
            self.assertEqual(times.attrs["NSteps"], len(steps))
            self.assertEqual(list(times["Values"]), [time for time, _ in steps])
            for k, (_, blocks) in enumerate(steps):
                part = times["PartOffsets"][k]
                points, cells = root["NumberOfPoints"][part], root["NumberOfCells"][part]
                if name not in blocks:
                    self.assertEqual((points, cells), (0, 0))
                    continue
                block = blocks[name]
                self.assertEqual(root["NumberOfConnectivityIds"][part], corners * cells)
                first, cell = times["PointOffsets"][k], times["CellOffsets"][k, 0]
                np.testing.assert_array_equal(root["Points"][first : first + points], block.points)
                begin = times["ConnectivityIdOffsets"][k, 0]
                np.testing.assert_array_equal(root["Connectivity"][begin : begin + corners * cells], block.cells.ravel())
                np.testing.assert_array_equal(root["Offsets"][cell + part :][: cells + 1], corners * np.arange(cells + 1))
                self.assertEqual(set(root["Types"][cell : cell + cells]), {9 if corners == 4 else 1})
                for field, values in block.fields.items():
                    kind, count = ("Cell", cells) if block.on_cells(field) else ("Point", points)
                    at = times[f"{kind}DataOffsets/{field}"][k]
                    shown = root[f"{kind}Data/{field}"][at : at + count]
                    np.testing.assert_array_equal(shown, values[:, TENSOR] if values.ndim == 2 and values.shape[1] == 6 else values)
            return len(root["Points"])

    def test_what_is_shown_is_what_the_run_wrote(self):
        run = self.solve(COUPLED | FIELDS | {"-output_format": "vtkhdf"}, ranks=2).directory
        for name in CORNERS:
            with self.subTest(name):
                self.assertEqual(self.assert_shown(run, name), len(pdxtools.read_step(run)[1][name].points))
        with h5py.File(run / "fields.h5") as file:
            for block in ("mesh", "cut_cells", "particles"):
                for table in ("points", "cells", "natural_point", "side" if block == "cut_cells" else "rank"):
                    self.assertEqual(file[f"step000000/{block}/{table}"], file[f"step000003/{block}/{table}"])
        for words in ((), ("--whole",)):
            self.command("vtkhdf", run, *words)
            for name in CORNERS:
                with self.subTest(name, words=words):
                    self.assertEqual(self.assert_shown(run, name), len(pdxtools.read_step(run)[1][name].points))

    def test_patches_that_grow_have_all_their_steps(self):
        options = {"-options_file": "cases/central_crack/smoke.opts", "-pd_patches": "-0.009,-0.005,0.009,0.005", "-quiet": "",
                   "-adapt": "relocate", "-output_fields": "", "-output_interval": "300"}  # fmt: skip
        run = self.solve(options | {"-output_format": "vtkhdf"}).directory
        steps = [pdxtools.read_step(run, k)[1] for k in range(pdxtools.step_count(run))]
        counts = [len(blocks["particles"].points) for blocks in steps]
        self.assertGreater(len(set(counts)), 1)
        self.assertEqual({"cut_cells" in blocks for blocks in steps}, {False, True})
        for words in (None, ()):
            if words is not None:
                self.command("vtkhdf", run, *words)
            self.assertLessEqual(self.assert_shown(run, "particles"), sum(counts))
            self.assert_shown(run, "mesh")
            self.assert_shown(run, "cut_cells")
        short = {"-output_fields": None, "-output_interval": None, "-ts_max_steps": "1"}
        self.launch(options | short, directory=run)  # results of an earlier run go
        self.assertEqual(list(run.glob("fields*")), [])

    def test_packed_fields_are_the_same_and_a_restart_adds_to_them(self):
        options = TORN | {"-output_fields": "", "-output_interval": "100", "-checkpoint_interval": "200"}
        run = self.solve(options | {"-ts_max_steps": "200"}).directory
        before, size = [pdxtools.read_step(run, k) for k in range(2)], (run / "fields.h5").stat().st_size
        self.command("pack", run)
        self.assertLess((run / "fields.h5").stat().st_size, 0.9 * size)
        self.assertEqual([path.name for path in run.glob("*.part")], [])
        for k, (time, blocks) in enumerate(before):
            now, packed = pdxtools.read_step(run, k)
            self.assertEqual((now, packed.keys()), (time, blocks.keys()))
            for name, block in blocks.items():
                self.assertEqual((block.units, block.fields.keys()), (packed[name].units, packed[name].fields.keys()))
                for field, values in (block.fields | {"points": block.points, "cells": block.cells}).items():
                    other = (packed[name].fields | {"points": packed[name].points, "cells": packed[name].cells})[field]
                    np.testing.assert_array_equal(values, other, f"{name} {field}")
        self.solve(options | {"-restart": str(run / "checkpoint.h5")}, directory=run)
        times = pdxtools.step_times(run)
        self.assertEqual((len(times), list(times[:2])), (4, [time for time, _ in before]))
        self.assertFalse((pdxtools.read_step(run, 3)[1]["particles"]["displacement"] == before[1][1]["particles"]["displacement"]).all())


if __name__ == "__main__":
    program.main()
