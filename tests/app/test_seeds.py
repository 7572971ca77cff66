"""Patches that -adapt_seed tip puts at the tips of cracks, and runs with them."""

import math
import re

import gmsh_files
import program
from torn import checkpoint, results

import numpy as np

# Elements, and a crack in their middle that runs to both sides.
CRACK = {
    "-options_file": "cases/central_crack/plate.opts",
    "-mesh_cells": "25,25",
    "-pd_spacing": "5e-4",
    "-pd_critical_stretch": "0.02",
    "-bc_names": "top,bottom",
    "-bc_top_on": "top",
    "-bc_top_velocity": "free,20",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_velocity": "free,-20",
    "-ts_dt": "4e-8",
    "-ts_max_time": "1.2e-5",
    "-quiet": "",
}
SEED = {"-adapt_seed": "tip"}
# In statics, without fracture: one load.
SQUARE = program.PULLED | {"-mesh_lower": "0,0", "-mesh_upper": "1,1", "-mesh_cells": "20,20", "-pd_spacing": "0.0125",
                           "-crack_names": "a", "-crack_a_points": "0,0.5,0.5,0.5"}
CELL = 0.05
SMALL = SQUARE | SEED | {"-adapt_expansion_length": "0.09"}


def crack(x0, y0, x1, y1):
    return {"-crack_a_points": f"{x0},{y0},{x1},{y1}"}


class Seeds(program.ProgramTest):
    def seeded(self, options, ranks=1):
        """The boxes where a scene has its patches."""
        return self.solve(options, ranks).summary["results"]["seeded_patches"]

    def assert_boxes(self, boxes, *expected):
        np.testing.assert_allclose(boxes, expected, atol=1e-12)

    def assert_same_as_given(self, options, ranks):
        """A scene is what it would be with the same boxes from the user, to the last bit."""
        seeded = self.solve(options | SEED | {"-output_history": ""}, ranks)
        boxes = seeded.summary["results"]["seeded_patches"]
        text = ",".join(repr(x) for box in boxes for x in box)
        if "-adapt" not in options:
            options = options | {"-adapt_expansion_length": None}
        given = self.solve(options | {"-pd_patches": text, "-output_history": ""}, ranks)
        a, b = results(seeded), results(given)
        a[0].pop("seeded_patches")
        a[0].pop("solve_seconds", None), b[0].pop("solve_seconds", None)
        self.assertEqual(a, b)
        self.assertEqual(seeded.summary["unknowns"], given.summary["unknowns"])
        self.assertEqual(seeded.summary["relocations"], given.summary["relocations"])
        for name in ("history.csv", "crack_path.csv"):
            if name in given.files:
                self.assertEqual((seeded.directory / name).read_bytes(), (given.directory / name).read_bytes(), name)
        return seeded

    def test_explicit_runs_are_those_of_the_same_boxes(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.assert_same_as_given(CRACK | {"-adapt": "expand"}, ranks)
                self.assertGreater(run.summary["relocations"], 0)
                self.assertGreater(run.summary["bonds_broken"], 100)

    def test_fixed_patches_are_those_of_the_same_boxes(self):
        short = CRACK | {"-mesh_cells": "49,49", "-pd_spacing": repr(0.05 / 49 / 4), "-ts_dt": None, "-ts_max_time": "2e-6",
                         "-crack_crack_points": "-0.0105,0.0005,0.0105,0.0005"}
        for change in ({}, {"-mesh_lower": "0.075,0.375", "-mesh_upper": "0.125,0.425",
                            "-crack_crack_points": "0.0895,0.4005,0.1105,0.4005"}):
            with self.subTest(change):
                self.assertEqual(len(self.assert_same_as_given(short | change, 1).summary["results"]["seeded_patches"]), 2)

    def test_loads_and_implicit_steps_are_those_of_the_same_boxes(self):
        static = SQUARE | {"-material_toughness": "300", "-load_steps": "3", "-bc_t_displacement": "0,3e-3"}
        implicit = SQUARE | {"-analysis": "implicit", "-material_density": "1000", "-ts_dt": "1e-5", "-ts_max_steps": "3",
                             "-adapt_expansion_length": "0.12"}
        for options in (static | {"-adapt": "expand"}, implicit):
            for ranks in (1, 2):
                with self.subTest(analysis=options.get("-analysis"), ranks=ranks):
                    self.assert_same_as_given(options, ranks)

    def test_two_lines_make_a_scene(self):
        scene = CRACK | {"-pd_spacing": None, "-adapt": "expand"} | SEED
        for ranks in (1, 2, 3):
            with self.subTest(ranks=ranks):
                run = self.launch({key: value for key, value in scene.items() if key != "-quiet"}, ranks)
                self.assertEqual((run.status, run.err), (0, ""))
                self.assertRegex(run.out, r"-adapt_seed tip: -pd_patches .* -pd_spacing 0\.0005, chosen")
                self.assertGreater(run.summary["bonds_broken"], 100)
                self.assertGreater(run.summary["relocations"], 0)
                tips = run.summary["results"]["crack_tips"]
                self.assertAlmostEqual(tips[0][0], -tips[1][0], delta=1e-9)
                self.assertGreater(tips[1][0], 0.008)

    def test_the_length_is_that_of_expansion(self):
        # 4 horizons of 4 spacings, or 7, over a quarter of an element: 4 and 7 elements beside that of the tip
        middle = SQUARE | SEED | crack(0.0, 0.525, 0.525, 0.525)
        self.assert_boxes(self.seeded(middle), [0.3, 0.3, 0.75, 0.75])
        in_time = {"-analysis": "explicit", "-material_density": "1000", "-ts_max_steps": "2"}
        self.assert_boxes(self.seeded(middle | in_time), [0.15, 0.15, 0.9, 0.9])
        self.assert_boxes(self.seeded(middle | {"-pd_horizon_ratio": "3"}), [0.35, 0.35, 0.7, 0.7])
        self.assert_boxes(self.seeded(middle | {"-adapt_expansion_length": "0.01"}), [0.5, 0.5, 0.55, 0.55])

    def test_a_tip_on_a_node_on_an_edge_and_in_an_element(self):
        self.assert_boxes(self.seeded(SMALL), [0.4, 0.4, 0.6, 0.6])
        self.assert_boxes(self.seeded(SMALL | crack(0, 0.52, 0.5, 0.52)), [0.4, 0.4, 0.6, 0.65])
        self.assert_boxes(self.seeded(SMALL | crack(0, 0.53, 0.51, 0.53)), [0.4, 0.4, 0.6, 0.65])
        third = "0.333333333333333,0.333333333333333"  # a node to rounding
        self.assert_boxes(self.seeded(SMALL | {"-mesh_cells": "3,3", "-pd_spacing": None, "-adapt_expansion_length": "1e-6",
                                               "-crack_a_points": f"0,0.333333333333333,{third}"}), [0, 0, 2 / 3, 2 / 3])

    def test_a_tip_next_to_a_corner_of_the_body(self):
        for ranks in (1, 2):
            self.assert_boxes(self.seeded(SMALL | crack(0.9, 1, 0.98, 0.97), ranks), [0.85, 0.85, 1, 1])

    def test_a_patch_as_large_as_the_body(self):
        self.assert_boxes(self.seeded(SMALL | {"-adapt_expansion_length": "9"}), [0, 0, 1, 1])

    def test_tips_near_each_other_have_one_patch(self):
        inside = SMALL | {"-pd_spacing": "0.025"}
        apart = self.solve(inside | crack(0.3, 0.5, 0.7, 0.5))
        self.assertEqual(len(apart.summary["results"]["seeded_patches"]), 2)
        self.assert_boxes(self.seeded(inside | crack(0.4, 0.5, 0.6, 0.5)), [0.3, 0.4, 0.7, 0.6])  # they touch
        self.assert_boxes(self.seeded(inside | crack(0.45, 0.5, 0.55, 0.5)), [0.35, 0.4, 0.65, 0.6])
        self.assert_boxes(self.seeded(inside | crack(0.51, 0.52, 0.54, 0.53)), [0.4, 0.4, 0.65, 0.65])
        slanted = self.solve(inside | crack(0.45, 0.45, 0.55, 0.6))  # a shape of several boxes, no particle twice
        area = sum((x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in slanted.summary["results"]["seeded_patches"])
        self.assertEqual(slanted.summary["unknowns"]["pd"], 2 * round(area / 0.025**2))
        self.assertAlmostEqual(area, 2 * 0.2**2 - 0.1 * 0.05, delta=1e-12)

    def test_a_mirrored_scene_has_mirrored_boxes(self):
        for points in ((0.21, 0.52, 0.66, 0.57), (0, 0.5, 0.35, 0.5), (0.3, 0.3, 0.45, 0.6)):
            with self.subTest(points):
                x0, y0, x1, y1 = points
                for scene in (SMALL, SMALL | {"-mesh_cells": "21,14", "-pd_spacing": None}):
                    expected = self.seeded(scene | crack(*points))
                    over = self.seeded(scene | crack(1 - x0, y0, 1 - x1, y1))
                    self.assertEqual(sorted(np.round([(1 - b[2], b[1], 1 - b[0], b[3]) for b in over], 10).tolist()),
                                     sorted(np.round(expected, 10).tolist()))

    def test_elements_of_two_sides_take_a_spacing_that_divides_both(self):
        run = self.launch({key: value for key, value in (SMALL | {"-mesh_cells": "20,30", "-pd_spacing": None}).items()
                           if key != "-quiet"})
        self.assertEqual((run.status, run.err), (0, ""))
        spacing = float(re.search(r"-pd_spacing ([0-9.e-]+)", run.out).group(1))
        self.assertAlmostEqual(spacing, 1 / 120, delta=1e-9)

    def test_a_mesh_from_a_file(self):
        square = gmsh_files.Square(20)
        path = square.write(self.scratch / "plate.msh")
        from_file = SMALL | {"-mesh_lower": None, "-mesh_upper": None, "-mesh_cells": None, "-mesh_file": path}
        for ranks in (1, 2):
            self.assert_boxes(self.seeded(from_file, ranks), [0.4, 0.4, 0.6, 0.6])
        self.assert_same_as_given({key: value for key, value in from_file.items() if key != "-adapt_seed"}
                                  | {"-adapt_expansion_length": None}, 2)
        square.points = [(x + 0.01 * (math.isclose(x, 0.6) and math.isclose(y, 0.45)), y) for x, y in square.points]
        bent = from_file | {"-mesh_file": square.write(self.scratch / "bent.msh")}
        self.assert_boxes(self.seeded(bent), [0.4, 0.4, 0.55, 0.6])  # its elements stay
        run = self.launch(bent | crack(0, 0.48, 0.57, 0.48))
        self.assertEqual(run.status, 1)
        self.assertRegex(run.err, r"-adapt_seed tip: at the tip \(0\.57, 0\.48\) of crack 1 an element is no box")

    def test_only_ends_inside_the_body_are_tips(self):
        self.assertEqual(len(self.seeded(SMALL | {"-crack_names": "a,b", "-crack_b_points": "0,0.81,1,0.9"})), 1)
        square = gmsh_files.Square(20)
        hole = [k for k, cell in enumerate(square.cells)  # from (0.5, 0.45) to (0.6, 0.55)
                if all(0.49 < square.points[v - 1][0] < 0.61 and 0.44 < square.points[v - 1][1] < 0.56 for v in cell)]
        square.cells = [cell for k, cell in enumerate(square.cells) if k not in hole]
        used = sorted({v for cell in square.cells for v in cell})
        square.points, number = [square.points[v - 1] for v in used], {v: k + 1 for k, v in enumerate(used)}
        square.cells = [tuple(number[v] for v in cell) for cell in square.cells]
        square.lines = [(name, number[a], number[b]) for name, a, b in square.lines]
        path = square.write(self.scratch / "hole.msh")
        run = self.launch(SMALL | {"-mesh_lower": None, "-mesh_upper": None, "-mesh_cells": None, "-mesh_file": path})
        self.assertEqual(run.status, 1)
        self.assertRegex(run.err, "-adapt_seed tip: no crack ends inside the body")

    def test_a_restart_goes_on(self):
        whole = CRACK | SEED | {"-adapt": "expand", "-ts_dt": None, "-ts_max_time": None, "-ts_max_steps": "300"}
        directory = self.scratch / "half"
        self.solve(whole | {"-checkpoint_interval": "200", "-ts_max_steps": "200"}, directory=directory)
        rest = self.solve(whole | {"-restart": str(directory / "checkpoint.h5"), "-checkpoint_interval": "300"})
        through = self.solve(whole | {"-checkpoint_interval": "300"})
        a, b = checkpoint(rest.directory)[0], checkpoint(through.directory)[0]
        for name, table in a.items():
            np.testing.assert_array_equal(table, b[name], name)

    def test_without_it_cracks_stay_in_elements(self):
        run = self.launch({key: value for key, value in SQUARE.items() if key != "-pd_spacing"})
        self.assertEqual(run.status, 0)
        self.assertEqual(run.summary["unknowns"]["pd"], 0)
        self.assertNotIn("seeded_patches", run.summary["results"])


if __name__ == "__main__":
    program.main()
