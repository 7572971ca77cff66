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


# 2 x 1 m, a wave at about 1 m/s from the right into 80 x 40 particles in the middle.
WAVE = {
    "-case": "wave",
    "-analysis": "explicit",
    "-mesh_lower": "0,0",
    "-mesh_upper": "2,1",
    "-mesh_cells": "40,20",
    "-material_young": "1",
    "-material_density": "1",
    "-bc_names": "pulse",
    "-bc_pulse_on": "right",
    "-bc_pulse_displacement": "1e-3,free",
    "-bc_pulse_history": "gaussian",
    "-bc_pulse_history_time": "0.3",
    "-bc_pulse_history_width": "0.1",
    "-pd_patches": "0.5,0.25,1.5,0.75",
    "-pd_spacing": "0.0125",
    "-ts_max_time": "0.9",
    "-quiet": "",
}
ALL_FILES = {"-output_history": "", "-output_fields": "", "-output_interval": "20"}


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
        before, wall = compared.summary["results"]["seconds_solved_before"], compared.summary["wall_seconds"]
        self.assertGreater(before, 0)  # a phase of its own, not set-up
        self.assertLess(wall["setup"] + before, wall["total"])
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
                    always = ["citations.bib", "options.opts"]
                    self.assertEqual(self.solve(base | options).files, sorted([*always, *files]))


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


class Time(program.ProgramTest):
    """What explicit steps leave out."""

    def tiles(self, run):
        return [run.summary["results"][f"pd_tiles_{what}"] for what in ("computed", "skipped")]

    def test_bonds_the_wave_has_not_reached_are_skipped_without_changing_a_bit(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                some, every = (self.solve(WAVE | ALL_FILES | {"-pd_skip_tolerance": t}, ranks) for t in ("0", "-1"))
                computed, skipped = self.tiles(some)
                self.assertGreater(skipped, 0)
                self.assertEqual(self.tiles(every), [computed + skipped, 0])
                self.assertEqual(*((run.directory / "history.csv").read_bytes() for run in (some, every)))
                self.assert_same_displacement(some, every, tolerance=0.0)

    def test_a_tolerance_skips_more_and_changes_little(self):
        exact, near = self.solve(WAVE | ALL_FILES), self.solve(WAVE | ALL_FILES | {"-pd_skip_tolerance": "1e-9"})
        self.assertGreater(self.tiles(near)[1], 2 * self.tiles(exact)[1])
        self.assert_same_displacement(exact, near, tolerance=1e-4)

    def test_implicit_steps_count_no_tiles(self):
        run = self.solve(WAVE | {"-analysis": "implicit", "-ts_dt": "0.1", "-ts_max_steps": "2"})
        self.assertNotIn("pd_tiles_computed", run.summary["results"])

    def test_nothing_breaks_without_a_toughness_nor_where_no_bond_is_stretched_enough(self):
        for options in (WAVE, WAVE | NEVER):
            with self.subTest(toughness=options.get("-material_toughness")):
                run = self.solve(options)
                self.assertNotIn("pd_break", run.events)
                self.assertEqual(run.summary["bonds_broken"], 0)

    def test_no_output_asked_none_written(self):
        run = self.solve(WAVE)
        self.assertEqual(of_room(run.events, "io"), [])
        self.assertEqual(run.files, ["citations.bib", "options.opts", "summary.json"])

    def test_elements_only_run_neither_bonds_nor_coupling(self):
        run = self.solve(WAVE | {"-pd_patches": None, "-pd_spacing": None})
        self.assertEqual([of_room(run.events, room) for room in ("pd", "couple", "xfem", "io")], [[], [], [], []])
        self.assertNotIn("pd_tiles_computed", run.summary["results"])


if __name__ == "__main__":
    program.main()
