"""Material points: flight, spin, clamped and loaded bodies, ranks, restarts, in the plane and in space.

Usage: test_points.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import math

import gmsh_files
import numpy as np
import program

import pdxtools

SOFT = {
    "-case": "points",
    "-analysis": "explicit",
    "-material_young": "1e6",
    "-material_poisson": "0.25",
    "-material_density": "1000",
    "-mpm_spacing": "1e-3",
    "-output_history": "",
    "-output_history_interval": "1",
    "-quiet": "",
}
DISC = SOFT | {"-mpm_bodies": "disc", "-mpm_disc_disc": "0.3,0.2,0.01", "-mpm_disc_velocity": "3,-1", "-ts_max_steps": "200"}
BALL = SOFT | {"-material_plane": "solid", "-mpm_bodies": "ball", "-mpm_ball_sphere": "0,0,0,0.008",
               "-mpm_ball_velocity": "1,2,3", "-ts_max_steps": "60"}
# A bar of 20 x 4 cells, held at its left end and pulled at its right one: in the end stretched as the closed form says.
BAR = SOFT | {"-material_poisson": "0", "-mpm_bodies": "bar", "-mpm_bar_box": "0,0,0.04,0.008", "-bc_names": "left,right",
              "-bc_left_on": "left", "-bc_left_displacement": "0,free", "-bc_right_on": "right", "-bc_right_traction": "1e3,0"}
# A bar of which .03 m hit the rest at 30 m/s, as one: waves of rho c v / 2 = 1500 Pa and, where they meet again, the same
# as a pull (the paper's section 5.1).
SPALL = SOFT | {"-material_young": "1e4", "-material_poisson": "0", "-material_density": "1", "-mpm_bodies": "bar",
                "-mpm_bar_box": "0,0,0.1,0.002", "-bc_names": "hit", "-bc_hit_box": "0,0,0.03,0.002",
                "-bc_hit_initial_velocity": "30,0", "-ts_max_time": "1.15e-3"}
# A block that flies onto a plate and slides.
RUB = SOFT | {"-mpm_bodies": "plate,block", "-mpm_plate_box": "0,0,0.03,0.006", "-mpm_block_box": "0.006,0.006,0.014,0.01",
              "-mpm_block_velocity": "0.5,-0.3", "-contact_friction": "0.3", "-ts_safety": "0.5", "-ts_max_steps": "700"}
# A disc that falls on a slope, which is held: it keeps what it has along the slope.
FALL = SOFT | {"-mpm_bodies": "slope,disc", "-mpm_spacing": "0.5e-3", "-mpm_disc_velocity": "0,-1", "-ts_safety": "0.5",
               "-ts_max_time": "2.5e-3", "-output_history_interval": "20", "-bc_names": "hold", "-bc_hold_of": "slope",
               "-bc_hold_box": "-1,-1,1,1", "-bc_hold_displacement": "0,0"}
# A unit square of one four-node cell, and a triangle on its right whose slanted side goes through no site of .1.
TWO_SURFACES = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "block"
2 2 "tip"
$EndPhysicalNames
$Nodes
6
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 2.04 0 0
6 1 1.04 0
$EndNodes
$Elements
2
1 3 2 1 1 1 2 3 4
2 2 2 2 2 2 5 6
$EndElements
"""
# The same at rest, held so that it narrows freely, and with particles in its middle; what is stretched has a closed form.
STRETCHED = {"-case": "stretched", "-material_young": "1e9", "-material_poisson": repr(1.0 / 3.0), "-material_density": "1e3",
             "-material_thickness": "0.01", "-mpm_bodies": "bar", "-mpm_bar_box": "0,0,1,0.2", "-mpm_spacing": "0.02",
             "-bc_names": "left,bottom,right", "-bc_left_on": "left", "-bc_left_displacement": "0,free", "-bc_bottom_on": "bottom",
             "-bc_bottom_displacement": "free,0", "-bc_right_on": "right", "-bc_right_displacement": "1e-6,free", "-quiet": ""}
PATCHED = STRETCHED | {"-pd_patches": "0.4,0.04,0.6,0.16", "-pd_spacing": "0.02", "-pd_horizon_ratio": "3", "-bc_right_displacement": "1e-8,free"}
# Two halves of that bar in touch, a half each held so that it narrows freely.
HALVES = STRETCHED | {"-material_poisson": "0", "-mpm_bodies": "a,b", "-mpm_bar_box": None, "-mpm_spacing": "0.025", "-mpm_a_box": "0,0,0.5,0.2",
                      "-mpm_b_box": "0.5,0,1,0.2", "-bc_left_of": "a", "-bc_right_of": "b"}
# Two cantilevers, one on top of the other; what pushes the upper one down bends both.
BEAMS = HALVES | {"-mpm_spacing": "0.0125", "-mpm_a_box": "0,0,1,0.1", "-mpm_b_box": "0,0,1,0.1", "-mpm_b_translation": "0,0.1",
                  "-bc_names": "left,right", "-bc_bottom_on": None, "-bc_bottom_displacement": None, "-bc_left_of": None, "-bc_left_displacement": "0,0", "-bc_right_displacement": None,
                  "-bc_right_traction": "0,-1e4"}
SPINNING = DISC | {"-mpm_disc_velocity": None, "-mpm_disc_spin": "200"}


class AtRest(program.ProgramTest):
    def energy_over_closed_form(self, run, pull):
        results = pdxtools.read_summary(run.directory)["results"]
        for name, sign in (("right", 1.0), ("left", -1.0)):
            self.assertAlmostEqual(results["reaction"][name][0] / (sign * 1e9 * pull * 0.2 * 0.01), 1.0, delta=1e-7)
        self.assertAlmostEqual(results["external_work"] / results["strain_energy"], 1.0, delta=1e-9)
        return results["strain_energy"] / (0.5 * 1e9 * pull**2 * 0.2 * 0.01)

    def test_a_bar_that_is_stretched_has_the_energy_of_the_closed_form(self):
        for ranks in (1, 2):
            run = self.solve(STRETCHED, ranks)
            self.assertAlmostEqual(self.energy_over_closed_form(run, 1e-6), 1.0, delta=1e-10)

    def test_particles_in_points_pass_the_patch_test(self):
        for ranks in (1, 3):
            run = self.solve(PATCHED, ranks)
            self.assertAlmostEqual(self.energy_over_closed_form(run, 1e-8), 1.0, delta=1e-9)

    def test_a_cantilever_bends_as_far_as_the_same_of_elements(self):
        bent = {"-bc_names": "left,right", "-bc_left_on": "left", "-bc_left_displacement": "0,0", "-bc_right_on": "right",
                "-bc_right_displacement": None, "-bc_right_traction": "0,1e5", "-bc_bottom_on": None, "-bc_bottom_displacement": None}
        points = pdxtools.read_summary(self.solve(STRETCHED | bent, 2).directory)["results"]
        elements = {key: value for key, value in (STRETCHED | bent).items() if not key.startswith("-mpm")}
        elements |= {"-mesh_lower": "0,0", "-mesh_upper": "1,0.2", "-mesh_cells": "25,5", "-kinematics": "finite"}
        theirs = pdxtools.read_summary(self.solve(elements, 1).directory)["results"]
        far = points["max_displacement_component"]
        shear = 200 / (5 / 6 * 3.75e8 * 0.2 * 0.01)  # P L / (k G A) with P = 200 N
        self.assertAlmostEqual(far / (200 / (3 * 1e9 * 0.01 * 0.2**3 / 12) + shear), 1.0, delta=0.02)  # P L^3 / (3 E I)
        self.assertAlmostEqual(far / theirs["max_displacement_component"], 1.0, delta=0.02)

    def test_halves_that_are_pressed_together_act_as_one_bar(self):
        for ranks in (1, 2):
            results = pdxtools.read_summary(self.solve(HALVES | {"-bc_right_displacement": "-1e-5,free"}, ranks).directory)["results"]
            # E A / L, but for the last cell of either: what pushes at 3/4 of it strains it by 3/4, over 3/4 of its length
            push = 1e9 * 0.2 * 0.01 * 1e-5 / (1.0 - 2 * (0.75 - 0.75**2) * 0.05)
            self.assertAlmostEqual(results["reaction"]["left"][0] / push, 1.0, delta=1e-4)
            self.assertAlmostEqual(results["reaction"]["left"][0] / -results["reaction"]["right"][0], 1.0, delta=1e-7)
            self.assertAlmostEqual(results["external_work"] / results["strain_energy"], 1.0, delta=1e-4)  # finite stretches
            self.assertGreater(results["strain_energy_contact"], 0.0)
        apart = pdxtools.read_summary(self.solve(HALVES | {"-bc_right_displacement": "1e-5,free"}).directory)["results"]
        self.assertLess(abs(apart["reaction"]["right"][0]), 1e-6 * push)

    def test_beams_on_top_of_each_other_bear_half_each(self):
        both = pdxtools.read_summary(self.solve(BEAMS | {"-bc_right_of": "b"}, 2).directory)["results"]
        alone = {key: value for key, value in BEAMS.items() if not key.startswith("-mpm_b_")} | {"-mpm_bodies": "a", "-bc_right_of": None}
        one = pdxtools.read_summary(self.solve(alone).directory)["results"]
        far = both["max_displacement_component"]
        self.assertAlmostEqual(far / one["max_displacement_component"], 0.5, delta=0.01)
        shear = 0.5 * 10 / (5 / 6 * 5e8 * 0.1 * 0.01)  # half of P = 10 N, over k G A / L
        self.assertAlmostEqual(far / (0.5 * 10 / (3 * 1e9 * 0.01 * 0.1**3 / 12) + shear), 1.0, delta=0.05)

    def test_bars_that_collide_in_implicit_steps_change_places(self):
        hit = {key: value for key, value in HALVES.items() if not key.startswith("-bc_")}
        hit |= {"-analysis": "implicit", "-mpm_a_velocity": "1,0", "-ts_dt": "2e-5", "-ts_max_time": "1.4e-3", "-output_history": ""}
        rows = self.solve(hit, 2).history()
        for row in rows:
            self.assertAlmostEqual(row["momentum_x"] / rows[0]["momentum_x"], 1.0, delta=1e-7)
        self.assertAlmostEqual(rows[-1]["velocity_b_x"], 1.0, delta=0.05)  # a plane wave throws the second
        self.assertAlmostEqual(rows[-1]["contact_a_b_impulse_x"] / -(1e3 * 0.5 * 0.2 * 0.01), 1.0, delta=0.05)

    def test_bodies_are_moved_to_their_places(self):
        there = HALVES | {"-bc_right_displacement": "-1e-5,free", "-mpm_b_box": "-2,1,-1.5,1.2", "-mpm_b_translation": "2.5,-1"}
        run, moved = self.solve(HALVES | {"-bc_right_displacement": "-1e-5,free"}), self.solve(there)
        for key in ("strain_energy", "reaction"):
            self.assertEqual(pdxtools.read_summary(run.directory)["results"][key], pdxtools.read_summary(moved.directory)["results"][key])


class Points(program.ProgramTest):
    def test_a_body_that_flies_feels_nothing(self):
        for scene, ranks in ((DISC, 1), (DISC, 2), (BALL, 1), (BALL, 3)):
            with self.subTest(ranks=ranks, space="-material_plane" in scene):
                run = self.solve(scene, ranks)
                rows, results = run.history(), run.summary["results"]
                self.assertLess(results["strain_energy"], 1e-20 * rows[0]["energy_kinetic_points"])
                self.assertLess(results["momentum_error_ratio"], 1e-13)
                self.assertEqual(run.summary["unknowns"]["mpm"], results["material_points"])
                self.assertFalse([name for name in run.events if name.startswith(("pd_", "bond_", "element_"))])

    def test_a_disc_that_spins_keeps_energy_and_angular_momentum(self):
        for ranks in (1, 2):
            rows = self.solve(SPINNING | {"-ts_max_steps": "2000", "-output_history_interval": "20"}, ranks).history()
            angular = [row["angular_momentum_z"] for row in rows]
            begin = rows[0]["energy_kinetic_points"]
            self.assertLess(max(abs(row["energy_residual"]) for row in rows), 2e-4 * begin)
            self.assertLess(max(abs(a / angular[0] - 1.0) for a in angular), 1e-13)

    def test_a_bar_is_stretched_as_far_as_it_should_be(self):
        # Pulled suddenly, its end moves to twice the static stretch and back: c = sqrt(E / rho), period 4 L / c.
        period = 4 * 0.04 / math.sqrt(1e6 / 1e3)
        for ranks in (1, 2):
            run = self.solve(BAR | {"-ts_max_time": str(period / 2), "-output_fields": "", "-output_interval": "100000"}, ranks)
            block = pdxtools.read_step(run.directory)[1]["points"]
            ends = block.points[:, 0] > 0.039
            self.assertAlmostEqual(np.mean(block["displacement"][ends, 0]) / (2 * 1e-3 * 0.0395), 1.0, delta=0.02)
            pulled = run.summary["results"]["external_work"]
            self.assertAlmostEqual(pulled / (1e3 * 0.008 * 2 * 1e-3 * 0.04), 1.0, delta=0.02)

    def test_ranks_move_points_alike(self):
        for scene in (SPINNING | {"-output_fields": ""}, BALL | {"-mpm_ball_spin": "50,100,0", "-output_fields": ""}):
            one = self.solve(scene)
            for ranks in (2, 3):
                other = self.solve(scene, ranks)
                self.assert_same_displacement(one, other, 1e-10)

    def test_bulk_viscosity_takes_the_overshoot_of_an_impact(self):
        peaks = []
        for more in ({}, {"-mpm_bulk_viscosity": "0.06"}):
            run = self.solve(SPALL | more | {"-output_fields": "", "-output_interval": "3"})
            pull = [pdxtools.read_step(run.directory, k)[1]["points"]["stress"][:, 0].max() for k in range(pdxtools.step_count(run.directory))]
            peaks.append(max(pull) / 1500)
            rows = run.history()
            begin = rows[0]["energy_kinetic_points"]
            self.assertLess(max(abs(row["energy_residual"]) for row in rows), 1e-3 * begin)
            self.assertEqual(run.summary["results"]["viscous_energy"], rows[-1]["energy_viscous"])
        self.assertGreater(peaks[0], 1.3)
        self.assertTrue(1.0 < peaks[1] < 1.1, peaks)
        self.assertTrue(0.04 < rows[-1]["energy_viscous"] / begin < 0.1)
        self.assertTrue(all(a["energy_viscous"] <= b["energy_viscous"] for a, b in zip(rows, rows[1:])))

    def test_what_viscosity_takes_is_booked_exactly(self):
        small = SPALL | {"-mpm_bulk_viscosity": "0.3", "-bc_hit_initial_velocity": "1e-6,0"}
        for more in ({}, {"-bc_names": "hit,left", "-bc_left_on": "left", "-bc_left_velocity": "-1e-6,free"}):
            rows = self.solve(small | more, 2).history()
            put_in = max(row["energy_kinetic_points"] + row["energy_points"] for row in rows)
            self.assertLess(max(abs(row["energy_residual"]) for row in rows), 1e-7 * put_in)
            self.assertGreater(rows[-1]["energy_viscous"], 0.1 * put_in)

    def test_a_body_that_flies_is_not_viscous(self):
        results = self.solve(BALL | {"-mpm_bulk_viscosity": "1"}).summary["results"]
        self.assertLess(results["viscous_energy"], 1e-20 * results["kinetic_energy"])

    def test_contact_that_cannot_hold_bodies_apart_is_told_once(self):
        # Half a spacing a step, and stress of a third of Young's modulus where they meet: rho c v / 2 with v = .6 c.
        meet = SOFT | {"-mpm_bodies": "one,two", "-mpm_one_box": "0,0,0.01,0.01", "-mpm_two_box": "0.013,0,0.023,0.01",
                       "-mpm_one_velocity": "20,0", "-ts_safety": "0.5", "-ts_max_steps": "60"}
        said = self.launch(meet).err.splitlines()
        self.assertEqual([("in each other's skin" in line, "in a step" in line) for line in said], [(True, False), (False, True)])
        self.assertEqual(said, self.launch(meet, 2).err.splitlines())
        self.solve(meet | {"-mpm_one_velocity": "1,0"}) # says nothing

    def test_a_restart_goes_on_to_the_last_bit(self):
        for ranks, scene in ((1, SPINNING | {"-mpm_bulk_viscosity": "0.06"}), (2, SPINNING)):
            whole = self.solve(scene, ranks)
            directory = self.scratch / f"half_{ranks}"
            self.solve(scene | {"-ts_max_steps": "100", "-checkpoint_interval": "100"}, ranks, directory)
            rest = self.solve(scene | {"-restart": str(directory / "checkpoint.h5")}, ranks, directory)
            self.assertEqual(whole.history(), rest.history())

    def test_a_disc_slides_off_a_slope_as_if_it_were_flat(self):
        for degrees in (18, 35):
            angle = math.radians(degrees)
            along, up = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
            corners = [[0.03 * (s * a - d * n) for a, n in zip(along, up)] for s, d in ((-1, 0), (-1, 1), (1, 1), (1, 0))]
            run = self.launch(FALL | {"-mpm_disc_disc": f"{0.0105 * up[0]!r},{0.0105 * up[1]!r},0.01",
                                      "-mpm_slope_polygon": ",".join(repr(x) for corner in corners for x in corner)})
            after = [run.history()[-1][f"velocity_disc_{axis}"] for axis in "xy"]
            self.assertAlmostEqual(after[0] * along[0] + after[1] * along[1], -along[1], delta=0.01)  # [m/s]; of stairs .1
            self.assertGreater(after[0] * up[0] + after[1] * up[1], 0.88 * up[1])

    def test_a_restart_knows_where_friction_holds(self):
        for ranks in (1, 2):
            whole = self.solve(RUB, ranks)
            self.assertGreater(whole.summary["results"]["friction_energy"], 0.0)
            directory = self.scratch / f"rub_{ranks}"
            self.solve(RUB | {"-ts_max_steps": "350", "-checkpoint_interval": "350"}, ranks, directory)
            rest = self.solve(RUB | {"-restart": str(directory / "checkpoint.h5")}, ranks, directory)
            self.assertEqual(whole.history(), rest.history())
            renewed = self.solve(RUB | {"-layout_renew_interval": "175"}, ranks)
            self.assertEqual(whole.history()[-1], renewed.history()[-1])

    def test_a_restart_knows_its_bodies(self):
        directory = self.scratch / "other"
        self.solve(SPINNING | {"-ts_max_steps": "10", "-checkpoint_interval": "10"}, directory=directory)
        run = self.launch(SPINNING | {"-mpm_disc_disc": "0.3,0.2,0.011", "-restart": str(directory / "checkpoint.h5")})
        self.assertEqual(run.status, 1)
        self.assertEqual(len(run.err.splitlines()), 1)

    def test_cells_at_rest_are_skipped_without_changing_a_bit(self):
        # The pull has gone 120 of 200 spacings when the run ends, and the loose disc has not moved at all.
        scene = BAR | {"-mpm_bodies": "bar,far", "-mpm_bar_box": "0,0,0.2,0.008", "-mpm_far_disc": "0.3,0,0.008",
                       "-bc_left_of": "bar", "-bc_right_of": "bar", "-ts_max_time": str(0.12 / math.sqrt(1e3)), "-output_fields": "",
                       "-output_interval": "100000"}
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                some, every = (self.solve(scene | {"-mpm_skip_rest": how}, ranks) for how in ("1", "0"))
                (computed, skipped), counts = ([run.summary["results"][f"mpm_cells_{what}"] for what in ("computed", "skipped")]
                                               for run in (some, every))
                self.assertGreater(skipped, 0.5 * computed)
                self.assertEqual(counts, [computed + skipped, 0])
                self.assertEqual(*((run.directory / "history.csv").read_bytes() for run in (some, every)))
                self.assert_same_displacement(some, every, tolerance=0.0)

    def test_regions_of_a_mesh_are_filled(self):
        # Four cells of the unit square are the box; of two surfaces side by side the triangle holds 10 + 9 + ... + 1 points.
        unit = BAR | {"-mpm_spacing": "0.125", "-mpm_bar_box": "0,0,1,1", "-ts_max_steps": "20"}
        box = self.solve(unit).history()
        for version, binary in (("2.2", False), ("2.2", True), ("4.1", False), ("4.1", True)):
            file = gmsh_files.Square(2).write(self.scratch / "square.msh", version, binary)
            for region in ({}, {"-mpm_bar_region": "plate"}):
                mesh = unit | {"-mpm_bar_box": None, "-mpm_bar_mesh": file} | region
                self.assertEqual(box, self.solve(mesh).history())
        two = self.scratch / "two.msh"
        two.write_text(TWO_SURFACES, encoding="utf-8")
        for region, count in (("tip", 55), ("block", 100), (None, 155)):
            wedge = BAR | {"-mpm_spacing": "0.1", "-mpm_bar_box": None, "-mpm_bar_mesh": str(two), "-mpm_bar_region": region,
                           "-bc_names": "all", "-bc_all_body": "1,0", "-ts_max_steps": "1"}
            wedge = {name: value for name, value in wedge.items() if not name.startswith(("-bc_left", "-bc_right"))}
            self.assertEqual(self.solve(wedge).summary["results"]["material_points"], count)

    def test_points_are_dealt_out_anew_by_the_time_they_take(self):
        # The left half of a long bar, that of a rank, rests until the pull at the right end comes to it.
        scene = BAR | {"-mpm_bar_box": "0,0,1,0.04", "-ts_max_steps": "300", "-output_history_interval": "100"}
        whole = self.solve(scene, 2).history()[-1]
        dealt = self.solve(scene | {"-rebalance_threshold": "1.05"}, 2)
        self.assertGreaterEqual(dealt.summary["results"]["rebalances"], 1)
        for name in ("energy_points", "momentum_x", "work"):
            self.assertAlmostEqual(dealt.history()[-1][name] / whole[name], 1.0, delta=1e-9)

    def bar_file(self, name):
        """The points of BAR's box."""
        file = self.scratch / name
        places = [((i + 0.5) * 1e-3, (j + 0.5) * 1e-3) for j in range(8) for i in range(40)]
        file.write_text("x,y,volume\n" + "".join(f"{x:.17g},{y:.17g},1e-6\n" for x, y in places), encoding="utf-8")
        return file

    def test_a_restart_knows_the_points_of_a_file_wherever_it_lies(self):
        file, directory = self.bar_file("bar.csv"), self.scratch / "begun"
        scene = BAR | {"-mpm_bar_box": None, "-mpm_bar_file": str(file)}
        self.solve(scene | {"-ts_max_steps": "10", "-checkpoint_interval": "10"}, directory=directory)
        on = scene | {"-ts_max_steps": "20", "-restart": str(directory / "checkpoint.h5")}
        self.solve(on | {"-mpm_bar_file": str(file.rename(self.scratch / "moved.csv"))})
        other = self.bar_file("bar.csv")
        other.write_text(other.read_text(encoding="utf-8") + "0.0405,0.0005,1e-6\n", encoding="utf-8")
        run = self.launch(on)
        self.assertEqual((run.status, run.err.count("\n")), (1, 1), run.err)
        self.assertIn('of another scene, which has "-mpm_bar_file = ', run.err)

    def test_points_of_a_file_are_those_of_the_box(self):
        file = self.bar_file("bar.csv")
        box, read = (self.solve(scene | {"-ts_max_steps": "50"})
                     for scene in (BAR, BAR | {"-mpm_bar_box": None, "-mpm_bar_file": str(file)}))
        for a, b in zip(box.history(), read.history(), strict=True):
            self.assertAlmostEqual(a["energy_points"], b["energy_points"], delta=1e-12 * abs(a["energy_points"]))


GRID = {"-mpm_formulation": "updated", "-ts_safety": "0.3"}
# Discs that meet on the nodes of one grid and part again.
MEET = SOFT | GRID | {"-mpm_bodies": "left,right", "-mpm_left_disc": "0,0,0.008", "-mpm_left_velocity": "0.7,0.1",
                      "-mpm_right_disc": "0.0175,0,0.008", "-mpm_right_velocity": "-0.7,0.05"}


class Grid(program.ProgramTest):
    """Points on a grid that is made anew each step."""

    def test_a_body_that_flies_feels_nothing(self):
        for scene, ranks in ((DISC | GRID, 2), (BALL | GRID | {"-mpm_shape": "gimp"}, 1), (BALL | GRID | {"-mpm_shape": "bspline"}, 3)):
            run = self.solve(scene, ranks)
            rows, results = run.history(), run.summary["results"]
            self.assertLess(results["strain_energy"], 1e-20 * rows[0]["energy_kinetic_points"])
            self.assertLess(results["momentum_error_ratio"], 1e-13)
            self.assertEqual(run.summary["unknowns"]["mpm"], results["material_points"])
            self.assertFalse([name for name in run.events if name.startswith(("pd_", "bond_", "element_", "mpm_force"))])

    def test_ranks_move_points_alike(self):
        for scene in (MEET | {"-ts_max_steps": "500"}, BALL | GRID | {"-mpm_ball_spin": "50,100,0", "-mpm_shape": "bspline"}):
            one = self.solve(scene | {"-output_fields": "", "-output_interval": "1000"})
            for ranks in (2, 3):
                self.assert_same_displacement(one, self.solve(scene | {"-output_fields": "", "-output_interval": "1000"}, ranks), 1e-10)

    def test_a_restart_goes_on_to_the_last_bit(self):
        for ranks, shape in ((1, "hat"), (2, "gimp")):
            scene = MEET | {"-mpm_shape": shape, "-ts_max_steps": "300"}
            whole = self.solve(scene, ranks)
            directory = self.scratch / f"half_{ranks}"
            self.solve(scene | {"-ts_max_steps": "150", "-checkpoint_interval": "150"}, ranks, directory)
            rest = self.solve(scene | {"-restart": str(directory / "checkpoint.h5")}, ranks, directory)
            self.assertEqual(whole.history(), rest.history())
            other = self.solve(scene | {"-restart": str(directory / "checkpoint.h5")}, 3 - ranks)
            self.assertAlmostEqual(other.history()[-1]["momentum_x"], whole.history()[-1]["momentum_x"], delta=1e-12)

    def test_discs_that_meet_on_nodes_keep_momentum_and_energy(self):
        rows = self.solve(MEET | {"-mpm_shape": "bspline", "-ts_max_time": "4e-3", "-ts_safety": "0.15"}).history()
        begin = rows[0]["energy_kinetic_points"]
        self.assertLess(max(abs(row["energy_residual"]) for row in rows), 1.5e-2 * begin)
        self.assertGreater(max(row["energy_points"] for row in rows), 0.3 * begin)
        for name in ("momentum_x", "momentum_y"):
            self.assertLess(max(abs(row[name] - rows[0][name]) for row in rows), 1e-13 * 0.2 * 0.7)
        speed = [row["velocity_left_x"] for row in rows]
        first = next(k for k, v in enumerate(speed) if v < -0.3)
        self.assertGreater(max(speed[first:]), 0.3) # they stick, and swing as one

    def test_a_bar_hangs_from_nodes(self):
        # Let go at once, it swings to twice the static stretch rho g L^2 / 2 E and back in 4 L / c.
        period, pull = 4 * 0.04 / math.sqrt(1e6 / 1e3), 5e3
        hung = BAR | GRID | {"-mpm_shape": "gimp", "-bc_names": "left,heavy", "-bc_left_displacement": "0,free",
                             "-bc_right_on": None, "-bc_right_traction": None, "-bc_heavy_body": f"{pull},0",
                             "-ts_max_time": str(period / 2)}
        for ranks in (1, 2):
            run = self.solve(hung | {"-output_fields": "", "-output_interval": "100000"}, ranks)
            block = pdxtools.read_step(run.directory)[1]["points"]
            ends = block.points[:, 0] > 0.039
            static = pull * (0.04 * 0.0395 - 0.0395**2 / 2) / 1e6
            self.assertAlmostEqual(np.mean(block["displacement"][ends, 0]) / (2 * static), 1.0, delta=0.02)
            rows = run.history()
            self.assertAlmostEqual(rows[-1]["work"] / (rows[-1]["energy_points"] + rows[-1]["energy_kinetic_points"]), 1.0, delta=0.01)
            mean = sum(row["reaction_left_x"] for row in rows[1:]) / (len(rows) - 1)
            self.assertAlmostEqual(-mean / (pull * 0.04 * 0.008), 1.0, delta=0.05)

    def test_a_run_gone_wild_is_one_line(self):
        run = self.launch(MEET | {"-ts_dt": "1e-3", "-ts_allow_unstable": "", "-ts_max_steps": "400"}, ranks=2)
        self.assertEqual(run.status, 2)
        self.assertEqual(len(run.err.splitlines()), 1)
        self.assertRegex(run.err, r"^error: step \d+, time .* is kept; try a smaller -ts_dt")

    def test_a_block_that_blows_up_by_stress_from_too_little_mass_is_told_so(self):
        block = SOFT | GRID | {"-mpm_bodies": "a", "-mpm_a_box": "0,0,0.02,0.01", "-mpm_a_spin": "50", "-ts_safety": "0.2",
                               "-ts_max_steps": "300"}  # fmt: skip
        run = self.launch(block | {"-mpm_order": "usl"})
        self.assertEqual(run.status, 2)
        self.assertRegex(run.err, r"^error: step \d+, time [^\n]*blown up, a material point flies at [\d.e+]+ m/s.*-mpm_order usl[^\n]*is kept[^\n]*\n$")
        self.assertEqual(self.launch(block | {"-mpm_order": "usl", "-mpm_shape": "gimp"}).status, 0)


if __name__ == "__main__":
    program.main()
