"""What a scene does not need, it does not pay for: seen in the events and files a run leaves.

Usage: test_skipping.py PDXSOLVE [unittest arguments].
"""

import program
from program import SMALL, SMALL_PATCH

ALL_PARTICLES = SMALL | {"-mesh_cells": None, "-pd_patches": "all", "-pd_spacing": "0.05"}


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
