"""Solver options are PETSc's and are honoured; choices of solver change the cost, never the answer.

Usage: test_solver_options.py PDXSOLVE [unittest arguments].
"""

import itertools
import json
import re

import program  # finds scripts/ for the next line
import pdxtools
from program import PATCH, SMALL, SMALL_PATCH

FIELDS = {"-output_fields": ""}
# A notched strip, torn by loads of which some are given up after its patch has grown.
TORN = {"-case": "torn", "-mesh_lower": "0,0", "-mesh_upper": "0.05,0.02", "-mesh_cells": "10,4", "-material_young": "1e9",
        "-material_toughness": "50", "-pd_patches": "0.02,0,0.03,0.02", "-pd_spacing": "1.25e-3", "-crack_names": "notch",
        "-crack_notch_points": "0.025,0,0.025,0.01", "-bc_names": "left,bottom,right", "-bc_left_on": "left",
        "-bc_left_displacement": "0,free", "-bc_bottom_on": "bottom", "-bc_bottom_displacement": "free,0", "-bc_right_on": "right",
        "-bc_right_displacement": "2e-4,free", "-load_steps": "3", "-adapt": "expand", "-output_history": "", "-quiet": ""}
KINEMATICS = ("small", "finite", "mixed")
SCHEMES = ("energy", "ghost", "interface")

SUMMARY_KEYS = {
    "case", "version", "petsc_version", "ranks", "status", "wall_seconds", "unknowns", "steps", "newton_iterations",
    "linear_iterations", "jacobian_assemblies", "factorizations", "bonds_broken", "relocations", "events", "results",
}  # fmt: skip
SECONDS_KEYS = {"total", "setup", "solve", "output"}
UNKNOWNS_KEYS = {"fe", "enriched", "pd", "ghost", "mpm", "total"}


def options_of(text):
    """{"-pc_type": "lu"} of "-pc_type lu"."""
    words = text.split()
    options, k = {}, 0
    while k < len(words):
        has_value = k + 1 < len(words) and not words[k + 1].startswith("-")
        options[words[k]] = words[k + 1] if has_value else ""
        k += 2 if has_value else 1
    return options


class SameAnswer(program.ProgramTest):
    def assert_same_answer(self, rows, base=PATCH):
        """rows: (options, ranks, type of matrix the outer solver must see). A tight tolerance, so that the difference
        is that of the operators."""
        tight = {"-ksp_rtol": "1e-12"} | FIELDS
        first = self.solve(base | tight)
        for text, ranks, matrix in rows:
            with self.subTest(options=text, ranks=ranks):
                run = self.solve(base | tight | options_of(text) | {"-ksp_view": ""}, ranks)
                self.assertEqual(self.outer_matrix(run.out), matrix)
                self.assert_same_displacement(first, run)

    def outer_matrix(self, view):
        """The matrix of the outermost solver: the last unindented one of -ksp_view."""
        return re.findall(r"^  Mat Object:.*\n +type: (\w+)", view, re.MULTILINE)[-1]

    def test_simple_preconditioners_stay_matrix_free(self):
        self.assert_same_answer(
            [("-pc_type jacobi", 1, "shell"), ("-pc_type pbjacobi", 2, "shell"), ("-pc_type none", 1, "shell")]
        )

    def test_preconditioners_that_need_a_matrix_get_one(self):
        self.assert_same_answer(
            [
                ("-pc_type hypre", 2, "mpiaij"),
                ("-pc_type gamg", 1, "seqaij"),
                ("-pc_type lu", 1, "seqaij"),
                ("-pd_operator assembled", 1, "seqaij"),
                ("-pd_operator assembled -pc_type gamg", 2, "mpiaij"),
                ("-pd_operator assembled -pc_type cholesky", 1, "seqaij"),
                ("-pc_type cholesky -pc_factor_mat_solver_type mumps", 2, "mpiaij"),
            ]
        )

    def test_elements_only_take_any_preconditioner(self):
        rows = [("-pc_type gamg", 2, "mpiaij"), ("-pc_type lu", 1, "seqaij"), ("-pc_type none", 1, "seqaij")]
        self.assert_same_answer(rows, base=program.PLATE)

    def test_bonds_that_are_whole_again_have_places_in_a_matrix(self):
        free, rows = [self.solve(TORN | {"-pd_operator": operator}, ranks).history() for operator, ranks in
                      (("matrix_free", 1), ("assembled", 2))]
        self.assertGreater(free[-1]["relocations"], 0)
        self.assertEqual([row["bonds_broken"] for row in rows], [row["bonds_broken"] for row in free])
        most = max(row["work"] for row in free)
        for a, b in zip(rows, free):
            self.assertAlmostEqual(a["energy_bonds"], b["energy_bonds"], delta=1e-6 * most)

    def test_finite_difference_operator(self):
        for base, ranks in ((SMALL_PATCH, 1), (SMALL_PATCH | {"-kinematics": "finite"}, 2)):
            with self.subTest(kinematics=base.get("-kinematics", "small")):
                exact = self.solve(base | FIELDS, ranks)
                differences = self.solve(base | FIELDS | options_of("-snes_mf_operator -ksp_rtol 1e-8"), ranks)
                self.assert_same_displacement(exact, differences, 1e-6)

    def test_operator_is_refused_where_it_cannot_serve(self):
        run = self.launch(SMALL_PATCH | options_of("-pd_operator matrix_free -pc_type lu"))
        self.assertEqual(run.status, 1)
        self.assertRegex(run.err, r"^error: -pc_type lu .*-pd_operator.*assembled")


class Tangents(program.ProgramTest):
    def ratios(self, options):
        run = self.launch(options | {"-snes_test_jacobian": ""})
        self.assertEqual((run.status, run.err), (0, ""))
        return [float(ratio) for ratio in re.findall(r"\|\|J - Jfd\|\|_F/\|\|J\|\|_F = (\S+),", run.out)]

    def test_tangents_are_the_residuals_derivatives(self):
        """The steps of the differences are 1e-8 m, so strains of 1e-7: their own error is some 1e-8 there."""
        operators = ("matrix_free", "assembled")
        choices = list(itertools.product(KINEMATICS, SCHEMES, operators))
        scenes = [
            SMALL_PATCH | {"-kinematics": kinematics, "-couple_scheme": scheme, "-pd_operator": operator}
            for kinematics, scheme, operator in choices
        ]
        for choice, ratios in zip(choices, program.in_pairs(self.ratios, scenes)):
            with self.subTest(choice=choice):
                self.assertGreaterEqual(len(ratios), 2 if choice[0] != "small" else 1)
                self.assertLess(max(ratios), 1e-6 if choice[0] != "small" else 1e-10)


class PetscOptions(program.ProgramTest):
    def test_monitors_print(self):
        run = self.solve(SMALL_PATCH | options_of("-ksp_monitor -snes_monitor -snes_converged_reason"))
        self.assertEqual(run.out.count("KSP Residual norm"), run.summary["linear_iterations"] + 1)
        self.assertEqual(run.out.count("SNES Function norm"), 2)
        self.assertIn("Nonlinear solve converged", run.out)

    def test_log_shows_our_events(self):
        run = self.solve(SMALL_PATCH | {"-log_view": ""}, 2)
        for event in ("fe_jacobian", "pd_tangent", "couple_force", "solve_load"):
            self.assertRegex(run.out, rf"(?m)^{event}\s+\d")

    def test_options_of_the_levels_are_honoured(self):
        view = self.solve(SMALL_PATCH | {"-ksp_view": ""}).out
        self.assertRegex(view, r"\(mg_levels_1_\)[^:]*\n *type: chebyshev\n(.*\n)*? *maximum iterations=2,")
        self.assertRegex(view, r"PC Object: \(mg_coarse_\).*\n *type: hypre")
        view = self.solve(SMALL_PATCH | options_of("-mg_levels_ksp_max_it 3 -mg_coarse_pc_type gamg -ksp_view")).out
        self.assertRegex(view, r"\(mg_levels_1_\)[^:]*\n *type: chebyshev\n(.*\n)*? *maximum iterations=3,")
        self.assertRegex(view, r"PC Object: \(mg_coarse_\).*\n *type: gamg")

    def test_krylov_method_follows_the_symmetry_of_the_scheme(self):
        for scheme, method in (("energy", "cg"), ("ghost", "cg"), ("interface", "gmres")):
            with self.subTest(scheme=scheme):
                view = self.solve(SMALL_PATCH | {"-couple_scheme": scheme, "-ksp_view": ""}).out
                self.assertRegex(view, rf"^KSP Object:.*\n *type: {method}\n")


class Failure(program.ProgramTest):
    def test_impossible_solver_ends_with_status_2_and_one_line_of_advice(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.launch(PATCH | options_of("-ksp_max_it 2 -load_steps 2"), ranks)
                lines = [line for line in run.err.splitlines() if line.strip()]
                self.assertEqual((run.status, len(lines)), (2, 1), run.err)
                self.assertRegex(lines[0], r"^error: load step 1 of 2 .*tolerance after 2 iterations.*-ksp_max_it")
                summary = run.summary
                self.assertEqual((summary["status"], summary["steps"], summary["ranks"]), ("failed", 0, ranks))
                self.assertIn(summary["message"], lines[0])

    def test_steps_before_the_failure_stay_on_disk(self):
        """A bar of St Venant-Kirchhoff material with Poisson's ratio 0 bears no more compression than E / sqrt(27) =
        1.92e8 Pa of its first area, and less before it gives way sideways: half of 2.2e8 Pa has an equilibrium, all of
        it has none. The second increment is tried by halves, down to 1/128 of the load."""
        squeeze = {"-material_poisson": "0", "-kinematics": "finite", "-bc_load_traction": "-2.2e8,0"}
        run = self.launch(SMALL | squeeze | FIELDS | options_of("-load_steps 2 -output_history"), 2)
        self.assertEqual((run.status, run.summary["status"]), (2, "failed"))
        self.assertRegex(run.err, r"^error: load step 2 of 2 .*not positive definite.*-load_steps")
        self.assertNotIn("unstable growth", run.err)  # nothing broke
        failed = float(re.search(r"failed at load (\S+) ", run.err)[1])
        loads = [row["load"] for row in run.history()]
        self.assertEqual(loads[0], 0.5)
        self.assertEqual(loads, sorted(set(loads)))
        self.assertAlmostEqual(failed - loads[-1], 1 / 128, delta=1e-6)
        self.assertLess(loads[-1], 0.8748)
        self.assertAlmostEqual(run.history()[0]["reaction_clamp_x"], 1.1e8, delta=1.0)
        self.assertEqual(pdxtools.step_count(run.directory), len(loads))
        self.assertEqual(run.summary["steps"], len(loads))
        self.assertEqual(run.summary["results"]["load_steps_accepted"], len(loads))
        self.assertGreaterEqual(run.summary["results"]["halvings"], 6)


class Contract(program.ProgramTest):
    def test_summary_lists_the_solves(self):
        torn = {"-pd_critical_stretch": "1e-3", "-load_steps": "4", "-pd_no_fail": "0,0,1,0.6", "-bc_load_traction": None,
                "-bc_load_displacement": "1.3e-3,0", "-load_broken_share": "1"}
        for options in (SMALL_PATCH, SMALL_PATCH | torn):
            summary = self.solve(options).summary
            results = summary["results"]
            iterations = results["solve_iterations"]
            self.assertEqual(sum(iterations["list"]), summary["linear_iterations"])
            self.assertEqual(max(iterations["list"]), iterations["max"])
            self.assertAlmostEqual(iterations["mean"] * results["passes"], summary["linear_iterations"])
        self.assertEqual(sum(results["solve_bonds_broken"]["list"]), summary["bonds_broken"])
        self.assertGreater(summary["bonds_broken"], 0)
        self.assertAlmostEqual(sum(results["solve_seconds"]["list"]), summary["wall_seconds"]["solve"])

    def test_summary_has_the_keys_of_the_contract(self):
        for options, status in ((SMALL, 0), (SMALL_PATCH, 0), (PATCH | {"-ksp_max_it": "2"}, 2)):
            run = self.launch(options)
            with self.subTest(status=status, patch="-pd_patches" in options):
                summary = run.summary
                self.assertEqual(run.status, status)
                self.assertEqual(SUMMARY_KEYS - summary.keys(), set())
                self.assertEqual(summary["wall_seconds"].keys(), SECONDS_KEYS)
                self.assertEqual(summary["unknowns"].keys(), UNKNOWNS_KEYS)
                self.assertEqual(summary["status"], "failed" if status else "done")

    def test_unknowns_are_rows_times_dimension(self):
        """20 x 20 elements have 441 nodes, 7 x 7 of them inside the patch of 8 x 8 elements and 16 x 16 particles."""
        unknowns = self.solve(PATCH, 2).summary["unknowns"]
        self.assertEqual((unknowns["fe"], unknowns["pd"]), (2 * (441 - 49), 2 * 256))
        self.assertEqual(unknowns["total"], unknowns["fe"] + unknowns["pd"])

    def test_help_lists_options_by_room_and_stops(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.launch({"-help": ""}, ranks)
                self.assertEqual((run.status, run.err, run.directory.exists()), (0, "", False))
                for room in ("scene", "mesh", "material", "pd", "couple", "bc", "output"):
                    self.assertRegex(run.out, rf"(?m)^{room}$")
                self.assertRegex(run.out, r"-material_young .*\[Pa\]\n *default none; above 0")
                self.assertRegex(run.out, r"-couple_scheme .*\n *default energy; energy, ghost, interface")
                self.assertEqual(run.out.count("\n  -material_young "), 1)

    def test_help_searches_and_is_there_as_json(self):
        found = self.launch({"-help": "Horizon bond", "-output_dir": None})
        self.assertEqual((found.status, found.err), (0, ""))
        for name, there in (("-bc_NAME_layer", False), ("-adapt_critical_length", True), ("-material_young", False)):
            self.assertEqual(f"  {name} " in found.out, there, name)
        none = self.launch({"-help": "nosuchword", "-output_dir": None})
        self.assertEqual(none.status, 1)
        self.assertRegex(none.err, r"^error: -help nosuchword: no option has that in its name or text\n$")
        listed = json.loads(program.finish([program.PROGRAM, "-help", "-json"], program.ROOT)[1])
        young = [option for option in listed if option["name"] == "-material_young"]
        self.assertEqual([(o["room"], o["unit"], o["default"], o["allowed"]) for o in young], [("material", "Pa", "none", "above 0")])
        shown = self.launch({"-help": ""}).out
        self.assertTrue(all(f"  {option['name']} " in shown for option in listed))

    def test_version_names_ours_and_petscs(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.launch({"-version": ""}, ranks)
                self.assertEqual((run.status, run.err, run.directory.exists()), (0, "", False))
                self.assertRegex(run.out, r"^pdxsolve \d+\.\d+\.\d+ .*[Pp][Ee][Tt][Ss][Cc].* \d+\.\d+\.\d+[^\n]*\n$")


if __name__ == "__main__":
    program.main()
