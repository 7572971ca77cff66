"""Patches that move while cracks grow give what a patch that was large from the start gives."""

import subprocess
import time

import program
from torn import BEAM, TABLES, checkpoint, results

import h5py
import numpy as np

# A plate with a crack in its middle that runs to both sides, in a patch that holds its way, and in one that does not.
LARGE = {"-options_file": "cases/central_crack/smoke.opts", "-quiet": ""}
PLATE = LARGE | {"-pd_patches": "-0.009,-0.005,0.009,0.005", "-adapt": "expand"}
SPACING = 1e-3 / 3
END = {"-checkpoint_interval": "560"}  # of these
# The same with patches that hand back what lies behind the tips.
SNAIL = PLATE | {"-adapt": "relocate", "-output_history": ""}
# Held so that it stretches evenly; cells beside its patch change hands.
EVEN = program.EVEN | {
    "-case": "small",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "8,8",
    "-pd_patches": "0.25,0.25,0.5,0.5",
    "-pd_spacing": "0.03125",
    "-load_steps": "4",
}
# The same plate flying, and one through which a pulse runs.
FLYING = {key: value for key, value in EVEN.items() if not key.startswith(("-bc_", "-load_"))} | {
    "-analysis": "explicit",
    "-material_density": "1000",
    "-ts_max_steps": "200",
    "-bc_names": "all",
    "-bc_all_box": "-1,-1,2,2",
    "-bc_all_initial_velocity": "3,-2",
    "-output_history": "",
}
PULSE = FLYING | {
    "-mesh_cells": "32,8",
    "-mesh_upper": "4,1",
    "-bc_names": "left",
    "-bc_all_box": None,
    "-bc_all_initial_velocity": None,
    "-bc_left_on": "left",
    "-bc_left_traction": "1e6,0",
    "-bc_left_history": "gaussian",
    "-bc_left_history_time": "1.5e-3",
    "-bc_left_history_width": "5e-4",
    "-ts_max_steps": "400",
}
INSIDE = "0.625,0.375,0.875,0.75"
TURNS = {"-layout_renew_interval": "20", "-layout_renew_box": "0.625,0.375,1,0.75"}
# Cells behind a tip of the large patch become elements, and nothing of the crack is left there.
HEALED = LARGE | {"-layout_renew_interval": "440", "-layout_renew_box": "0.008,-0.001,0.012,0.001", "-ts_max_steps": "460"}
# Cells along the crack become elements and particles again, with all that broke in them.
TURNED = LARGE | {"-layout_renew_interval": "60", "-layout_renew_box": "0.007,-0.003,0.015,0.003", "-ts_max_steps": "500"}
SHORT = BEAM | {"-pd_patches": "0.2e-3,0.15e-3,0.4e-3,0.30e-3", "-adapt": "expand"}


# A crack in elements that runs half a plate in a patch that grows.
SEEDED = {
    "-case": "seeded", "-analysis": "explicit", "-mesh_lower": "0,0", "-mesh_upper": "0.1,0.04", "-mesh_cells": "40,16",
    "-material_young": "72e9", "-material_poisson": "0.3333333333333333", "-material_density": "2440", "-pd_spacing": "0.625e-3",
    "-pd_critical_stretch": "1e-3", "-crack_names": "c", "-crack_c_points": "0,0.02,0.03,0.02", "-bc_names": "t,b",
    "-bc_t_on": "top", "-bc_t_traction": "0,20e6", "-bc_b_on": "bottom", "-bc_b_traction": "0,-20e6", "-ts_max_time": "2e-5",
    "-adapt": "expand", "-adapt_seed": "tip", "-adapt_expansion_length": "0.006", "-adapt_critical_length": "0.003",
    "-adapt_every": "5", "-quiet": "",
}  # fmt: skip


class Adapt(program.ProgramTest):
    def test_a_crack_is_as_long_however_seldom_it_is_looked_at(self):
        often = self.launch(SEEDED | {"-output_history_interval": "1"}).summary["results"]
        for ranks in (1, 2):
            seldom = self.launch(SEEDED | {"-output_history_interval": "1000"}, ranks).summary["results"]
            self.assertAlmostEqual(seldom["crack_length"], often["crack_length"], delta=1e-9)
            self.assertAlmostEqual(seldom["max_crack_speed"] / often["max_crack_speed"], 1.0, delta=0.15)

    def test_a_crack_runs_as_in_a_large_patch(self):
        large, grown = self.shared(LARGE), self.shared(PLATE | END)
        self.assertGreaterEqual(grown.summary["relocations"], 2)
        self.assertGreater(large.summary["bonds_broken"], 3000)
        for name in ("adapt_look", "layout_change"):
            self.assertNotIn(name, large.events)
            self.assertIn(name, grown.events)
        self.assertLess(abs(grown.summary["bonds_broken"] / large.summary["bonds_broken"] - 1), 0.02)
        a, b = large.summary["results"], grown.summary["results"]
        self.assertLess(abs(a["crack_length"] - b["crack_length"]), 2 * SPACING)
        work = a["external_work"]
        self.assertLess(abs(b["energy_converted"]), 2e-3 * work)
        self.assertLess(abs(a["fracture_energy"] - b["fracture_energy"]), 0.03 * a["fracture_energy"])
        for row in grown.history():  # what changes took or gave is in the books
            self.assertLess(abs(row["energy_residual"]), 5e-3 * work)

    def test_patches_that_go_along_break_what_a_large_patch_breaks(self):
        large, moved = self.shared(LARGE), self.shared(SNAIL | END)
        for name in ("adapt_look", "adapt_contract", "layout_change"):
            self.assertNotIn(name, large.events)
            self.assertIn(name, moved.events)
        self.assertLess(abs(moved.summary["bonds_broken"] / large.summary["bonds_broken"] - 1), 0.01)
        a, b = large.summary["results"], moved.summary["results"]
        self.assertLess(abs(a["crack_length"] - b["crack_length"]), 2 * SPACING)
        self.assertLess(abs(b["energy_relocated_ratio"]), 5e-3)
        elastic = [results["kinetic_energy"] + results["strain_energy"] for results in (a, b)]
        self.assertLess(abs(elastic[1] / elastic[0] - 1), 5e-3)
        self.assertLess(abs(a["fracture_energy"] - b["fracture_energy"]), 0.03 * a["fracture_energy"])
        rows = moved.history()
        for row in rows:
            self.assertLess(abs(row["energy_residual"]), 2e-3 * a["external_work"])
        self.assertEqual(rows[-1]["relocations"], moved.summary["relocations"])
        self.assertEqual(2 * rows[-1]["particles"], moved.summary["unknowns"]["pd"])
        self.assertTrue(any(x["particles"] > y["particles"] for x, y in zip(rows, rows[1:])), "nothing was handed back")
        self.assertGreater(moved.summary["unknowns"]["enriched"], 24)  # the crack that elements carry

    def test_a_crack_at_the_border_of_a_patch_that_stays_is_told(self):
        held = PLATE | {"-adapt": "none"}
        said = r"a crack came to \(\S+, \S+\), within a horizon of the elements .* -adapt expand"
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                warned = self.launch(held, ranks)
                self.assertEqual(warned.status, 0, warned.err)
                self.assertRegex(warned.err, r"^warning: " + said + r"\n$")
                stopped = self.launch(held | {"-adapt_border": "stop"}, ranks)
                self.assertEqual(stopped.status, 2, stopped.err)
                self.assertRegex(stopped.err, r"^error: " + said + r"\n$")
                self.assertEqual(stopped.summary["status"], "failed")
                self.assertNotIn("adapt_look", warned.events)
        self.assertEqual(self.solve(LARGE | {"-adapt_border": "stop", "-ts_max_steps": "440"}).err, "")
        stopped = self.launch(held | {"-adapt_border": "stop", "-checkpoint_interval": "100000"})
        self.assertEqual(self.launch(held | {"-restart": str(stopped.directory / "checkpoint.h5")}).status, 0)
        beam = self.launch({key: value for key, value in SHORT.items() if key != "-adapt"} | {"-adapt_border": "stop"})
        self.assertEqual(beam.status, 2, beam.err)
        self.assertRegex(beam.err, said)

    def test_cracks_that_run_into_each_other_end_no_run(self):
        for height in ("0", "0.0002"):
            facing = SNAIL | {"-crack_names": "crack,b", "-crack_crack_points": f"-0.012,{height},-0.002,{height}",
                              "-crack_b_points": f"0.002,-{height},0.012,-{height}", "-pd_patches": "-0.017,-0.005,0.017,0.005"}  # fmt: skip
            with self.subTest(height=height):
                one, two = self.solve(facing), self.solve(facing, 2)
                self.assertGreaterEqual(one.summary["relocations"], 3)
                self.assertEqual(one.summary["bonds_broken"], two.summary["bonds_broken"])
                self.assertLess(abs(one.summary["results"]["energy_relocated_ratio"]), 1e-2)

    def test_ranks_break_the_same_bonds_in_patches_that_go_along(self):
        self.break_the_same_bonds(SNAIL)

    def test_ranks_break_the_same_bonds_where_strength_varies(self):
        """Within the patch and beyond its border, wherever that has come to."""
        self.break_the_same_bonds(SNAIL | {"-pd_scatter": "0.1", "-ts_max_steps": "450"}, "450")

    def test_ranks_break_the_same_bonds(self):
        self.break_the_same_bonds(PLATE)

    def break_the_same_bonds(self, options, end=END["-checkpoint_interval"]):
        runs = [self.shared(options | {"-checkpoint_interval": end}, ranks) for ranks in (1, 2, 3)]
        self.assertGreater(runs[0].summary["relocations"], 1)
        tables = [checkpoint(run.directory)[0] for run in runs]
        for run, other in zip(runs[1:], tables[1:]):
            self.assertEqual(run.summary["relocations"], runs[0].summary["relocations"])
            for name in ("gone_bonds", "broken_carried_bonds", "row_names", "layout_patches"):
                np.testing.assert_array_equal(tables[0][name], other[name], name)
            for name in ("displacement", "velocity"):
                self.assertLess(np.abs(tables[0][name] - other[name]).max(), 1e-8 * np.abs(other[name]).max(), name)

    def test_a_restart_goes_on_between_hand_backs(self):
        whole = self.shared(SNAIL | END)
        directory = self.scratch / "half"
        half = SNAIL | {"-checkpoint_interval": "400", "-ts_max_steps": "400"}
        moved = self.solve(half, directory=directory).summary["relocations"]
        self.assertGreaterEqual(moved, 1)
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                rest = self.solve(SNAIL | {"-restart": str(directory / "checkpoint.h5"), "-checkpoint_interval": "560"}, ranks)
                self.assertGreater(whole.summary["relocations"], moved)
                self.assertEqual(whole.summary["relocations"], rest.summary["relocations"])
                tables, others = checkpoint(whole.directory)[0], checkpoint(rest.directory)[0]
                for name in ("gone_bonds", "broken_carried_bonds", "row_names", "layout_patches", "layout_cracks"):
                    np.testing.assert_array_equal(tables[name], others[name], name)

    def test_a_restart_goes_on_from_a_patch_that_moved(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                whole = self.shared(PLATE | END, ranks)
                directory = self.scratch / f"half_{ranks}"
                half = PLATE | {"-checkpoint_interval": "400", "-ts_max_steps": "400"}
                moved = self.solve(half, ranks, directory=directory).summary["relocations"]
                self.assertGreaterEqual(moved, 1)
                rest = self.solve(PLATE | {"-restart": str(directory / "checkpoint.h5"), "-checkpoint_interval": "560"}, ranks)
                self.assertGreater(whole.summary["relocations"], moved)
                self.assertEqual(whole.summary["relocations"], rest.summary["relocations"])
                tables, others = checkpoint(whole.directory)[0], checkpoint(rest.directory)[0]
                for name in ("gone_bonds", "broken_carried_bonds", "row_names", "layout_patches"):
                    np.testing.assert_array_equal(tables[name], others[name], name)
                if ranks > 1:  # it deals out its cells by where the patch is now
                    for name in ("displacement", "velocity"):
                        self.assertLess(np.abs(tables[name] - others[name]).max(), 1e-8 * np.abs(tables[name]).max(), name)
                    continue
                a, b = (results(run)[0] | {"stable_step": None} for run in (whole, rest))  # of the first scene
                self.assertEqual(a, b)
                for name, table in tables.items():
                    np.testing.assert_array_equal(table, others[name], name)

    def assert_goes_on(self, whole, options, ranks, directory):
        """A run goes on from the checkpoint in a directory, and ends with the tables of one that was left alone."""
        end = {"-restart": str(directory / "checkpoint.h5"), "-checkpoint_interval": "500"}
        rest = self.solve(options | end, ranks)
        self.assertEqual(whole.summary["relocations"], rest.summary["relocations"])
        tables, others = checkpoint(whole.directory)[0], checkpoint(rest.directory)[0]
        self.assertEqual(tables.keys(), others.keys())
        for name in tables.keys() - TABLES - {"rank_sums", "crack_damage", "crack_numbers", "crack_arrival_times"}:
            np.testing.assert_array_equal(tables[name], others[name], name)
        for name in TABLES:
            self.assertLess(np.abs(tables[name] - others[name]).max(), 1e-8 * np.abs(tables[name]).max(), name)
        return rest

    def test_a_restart_knows_what_broke_where_elements_are(self):
        whole = {ranks: self.shared(TURNED | {"-checkpoint_interval": "500"}, ranks) for ranks in (1, 2)}
        self.assertEqual(whole[1].summary["relocations"], 8)
        for half, ranks, after in ((420, 1, 1), (480, 2, 3), (440, 1, 2), (440, 2, 1)):  # when cells change, and between
            with self.subTest(half=half, ranks=ranks, after=after):
                directory = self.scratch / f"half_{half}_{ranks}_{after}"
                stop = {"-ts_max_steps": str(half), "-checkpoint_interval": str(half)}
                self.solve(TURNED | stop, ranks, directory)
                if half > 420:
                    tables = checkpoint(directory)[0]
                    self.assertGreater(min(len(tables[f"dormant_{name}"]) for name in ("particles", "gone_bonds")), 50)
                rest = self.assert_goes_on(whole[ranks], TURNED, after, directory)
                if (ranks, after) == (1, 1):
                    self.assertEqual(results(whole[1]), results(rest))

    def test_a_run_that_was_killed_goes_on_across_changes(self):
        whole = self.shared(TURNED | {"-checkpoint_interval": "500"})
        directory = self.scratch / "killed"
        options = TURNED | {"-checkpoint_interval": "25"}
        command = [program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
        for least in (60, 300, 425):  # steps of the checkpoint it is killed behind
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, cwd=program.ROOT)
            while process.poll() is None and self.step_of(directory) < least:
                time.sleep(0.02)
            process.kill()
            process.wait()
            again = ["-restart", str(directory / "checkpoint.h5")]
            command = [program.PROGRAM, *program.words_of(options), "-output_dir", str(directory), *again]
        self.assert_goes_on(whole, TURNED, 2, directory)

    @staticmethod
    def step_of(directory):
        try:
            return checkpoint(directory)[1]["step"]
        except OSError:  # none yet
            return -1

    def test_damage_of_what_is_dormant_is_refused_by_its_name(self):
        directory = self.scratch / "half"
        self.solve(TURNED | {"-ts_max_steps": "450", "-checkpoint_interval": "450"}, 1, directory)
        file = directory / "checkpoint.h5"
        whole = file.read_bytes()
        with h5py.File(file) as tables:
            places = {name: (tables[name].id.get_offset(), tables[name].id.get_storage_size())
                      for name in tables if name.startswith("dormant_")}
        self.assertEqual(len(places), 3)
        for name, (at, size) in places.items():
            if not size:
                continue
            at += size // 2
            file.write_bytes(whole[:at] + bytes([whole[at] ^ 4]) + whole[at + 1 :])
            run = self.launch(TURNED | {"-restart": str(file)})
            self.assertEqual(run.status, 1, run.err)
            self.assertIn(f"dataset /{name} is damaged", run.err)
            self.assertEqual(run.err.count("\n"), 1, run.err)

    def test_a_crack_stays_known_where_its_particles_are_gone(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                whole, healed = self.solve(LARGE | {"-ts_max_steps": "440"}, ranks), self.solve(HEALED, ranks)
                self.assertEqual(healed.summary["relocations"], 1)
                paths = [[(row["x"], row["y"], row["time"]) for row in program.rows_of(run.directory / "crack_path.csv")]
                         for run in (whole, healed)]
                behind = [[at for at in path if 0.008 < at[0] < 0.012] for path in paths]
                self.assertGreater(len(behind[0]), 8)
                self.assertEqual(behind[0], behind[1])
                self.assertGreater(healed.summary["results"]["crack_length"], whole.summary["results"]["crack_length"])

    def test_loads_break_the_same_bonds_in_patches_that_grow_and_go_along(self):
        large, *_ = program.in_pairs(self.shared, (BEAM, SHORT, SHORT | {"-adapt": "relocate"}))
        self.assertGreater(large.summary["bonds_broken"], 1000)
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                grown = self.shared(SHORT, ranks)
                self.assertEqual(large.summary["bonds_broken"], grown.summary["bonds_broken"])
                self.assertGreaterEqual(grown.summary["relocations"], 3)
                for a, b in zip(large.history(), grown.history(), strict=True):  # a column of bonds may go a load earlier
                    self.assertLess(abs(a["bonds_broken"] - b["bonds_broken"]), 10)
                    self.assertLess(abs(a["reaction_top_y"] - b["reaction_top_y"]), 4e-3 * abs(a["reaction_top_y"]))
                    self.assertLess(abs(a["energy_fracture"] - b["energy_fracture"]), 2e-3 * large.history()[-1]["work"])
                moved = self.shared(SHORT | {"-adapt": "relocate"}, ranks)
                column = 36  # bonds; the last may go a load earlier
                self.assertLessEqual(abs(large.summary["bonds_broken"] - moved.summary["bonds_broken"]), column)
                self.assertGreaterEqual(moved.summary["relocations"], 3)
                self.assertLess(moved.summary["unknowns"]["pd"], 0.5 * large.summary["unknowns"]["pd"])
                self.assertGreater(moved.history()[-1]["elements"], large.summary["unknowns"]["fe"] / 2)
                for a, b in zip(large.history(), moved.history(), strict=True):
                    self.assertLessEqual(abs(a["bonds_broken"] - b["bonds_broken"]), column)
                    self.assertLess(abs(a["reaction_top_y"] - b["reaction_top_y"]), 0.02 * abs(a["reaction_top_y"]))
                self.assertLess(abs(moved.summary["results"]["energy_relocated_ratio"]), 2e-2)

    def test_cracks_may_be_followed_by_the_laplacian_of_damage(self):
        # On one rank too in cases/slanted.
        large, moved = self.shared(BEAM), self.solve(SHORT | {"-adapt": "relocate", "-adapt_tracker": "laplacian"}, 2)
        column = 36  # bonds; the last may go a load earlier
        self.assertLessEqual(abs(large.summary["bonds_broken"] - moved.summary["bonds_broken"]), column)
        self.assertGreaterEqual(moved.summary["relocations"], 3)
        self.assertLess(moved.summary["unknowns"]["pd"], 0.5 * large.summary["unknowns"]["pd"])
        self.assertLess(abs(moved.summary["results"]["energy_relocated_ratio"]), 2e-2)

    def test_loads_go_on_where_what_broke_comes_back(self):
        # Bonds break from the fourth load on, whose cells change hands at its end.
        turned = BEAM | {"-bc_top_displacement": "0,0.75e-6", "-bc_bottom_displacement": "0,-0.75e-6", "-load_steps": "5",
                         "-layout_renew_interval": "1", "-layout_renew_box": "0.24e-3,0.19e-3,0.36e-3,0.26e-3"}  # fmt: skip
        for ranks in (1, 2):
            run = self.solve(turned, ranks)
            self.assertEqual(run.summary["relocations"], 4)
            self.assertGreater(run.summary["bonds_broken"], 300)

    def test_a_plate_that_flies_does_not_feel_cells_change_hands(self):
        for ranks in (1, 2, 3):
            with self.subTest(ranks=ranks):
                whole, turned = self.solve(FLYING | {"-output_fields": ""}), self.solve(FLYING | TURNS | {"-output_fields": ""}, ranks)
                self.assertEqual(turned.events["layout_change"], 9)
                self.assertEqual(turned.summary["relocations"], 9)
                kinetic = whole.summary["results"]["kinetic_energy"]
                self.assertAlmostEqual(turned.summary["results"]["kinetic_energy"], kinetic, delta=1e-12 * kinetic)
                self.assertLess(turned.summary["results"]["strain_energy"], 1e-20 * kinetic)
                self.assertLess(abs(turned.summary["results"]["energy_converted"]), 1e-12 * kinetic)

    def test_even_strain_stays_even(self):
        for ranks in (1, 2, 3):
            with self.subTest(ranks=ranks):
                whole, turned = (self.solve(EVEN | {"-output_fields": ""} | more, ranks)
                                 for more in ({}, TURNS | {"-layout_renew_interval": "1", "-layout_renew_box": INSIDE}))
                self.assertEqual(turned.summary["relocations"], 3)
                self.assertGreater(turned.summary["unknowns"]["pd"], 0)
                for name in ("strain_energy", "external_work", "max_displacement_component"):
                    a, b = (run.summary["results"][name] for run in (whole, turned))
                    self.assertAlmostEqual(a, b, delta=1e-9 * abs(a), msg=name)

    def test_a_pulse_runs_through_cells_that_change_hands(self):
        whole, turned = self.solve(PULSE), self.solve(PULSE | TURNS | {"-layout_renew_box": "1,0.25,2,0.75"})
        work = whole.summary["results"]["external_work"]
        self.assertGreater(turned.summary["relocations"], 15)
        self.assertLess(abs(turned.summary["results"]["energy_converted"]), 0.02 * work)
        a, b = whole.history()[-1], turned.history()[-1]
        elastic = [sum(row[f"energy_{of}"] for of in ("elements", "bonds", "interface")) for row in (a, b)]
        self.assertAlmostEqual(*elastic, delta=0.02 * work)

    def test_work_goes_on_where_a_moved_side_becomes_particles(self):
        pulled = EVEN | {"-bc_right_traction": None, "-bc_right_displacement": "1e-3,free", "-output_history": ""}
        whole, turned = (self.solve(pulled | more) for more in
                         ({}, TURNS | {"-layout_renew_interval": "1", "-layout_renew_box": "0.75,0,1,1"}))
        self.assertEqual(turned.summary["relocations"], 3)
        for a, b in zip(whole.history(), turned.history(), strict=True):
            self.assertAlmostEqual(a["work"], b["work"], delta=0.05 * whole.history()[-1]["work"])

    def test_patches_of_two_spacings_keep_elements_between_them(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                two = LARGE | {
                    "-pd_patches": "-0.015,-0.005,-0.003,0.005,0.003,-0.005,0.015,0.005",
                    "-pd_spacing": "3.333333333333333e-4,5e-4",
                    "-adapt": "expand",
                    "-adapt_critical_length": "0.004",
                    "-adapt_expansion_length": "0.008",
                }
                run = self.solve(two, ranks)
                self.assertGreater(run.summary["relocations"], 0)
                self.assertGreater(run.summary["bonds_broken"], 500)

    def test_a_patch_that_took_all_of_the_plate_hands_back(self):
        # With no element left there are no bonds to elements either; then there are again.
        run = self.solve({
            "-mesh_lower": "0,0", "-mesh_upper": "0.4e-3,0.24e-3", "-mesh_cells": "20,12", "-material_young": "75e9",
            "-material_thickness": "1e-3", "-material_toughness": "5", "-crack_names": "a", "-pd_horizon_ratio": "3",
            "-crack_a_points": "0,0.13e-3,0.12e-3,0.13e-3", "-adapt": "relocate", "-adapt_seed": "tip", "-pd_spacing": "1e-5",
            "-bc_names": "top,bottom", "-bc_top_on": "top", "-bc_top_displacement": "0,4e-7", "-bc_bottom_on": "bottom",
            "-bc_bottom_displacement": "0,-4e-7", "-load_steps": "10", "-output_history": "", "-quiet": ""})  # fmt: skip
        history = run.history()
        self.assertEqual(max(row["particles"] for row in history), 960)  # of 2 x 2 an element
        self.assertGreater(history[-1]["elements"], 0)
        self.assertLess(abs(history[-1]["reaction_top_y"]), 1e-6)  # in two

    def test_a_spacing_by_which_no_patch_can_grow_is_told(self):
        odd = PLATE | {"-pd_patches": "-0.009,-0.005,0.011,0.007", "-pd_spacing": "8e-4", "-ts_max_steps": "5"}
        run = self.launch(odd)
        self.assertEqual(run.status, 0)
        self.assertRegex(run.err, "warning: -adapt.*no element.*-pd_spacing")

    def test_what_cannot_move_is_refused(self):
        for change, words in (
            ({"-pd_patches": "all"}, "-adapt"),
            ({"-couple_scheme": "ghost"}, "-adapt.*-couple_scheme energy"),
            ({"-analysis": "implicit", "-ts_dt": "1e-5"}, "-adapt.*-analysis explicit"),
            ({"-adapt_critical_length": "0.01", "-adapt_expansion_length": "0.005"}, "-adapt_expansion_length"),
            ({"-adapt": "none", "-adapt_every": "5"}, "-adapt_every.*-adapt expand"),
            ({"-adapt_contraction_length": "0.01"}, "-adapt_contraction_length.*-adapt relocate"),
            ({"-adapt_expansions": "2"}, "-adapt_expansions.*-adapt relocate"),
            ({"-adapt": "relocate", "-adapt_expansions": "0"}, "-adapt_expansions"),
            ({"-adapt_expansion_length": "1e-4"}, "-adapt_expansion_length.*above the 0.00"),
            ({"-adapt": "grow"}, "-adapt.*none, expand"),
        ):
            with self.subTest(change):
                run = self.launch(PLATE | change)
                self.assertEqual(run.status, 1, run.err)
                self.assertRegex(run.err, words)
                self.assertEqual(len(run.err.splitlines()), 1)


if __name__ == "__main__":
    program.main()
