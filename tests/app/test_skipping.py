"""What a scene does not need, it does not pay for: seen in the events and files a run leaves.

Usage: test_skipping.py PDXSOLVE [unittest arguments].
"""

import program
from program import PATCH, SMALL, SMALL_PATCH

ALL_PARTICLES = SMALL | {"-mesh_cells": None, "-pd_patches": "all", "-pd_spacing": "0.05"}
NOTCH = {"-crack_names": "notch", "-crack_notch_points": "0.5,0.5,1,0.5"}  # from the loaded side to the middle
CUT_ELEMENTS = SMALL | {"-mesh_cells": "5,5", "-crack_names": "cut", "-crack_cut_points": "0,0.5,1,0.5"}
CUT_BOTH = PATCH | NOTCH | {"-mesh_cells": "20,15", "-pd_patches": "0.3,0.3333333333333333,0.7,0.6666666666666667",
                            "-pd_spacing": "0.016666666666666667"}
NEVER = {"-material_toughness": "1e12"}  # [J/m^2] nothing reaches it


def of_room(events, room):
    return [name for name in events if name.startswith(room + "_")]


class Rooms(program.ProgramTest):
    def test_elements_only_run_neither_bonds_nor_coupling_nor_output(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                events = self.solve(SMALL, ranks).events
                self.assertEqual([of_room(events, room) for room in ("pd", "couple", "xfem", "io")], [[], [], [], []])
                self.assertTrue(of_room(events, "fe"))

    def test_particles_only_run_neither_elements_nor_coupling(self):
        events = self.solve(ALL_PARTICLES).events
        self.assertEqual([of_room(events, room) for room in ("fe", "couple")], [[], []])
        self.assertTrue(of_room(events, "pd"))

    def test_coupled_scene_runs_all_three(self):
        events = self.solve(SMALL_PATCH).events
        for room in ("fe", "pd", "couple"):
            self.assertTrue(of_room(events, room), room)

    def test_reference_solution_is_not_counted(self):
        plain = self.solve(SMALL_PATCH)
        compared = self.solve(SMALL_PATCH | {"-post_reference_fe": ""})
        self.assertEqual(plain.events, compared.events)
        self.assertIn("max_relative_error_percent", compared.summary["results"])
        self.assertNotIn("max_relative_error_percent", plain.summary["results"])


class Cracks(program.ProgramTest):
    def test_scene_without_cracks_and_toughness_neither_cuts_nor_breaks(self):
        for base in (SMALL, SMALL_PATCH, ALL_PARTICLES):
            with self.subTest(patches=base.get("-pd_patches")):
                events = self.solve(base).events
                self.assertEqual(of_room(events, "xfem"), [])
                self.assertEqual({"pd_cut", "pd_break"} & events.keys(), set())

    def test_crack_in_elements_only_runs_no_bonds(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.solve(CUT_ELEMENTS, ranks)
                self.assertEqual([of_room(run.events, room) for room in ("pd", "couple")], [[], []])
                self.assertTrue(of_room(run.events, "xfem"))

    def test_crack_inside_a_patch_cuts_bonds_once_and_no_elements(self):
        inside = {"-crack_names": "slit", "-crack_slit_points": "0.4,0.5,0.6,0.5"}
        events = self.solve(PATCH | inside).events
        self.assertEqual(of_room(events, "xfem"), [])
        self.assertEqual(events["pd_cut"], 1)
        self.assertNotIn("pd_break", events)

    def test_crack_into_a_patch_runs_both(self):
        events = self.solve(CUT_BOTH).events
        self.assertTrue(of_room(events, "xfem"))
        self.assertEqual(events["pd_cut"], 1)


class Files(program.ProgramTest):
    def test_each_output_option_adds_its_own_files_only(self):
        history, fields = {"-output_history": ""}, {"-output_fields": ""}
        rows = [
            ({}, ["summary.json"]),
            (history, ["history.csv", "summary.json"]),
            (fields, ["fields.h5", "fields.xdmf", "summary.json"]),
            (history | fields, ["fields.h5", "fields.xdmf", "history.csv", "summary.json"]),
        ]
        for options, files in rows:
            for base in (SMALL, SMALL_PATCH):
                with self.subTest(options=list(options), patch="-pd_patches" in base):
                    self.assertEqual(self.solve(base | options).files, files)


class Work(program.ProgramTest):
    def assert_work(self, run, **expected):
        self.assertEqual({key: run.summary[key] for key in expected}, expected)

    def test_linear_scene_is_one_linear_solve_with_one_tangent(self):
        for base in (SMALL, SMALL_PATCH, ALL_PARTICLES):
            with self.subTest(patches=base.get("-pd_patches")):
                run = self.solve(base | {"-ksp_converged_reason": ""})
                self.assert_work(run, steps=1, newton_iterations=1, jacobian_assemblies=1, factorizations=1)
                self.assertEqual(run.out.count("Linear solve converged"), 1)

    def test_linear_scene_in_three_steps_keeps_its_tangent(self):
        for base in (SMALL, SMALL_PATCH):
            with self.subTest(patches=base.get("-pd_patches")):
                run = self.solve(base | {"-load_steps": "3", "-output_history": ""})
                self.assert_work(run, steps=3, newton_iterations=3, jacobian_assemblies=1, factorizations=1)
                self.assertEqual(run.events["solve_jacobian"], 1)
                self.assert_linear_response(run.history())

    def test_cracks_leave_a_linear_scene_linear(self):
        for base in (CUT_ELEMENTS, CUT_BOTH):
            with self.subTest(patches=base.get("-pd_patches")):
                run = self.solve(base | {"-load_steps": "3"})
                self.assert_work(run, steps=3, newton_iterations=3, jacobian_assemblies=1, factorizations=1)

    def test_toughness_that_nothing_reaches_costs_one_look_for_each_solve(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.solve(CUT_BOTH | NEVER | {"-load_steps": "4"}, ranks)
                self.assert_work(run, steps=4, newton_iterations=4, jacobian_assemblies=1, factorizations=1)
                self.assertEqual(run.events["pd_break"], 4)
                self.assertEqual(run.events["solve_jacobian"], 1)
                self.assertEqual(run.summary["bonds_broken"], 0)

    def assert_linear_response(self, rows):
        """Energies grow with the square of the load, reactions with the load; forces on the unit square balance."""
        self.assertEqual([row["load"] for row in rows], [1 / 3, 2 / 3, 1.0])
        full = rows[-1]
        for row in rows:
            for name, value in row.items():
                power = 2 if name.startswith("energy") else 1 if name.startswith("reaction") else None
                if power and full[name]:
                    self.assertAlmostEqual(value / full[name], row["load"] ** power, delta=1e-8, msg=name)
            self.assertAlmostEqual(row["reaction_clamp_x"], -1e6 * row["load"], delta=1e-2)
            self.assertAlmostEqual(row["reaction_clamp_y"], -1e6 * row["load"], delta=1e-2)

    def test_finite_kinematics_iterate_and_renew_the_tangent(self):
        for base in (SMALL, SMALL_PATCH):
            with self.subTest(patches=base.get("-pd_patches")):
                run = self.solve(base | {"-kinematics": "finite"})
                summary = run.summary
                self.assertGreater(summary["newton_iterations"], 1)
                self.assertLess(summary["newton_iterations"], 8)
                self.assertEqual(summary["jacobian_assemblies"], summary["newton_iterations"])

    def test_papers_kinematics_of_elements_alone_are_linear(self):
        self.assert_work(self.solve(SMALL | {"-kinematics": "mixed"}), newton_iterations=1, jacobian_assemblies=1)


if __name__ == "__main__":
    program.main()
