"""The Python package that reads runs: what it gives back is what the scene must be, by closed forms."""

import math

import numpy as np
import program
from program import pdxtools
from torn import TORN

EVEN = program.EVEN | {"-case": "even", "-mesh_lower": "0,0", "-mesh_upper": "2,1", "-mesh_cells": "8,4", "-material_poisson": "0.25",
                       "-output_fields": "", "-output_history": "", "-load_steps": "2", "-probe_names": "middle,line",
                       "-probe_middle_at": "1,0.5", "-probe_middle_field": "displacement,stress",
                       "-probe_line_line": "0,0,2,0,5"}  # fmt: skip
STRAIN = 1e6 / 1e9  # along x at full load


class Reads(program.ProgramTest):
    def test_an_even_stretch_is_read_back(self):
        run = self.shared(EVEN).directory
        self.assertEqual(list(pdxtools.step_times(run)), [0.5, 1.0])
        self.assertEqual([pdxtools.step_at(run, load) for load in (0.1, 0.6, 2.0)], [0, 0, 1])
        for number, load in ((0, 0.5), (-1, 1.0)):
            time, blocks = pdxtools.read_step(run, number)
            mesh = blocks["mesh"]
            self.assertEqual((time, mesh.points.shape, mesh.cells.shape), (load, (45, 3), (32, 4)))
            moved = load * STRAIN * np.column_stack((mesh.points[:, 0], -0.25 * mesh.points[:, 1]))
            np.testing.assert_allclose(mesh["displacement"][:, :2], moved, atol=1e-9 * STRAIN)
            np.testing.assert_allclose(mesh["stress"][:, pdxtools.TENSOR.index("xx")], load * 1e6, rtol=1e-9)
            np.testing.assert_allclose(mesh["stress"][:, pdxtools.TENSOR.index("yy")], 0.0, atol=1e-2)
        self.assertEqual((mesh.units["displacement"], mesh.units["stress"]), ("m", "Pa"))
        self.assertTrue(mesh.on_cells("use") and not mesh.on_cells("stress"))
        self.assertEqual({pdxtools.CELL_USES[use] for use in mesh["use"]}, {"element"})
        with self.assertRaisesRegex(pdxtools.NotThere, "no field damage: there are displacement, "):
            mesh["damage"]

    def test_curves_and_probes_have_their_columns(self):
        run = self.shared(EVEN).directory
        energy = 0.5 * 1e6 * STRAIN * 2.0  # of 2 x 1 x 1 m at full load
        history = pdxtools.read_history(run)
        units = pdxtools.read_units(run / "history.csv")
        self.assertEqual(units.keys(), history.keys())
        self.assertEqual(units["energy_elements"], "J")
        np.testing.assert_allclose(history["energy_elements"], [energy / 4, energy], rtol=1e-9)
        probes = pdxtools.read_probes(run)
        self.assertEqual(sorted(probes), ["line", "middle"])
        np.testing.assert_allclose(probes["middle"]["displacement_x"], STRAIN * probes["middle"]["load"], atol=1e-9 * STRAIN)
        np.testing.assert_allclose(probes["line"]["along"], [0, 0.5, 1, 1.5, 2])
        np.testing.assert_allclose(probes["line"]["displacement_x"],
                                   STRAIN * np.outer(probes["line"]["load"], probes["line"]["along"]), atol=1e-9 * STRAIN)  # fmt: skip

    def test_options_and_papers_are_told(self):
        run = self.shared(EVEN | {"-case": "a name # with marks"}).directory
        options = {option.name: option for option in pdxtools.read_options(run)}
        self.assertEqual((options["-case"].value, options["-case"].place), ("a name # with marks", "command line"))
        self.assertEqual((options["-load_steps"].value, options["-load_steps"].given), ("2", True))
        self.assertEqual((options["-kinematics"].value, options["-kinematics"].given), ("small", False))
        self.assertEqual(options["-mesh_cells"].room, "mesh")
        self.assertEqual([entry.split(",")[0] for _, entry in pdxtools.read_citations(run)], ["@techreport{petsc", "@software{pdxsolve"])
        self.assertEqual(pdxtools.read_summary(run)["status"], "done")
        self.assertEqual(pdxtools.read_summary(self.scratch), {})

    def test_a_checkpoint_says_where_it_stands(self):
        run = self.shared(TORN | {"-ts_max_steps": "60", "-checkpoint_interval": "60", "-output_history": ""}).directory
        checkpoint, history = pdxtools.read_checkpoint(run), pdxtools.read_history(run)
        self.assertEqual(checkpoint.step, 60)
        self.assertTrue(math.isclose(checkpoint.time, history["time"][-1], rel_tol=1e-12))
        self.assertEqual(checkpoint.made_by["ranks"], "1")
        self.assertEqual(float(checkpoint.options["-pd_spacing"]), float(TORN["-pd_spacing"]))
        self.assertEqual(checkpoint.tables["displacement"], checkpoint.tables["velocity"])
        self.assertEqual(checkpoint.scene["particles"], str(checkpoint.tables["gone_bonds"][0]))
        self.assertIn("crack_path.csv", [path.name for path in run.iterdir()])

    def test_crack_paths_are_parted_by_tips(self):
        rows = ["tip [-],time [s],x [m],y [m]", "1,0,0.5,0", "2,0,0.5,0", "1,1e-6,0.6,0.1", "2,2e-6,0.7,-0.1"]
        (self.scratch / "crack_path.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        paths = pdxtools.read_crack_paths(self.scratch)
        self.assertEqual({tip: path["x"].tolist() for tip, path in paths.items()}, {1: [0.5, 0.6], 2: [0.5, 0.7]})
        self.assertEqual(paths[2]["time"].tolist(), [0.0, 2e-6])


if __name__ == "__main__":
    program.main()
