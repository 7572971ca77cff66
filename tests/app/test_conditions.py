"""Rollers along any direction, springs, what turns, pins and loads by a formula: each beside a closed form.

Usage: test_conditions.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import math

import numpy as np
import program

import pdxtools

E, NU, RHO = 1e9, 1 / 3, 1000.0
ALPHA = math.radians(25)
N = np.array([math.sin(ALPHA), math.cos(ALPHA)])  # the bottom is held along it
PUSH, PULL = 2e6, 1e6  # along N on the bottom; along x [Pa]
SQUARE = {
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "8,8",
    "-material_young": f"{E}",
    "-material_poisson": repr(NU),
    "-output_history": "",
    "-quiet": "",
}
# In uniform stress: (xx, yy, xy) so that the bottom pushes along N only, loaded on the other sides, held in a corner.
STRESS = np.array([[PULL, PUSH * N[0]], [PUSH * N[0], PUSH * N[1]]])
ROLLED = SQUARE | {
    "-case": "rolled",
    "-bc_names": "corner,bottom,right,top,left",
    "-bc_corner_box": "-0.01,-0.01,0.01,0.01",
    "-bc_corner_displacement": "0,0",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_roller": f"{N[0]},{N[1]}",
    "-probe_names": "far",
    "-probe_far_at": "1,1",
    "-probe_far_field": "displacement",
} | {f"-bc_{side}_on": side for side in ("right", "top", "left")} | {
    f"-bc_{side}_traction": ",".join(repr(t) for t in STRESS @ normal)
    for side, normal in (("right", (1, 0)), ("top", (0, 1)), ("left", (-1, 0)))
}  # fmt: skip
# Material points, elements, particles of a lattice and of a file that all roll along a slope under their weight.
WEIGHT = {
    "-analysis": "explicit",
    "-material_young": "1e6",
    "-material_density": f"{RHO}",
    "-ts_max_steps": "20",
    "-bc_names": "slope,weight",
    "-bc_slope_box": "-1,-1,9,9",
    "-bc_slope_roller": "3,4",
    "-bc_weight_body": "0,-1e4",
    "-output_history": "",
    "-output_history_interval": "1",
    "-output_fields": "",
    "-output_interval": "20",
    "-quiet": "",
}
BOX = {"-mesh_lower": "0,0", "-mesh_upper": "0.4,0.4"}
CLOUD = "x,y,volume\n" + "".join(f"{0.1 * i},{0.1 * j},0.01\n" for i in range(5) for j in range(5))


def displacement_of(run):
    """Of all blocks at the end."""
    return [np.asarray(block["displacement"])[:, :2] for block in pdxtools.read_step(run.directory)[1].values()]


class Rollers(program.ProgramTest):
    def test_a_square_in_uniform_stress_rolls_along_its_slanted_bottom(self):
        strain = (1 + NU) / E * STRESS - NU / E * np.trace(STRESS) * np.eye(2)
        turn = -(N[0] * strain[0, 0] + N[1] * strain[0, 1]) / N[1]
        slope = strain + turn * np.array([[0, -1], [1, 0]])
        patch = {"-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.0625", "-pd_horizon_ratio": "3"}
        for more, ranks in (({}, 1), ({}, 2), (patch, 1), ({"-crack_names": None, **patch}, 2)):
            with self.subTest(more=more, ranks=ranks):
                run = self.solve(ROLLED | more, ranks)
                far = pdxtools.read_curve(run.directory / "probe_far.csv")
                expected = slope @ np.ones(2)
                self.assertAlmostEqual(far["displacement_x"][-1], expected[0], delta=1e-7 * np.abs(expected).max())
                self.assertAlmostEqual(far["displacement_y"][-1], expected[1], delta=1e-7 * np.abs(expected).max())
                last = run.history()[-1]
                for k, axis in enumerate("xy"):
                    whole = last[f"reaction_bottom_{axis}"] + last[f"reaction_corner_{axis}"]
                    self.assertAlmostEqual(whole, -PUSH * N[k], delta=1e-6 * PUSH)
                energy = 0.5 * np.sum(STRESS * strain)
                stored = sum(last[f"energy_{part}"] for part in ("elements", "bonds", "interface"))
                self.assertAlmostEqual(stored, energy, delta=1e-6 * energy)

    def test_all_kinds_of_bodies_roll_down_a_slope(self):
        (self.scratch / "cloud.csv").write_text(CLOUD, encoding="utf-8")
        free = np.array([4, -3]) / 5
        push = -1e4 / RHO * free[1] * free  # of the weight, what is not held
        kinds = {
            "elements": BOX | {"-mesh_cells": "4,4"},
            "implicit": BOX | {"-mesh_cells": "4,4", "-analysis": "implicit", "-ts_dt": "1e-4"},
            "particles": BOX | {"-pd_patches": "all", "-pd_spacing": "0.05"},
            "solid": BOX | {"-pd_patches": "all", "-pd_spacing": "0.1", "-material_plane": "solid", "-material_thickness": "0.4",
                            "-material_poisson": "0.25", "-pd_horizon_ratio": "2", "-pd_surface_correction": "volume"},
            "cloud": {"-pd_cloud": str(self.scratch / "cloud.csv"), "-pd_horizon": "0.3"},
            "points": {"-mpm_bodies": "a", "-mpm_a_box": "0,0,0.4,0.4", "-mpm_spacing": "0.05"},
            "updated": {"-mpm_bodies": "a", "-mpm_a_box": "0,0,0.4,0.4", "-mpm_spacing": "0.05", "-mpm_formulation": "updated"},
            "mixed": {"-mpm_bodies": "a", "-mpm_a_box": "0,0,0.4,0.4", "-mpm_spacing": "0.05", "-pd_patches": "0.1,0.1,0.3,0.3",
                      "-pd_spacing": "0.05", "-pd_horizon_ratio": "3", "-material_poisson": repr(1 / 3), "-pd_critical_stretch": "1"},
        }  # fmt: skip
        for (name, more), run in zip(kinds.items(), program.in_pairs(lambda more: self.solve(WEIGHT | more), kinds.values())):
            with self.subTest(kind=name):
                time = run.summary["results"]["time"]
                expected = 0.5 * time**2 * push
                for u in displacement_of(run):
                    self.assertGreater(len(u), 0)
                    self.assertLess(np.abs(u - expected).max(), 2e-6 * np.abs(expected).max())

    def test_slanted_rollers_keep_the_books_and_the_ranks(self):
        moving = SQUARE | {
            "-analysis": "explicit", "-material_density": f"{RHO}", "-ts_max_time": "2e-3", "-bc_names": "bottom,pull",
            "-bc_bottom_on": "bottom", "-bc_bottom_roller": "1,2", "-bc_pull_on": "top", "-bc_pull_traction": "0,1e6",
            "-bc_pull_history_expression": "sin(2*pi*t/1e-3)", "-pd_patches": "0.25,0,0.75,0.5", "-pd_spacing": "0.0625",
            "-pd_horizon_ratio": "3", "-output_fields": "", "-output_interval": "1000000"}  # fmt: skip
        one, two = program.in_pairs(lambda ranks: self.solve(moving, ranks), (1, 2))
        self.assertLess(one.summary["results"]["energy_drift_ratio"], 1e-10)
        self.assert_same_displacement(one, two)
        _, blocks = pdxtools.read_step(one.directory)
        mesh = blocks["mesh"]
        low = (mesh.points[:, 1] < 1e-9) & (np.abs(mesh.points[:, 0] - 0.5) > 0.24)  # the rest is under particles
        u = np.asarray(mesh["displacement"])[low]
        self.assertLess(np.abs(u[:, 0] + 2 * u[:, 1]).max(), 1e-12 * np.abs(mesh["displacement"]).max() + 1e-18)


class Springs(program.ProgramTest):
    def test_a_plate_on_springs_sinks_by_what_they_give(self):
        stiffness, pressure = 4e9, 1e6
        springs = SQUARE | {
            "-case": "springs", "-material_poisson": "0", "-material_thickness": "0.5", "-bc_names": "left,bottom,top",
            "-bc_left_on": "left", "-bc_left_displacement": "0,free", "-bc_bottom_on": "bottom",
            "-bc_bottom_spring": f"{stiffness},1e8", "-bc_top_on": "top", "-bc_top_traction": f"0,{pressure}",
            "-probe_names": "low,high", "-probe_low_at": "0.5,0", "-probe_low_field": "displacement", "-probe_high_at": "0.5,1",
            "-probe_high_field": "displacement"}  # fmt: skip
        slanted = {"-bc_bottom_spring": f"{2 * stiffness}", "-bc_bottom_spring_along": "1,1", "-bc_right_on": "right", "-bc_names": "left,right,bottom,top",
                   "-bc_right_displacement": "0,free"}  # fmt: skip
        for more, ranks in (({}, 1), ({}, 2), (slanted, 1)):
            with self.subTest(more=more, ranks=ranks):
                run = self.solve(springs | more, ranks)
                low, high = (pdxtools.read_curve(run.directory / f"probe_{name}.csv")["displacement_y"][-1] for name in ("low", "high"))
                last = run.history()[-1]
                self.assertAlmostEqual(last["reaction_bottom_y"], -0.5 * pressure, delta=1e-6 * pressure)
                self.assertAlmostEqual(last["work"], sum(last[f"energy_{part}"] for part in ("elements", "supports")), delta=1e-6 * last["work"])
                if more:  # sides keep the springs' push along x, but nodes between them give way
                    continue
                self.assertAlmostEqual(low, pressure / stiffness, delta=1e-7 * pressure / stiffness)
                self.assertAlmostEqual(high - low, pressure / E, delta=1e-7 * pressure / E)
                self.assertAlmostEqual(last["energy_supports"], 0.25 * pressure**2 / stiffness, delta=1e-6 * pressure**2 / stiffness)

    def test_a_stiff_block_swings_on_soft_springs(self):
        stiffness, speed = 1e6, 1.0
        for more in ({"-mesh_cells": "2,2"}, {"-pd_patches": "all", "-pd_spacing": "0.1", "-mesh_cells": None},
                     {"-mesh_cells": None, "-mesh_lower": None, "-mesh_upper": None, "-mpm_bodies": "a", "-mpm_a_box": "0,0,1,1",
                      "-mpm_spacing": "0.25"}):  # fmt: skip
            with self.subTest(more=more):
                run = self.solve(SQUARE | {
                    "-analysis": "explicit", "-material_density": f"{RHO}", "-ts_max_time": "0.05", "-bc_names": "springs,thrown",
                    "-bc_springs_on": "bottom", "-bc_springs_spring": f"{stiffness},{stiffness}", "-bc_thrown_box": "-1,-1,2,2",
                    "-bc_thrown_initial_velocity": f"0,{speed}", "-output_history_interval": "1"} | more)  # fmt: skip
                self.assertLess(run.summary["results"]["energy_drift_ratio"], 1e-6)
                frequency = math.sqrt(stiffness / RHO)
                for row in run.history()[::20]:  # the block is 1000 times as stiff as the springs
                    expected = -stiffness * speed / frequency * math.sin(frequency * row["time"])
                    self.assertAlmostEqual(row["reaction_springs_y"], expected, delta=3e-2 * stiffness * speed / frequency)


class Turning(program.ProgramTest):
    def test_a_body_that_one_side_turns_follows_as_a_rigid_one(self):
        angle = 120.0
        run = self.solve(SQUARE | {
            "-case": "turned", "-mesh_cells": "4,4", "-kinematics": "finite", "-bc_names": "left", "-bc_left_on": "left",
            "-bc_left_turn": f"{angle}deg", "-bc_left_centre": "-1,0.5", "-load_steps": "24", "-output_fields": ""})  # fmt: skip
        _, blocks = pdxtools.read_step(run.directory)
        x = blocks["mesh"].points[:, :2] - np.array([-1, 0.5])
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        expected = x @ np.array([[c, s], [-s, c]]) - x
        self.assertLess(np.abs(np.asarray(blocks["mesh"]["displacement"])[:, :2] - expected).max(), 1e-7)
        self.assertLess(run.summary["results"]["strain_energy"], 1e-9 * E)

    def test_its_moment_does_the_work(self):
        angle = 1e-4
        options = SQUARE | {
            "-bc_names": "left,right", "-bc_left_on": "left", "-bc_left_displacement": "0,0", "-bc_right_on": "right",
            "-bc_right_turn": f"{angle}", "-bc_right_centre": "1,0.5"}  # fmt: skip
        last = self.solve(options, 2).history()[-1]
        self.assertAlmostEqual(last["work"], 0.5 * last["moment_right"] * angle, delta=1e-3 * last["work"])
        self.assertAlmostEqual(last["work"], last["energy_elements"], delta=1e-6 * last["work"])

    def test_in_time_all_kinds_go_round(self):
        turned = {"-ts_max_steps": "50", "-ts_dt": "1e-3", "-bc_names": "a", "-bc_a_box": "-1,-1,9,9", "-bc_slope_box": None, "-bc_slope_roller": None,
                  "-bc_weight_body": None, "-bc_a_turn": "90deg", "-bc_a_centre": "0.1,0.2", "-bc_a_history_points": "0:0,0.2:1",
                  "-output_interval": "50"}  # fmt: skip
        kinds = {
            "elements": BOX | {"-mesh_cells": "4,4", "-kinematics": "finite"},
            "implicit": BOX | {"-mesh_cells": "4,4", "-kinematics": "finite", "-analysis": "implicit", "-ts_dt": "1e-3"},
            "solid": BOX | {"-pd_patches": "all", "-pd_spacing": "0.1", "-material_plane": "solid", "-material_thickness": "0.4",
                            "-material_poisson": "0.25", "-pd_horizon_ratio": "2", "-pd_surface_correction": "volume", "-kinematics": "finite"},
            "points": {"-mpm_bodies": "a", "-mpm_a_box": "0,0,0.4,0.4", "-mpm_spacing": "0.05"},
        }  # fmt: skip
        for (name, more), run in zip(kinds.items(), program.in_pairs(lambda more: self.solve(WEIGHT | turned | more), kinds.values())):
            with self.subTest(kind=name):
                theta = math.pi / 2 * run.summary["results"]["time"] / 0.2
                c, s = math.cos(theta), math.sin(theta)
                for block in pdxtools.read_step(run.directory)[1].values():
                    x = block.points[:, :2] - np.array([0.1, 0.2])
                    u = np.asarray(block["displacement"])[:, :2]
                    self.assertLess(np.abs(u - (x @ np.array([[c, s], [-s, c]]) - x)).max(), 1e-9)

    def test_a_grid_made_anew_turns_what_is_on_it(self):
        run = self.solve({key: value for key, value in WEIGHT.items() if not key.startswith("-bc_")} | {
            "-mpm_bodies": "a", "-mpm_a_box": "0,0,0.4,0.4", "-mpm_spacing": "0.05", "-mpm_formulation": "updated", "-bc_names": "a",
            "-bc_a_box": "-9,-9,9,9", "-bc_a_turn": "90deg", "-bc_a_centre": "0.2,0.2", "-bc_a_history_points": "0:0,0.2:1",
            "-ts_max_time": "0.02", "-ts_dt": "2e-4", "-ts_max_steps": None, "-output_interval": "100000"})  # fmt: skip
        theta = math.radians(9)
        block = pdxtools.read_step(run.directory)[1]["points"]
        x = block.points[:, :2] - 0.2
        c, s = math.cos(theta), math.sin(theta)
        off = np.asarray(block["displacement"])[:, :2] - (x @ np.array([[c, s], [-s, c]]) - x)
        self.assertLess(np.abs(off).max(), 1e-3 * theta * np.abs(x).max())


class Pins(program.ProgramTest):
    def test_what_a_pin_pushes_takes_its_momentum(self):
        block = {
            "-case": "pin", "-analysis": "explicit", "-material_young": "1e6", "-material_poisson": "0.25", "-material_density": f"{RHO}",
            "-mpm_bodies": "a", "-mpm_a_box": "0,0,0.04,0.02", "-mpm_a_velocity": "1,0", "-mpm_spacing": "1e-3", "-bc_names": "pin",
            "-bc_pin_pin": "8e-3", "-bc_pin_at": "0.0485,0.01", "-ts_max_time": "4e-3", "-output_history": "",
            "-output_history_interval": "1", "-quiet": ""}  # fmt: skip
        moving = block | {"-mpm_a_velocity": None, "-bc_pin_velocity": "-1,0"}
        still, pushed = (self.solve(options).history() for options in (block, moving))
        for rows, sign in ((still, -1), (pushed, -1)):
            momentum = [row["momentum_x"] for row in rows]
            push = np.array([row["reaction_pin_x"] for row in rows])
            times = np.array([row["time"] for row in rows])
            impulse = np.sum(0.5 * (push[1:] + push[:-1]) * np.diff(times))
            self.assertAlmostEqual(momentum[-1] - momentum[0], impulse, delta=1e-6 * abs(impulse))
            self.assertGreater(sign * impulse, 0.1 * RHO * 8e-4)
            largest = max(row["energy_kinetic_points"] + row["work"] for row in rows)
            self.assertLess(max(abs(row["energy_residual"]) for row in rows), 2e-2 * largest)
        for a, b in zip(still[::10], pushed[::10]):  # the same to one who flies along
            self.assertAlmostEqual(a["reaction_pin_x"], b["reaction_pin_x"], delta=1e-6 * max(-row["reaction_pin_x"] for row in still))

    def test_elements_and_particles_on_two_ranks_meet_the_same_pin(self):
        for more in ({"-mesh_cells": "8,4"}, {"-pd_patches": "all", "-pd_spacing": "0.0025", "-pd_horizon_ratio": "3"}):
            options = {
                "-analysis": "explicit", "-material_young": "1e6", "-material_density": f"{RHO}", "-mesh_lower": "0,0", "-mesh_upper": "0.04,0.02",
                "-bc_names": "held,pin", "-bc_held_on": "bottom", "-bc_held_displacement": "free,0", "-bc_pin_pin": "0.01",
                "-bc_pin_at": "0.02,0.031", "-bc_pin_displacement": "0,-2e-3", "-bc_pin_history": "ramp", "-bc_pin_history_width": "0.05",
                "-ts_max_time": "0.06", "-output_history": "", "-output_history_interval": "20", "-quiet": ""}  # fmt: skip
            with self.subTest(more=more):
                one, two = program.in_pairs(lambda ranks, all=options | more: self.solve(all, ranks), (1, 2))
                a, b = (np.array([[row["reaction_pin_y"], row["reaction_held_y"], row["work"]] for row in run.history()]) for run in (one, two))
                self.assertLess(np.abs(a - b).max(axis=0)[0], 1e-9 * np.abs(a[:, 0]).max())
                late = np.array([row["time"] > 0.04 for row in one.history()])
                self.assertLess(a[late, 0].mean(), 0)  # it pushes down, and the floor bears that
                self.assertAlmostEqual(-a[late, 0].mean(), a[late, 1].mean(), delta=0.05 * a[late, 1].mean())
                self.assertLess(one.summary["results"]["energy_drift_ratio"], 2e-2)

    # A beam of 1.2 x 0.1 m on two pins 1 m apart, a third presses on its middle.
    BEND = {
        "-case": "bend", "-mesh_lower": "-0.6,0", "-mesh_upper": "0.6,0.1", "-mesh_cells": "48,4", "-material_young": f"{E}",
        "-bc_names": "mid", "-bc_mid_box": "-1e-3,-1e-3,1e-3,1e-3", "-bc_mid_displacement": "0,free", "-output_history": "", "-quiet": ""}  # fmt: skip
    PINNED = BEND | {
        "-bc_names": "mid,left,right,top", "-bc_left_pin": "0.05", "-bc_left_at": "-0.5,-0.05", "-bc_right_pin": "0.05",
        "-bc_right_at": "0.5,-0.05", "-bc_top_pin": "0.04", "-bc_top_at": "0,0.14", "-bc_top_displacement": "0,-1e-3"}  # fmt: skip

    def test_a_beam_on_pins_bends_as_under_point_forces(self):
        force = 1e4
        points = self.BEND | {
            "-bc_names": "mid,left,right,push", "-bc_left_box": "-0.501,-1e-3,-0.499,1e-3", "-bc_left_displacement": "free,0",
            "-bc_right_box": "0.499,-1e-3,0.501,1e-3", "-bc_right_displacement": "free,0", "-bc_push_at": "0,0.1",
            "-bc_push_force": f"0,{-force}", "-probe_names": "p", "-probe_p_at": "0,0.1", "-probe_p_field": "displacement"}  # fmt: skip
        sunk = -pdxtools.read_curve(self.solve(points).directory / "probe_p.csv")["displacement_y"][-1] / force
        for body in ({}, {"-kinematics": "finite"}, {"-analysis": "implicit", "-material_density": "1", "-ts_dt": "1", "-ts_max_time": "4",
                                                     "-ts_alpha_radius": "0", "-bc_top_history": "ramp", "-bc_top_history_width": "2"}):  # fmt: skip
            run = self.solve(self.PINNED | body, 2 if body else 1)
            last = run.history()[-1]
            compliance = sunk + (1.0 + 0.5) / E  # of the beam, of the layers at the pins
            self.assertAlmostEqual(-last["reaction_top_y"] * compliance / 1e-3, 1.0, delta=2e-3)
            self.assertAlmostEqual(last["reaction_left_y"] / last["reaction_right_y"], 1.0, delta=1e-6)
            self.assertAlmostEqual(2 * last["reaction_left_y"] / -last["reaction_top_y"], 1.0, delta=1e-6)
            stored = last["energy_elements"] + last["energy_supports"]
            self.assertAlmostEqual(stored / last["work"], 1.0, delta=3e-3)
            self.assertAlmostEqual(last["work"] / (0.5e-3 * -last["reaction_top_y"]), 1.0, delta=3e-3)

    def test_pins_at_rest_meet_particles_on_any_ranks_and_layouts(self):
        options = self.PINNED | {
            "-mesh_cells": "48,4", "-pd_patches": "-0.1,0,0.1,0.1", "-pd_spacing": "0.0125", "-pd_horizon_ratio": "3",
            "-bc_mid_box": "-0.101,0.04,-0.099,0.06", "-bc_top_at": "0.00625,0.14", "-load_steps": "4", "-output_fields": ""}  # fmt: skip
        one, two = program.in_pairs(lambda ranks: self.solve(options, ranks), (1, 2))
        for run in (two, self.solve(options | {"-layout_renew_interval": "1"})):
            self.assert_same_displacement(one, run, 1e-8)
            for name in ("work", "energy_supports", "reaction_top_y", "reaction_left_y"):
                a, b = one.history()[-1][name], run.history()[-1][name]
                self.assertAlmostEqual(a / b, 1.0, delta=1e-7, msg=name)

    def test_a_disc_that_flies_into_a_pin_keeps_its_energy(self):
        run = self.solve({  # nodes out of its shape bear next to nothing: a pin that pushed them made five times its energy
            "-analysis": "explicit", "-material_young": "1e7", "-material_density": f"{RHO}", "-mpm_bodies": "a", "-mpm_a_disc": "0,0,0.1",
            "-mpm_a_velocity": "8.660254,5", "-mpm_spacing": "0.01", "-bc_names": "p", "-bc_p_pin": "0.05", "-bc_p_at": "0.155884573,0.09",
            "-ts_max_time": "6e-3", "-output_history": "", "-quiet": ""})  # fmt: skip
        self.assertGreater(max(row["energy_supports"] for row in run.history()), 100.0)
        self.assertLess(run.summary["results"]["energy_drift_ratio"], 1e-2)

    def test_a_pin_that_lies_at_a_body_takes_no_force_of_rounding(self):
        run = self.launch({  # 0.24 + 0.05 is not quite 0.29
            "-analysis": "implicit", "-material_young": f"{E}", "-material_density": f"{RHO}", "-mpm_bodies": "b", "-mpm_b_box": "0,0,0.24,0.08",
            "-mpm_spacing": "0.01", "-bc_names": "floor,q", "-bc_floor_on": "left", "-bc_floor_displacement": "0,0", "-bc_q_pin": "0.05",
            "-bc_q_at": "0.29,0.04", "-ts_dt": "1e-4", "-ts_max_time": "3e-4", "-output_history": "", "-quiet": ""})  # fmt: skip
        self.assertEqual(run.status, 0, run.err)
        self.assertEqual(run.history()[-1]["reaction_q_x"], 0.0)

    def test_pins_that_touch_nothing_hold_nothing(self):
        run = self.launch(self.PINNED | {"-bc_right_at": "0.5,-0.06", "-bc_left_at": "-0.5,-0.06"})
        self.assertEqual(run.status, 1, run.err)
        self.assertIn("can", run.err)
        self.assertIn("rotate", run.err)


class Restarts(program.ProgramTest):
    def test_supports_go_on_from_a_checkpoint(self):
        options = SQUARE | {
            "-analysis": "explicit", "-material_density": f"{RHO}", "-ts_dt": "2e-5", "-bc_names": "slope,springs,turned,pin,pull",
            "-bc_slope_on": "bottom", "-bc_slope_box": "-1,-1,0.9,1", "-bc_slope_roller": "1,2", "-bc_springs_on": "top", "-bc_springs_spring": "1e9,1e8",
            "-bc_turned_on": "right", "-bc_turned_turn": "1e-3", "-bc_turned_centre": "1,2", "-bc_turned_history": "ramp",
            "-bc_turned_history_width": "2e-3", "-bc_pin_pin": "0.2", "-bc_pin_at": "-0.201,0.5", "-bc_pin_velocity": "2,0",
            "-bc_pin_history_expression": "sin(1e3*t)", "-bc_pull_body": "0,1e6", "-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.0625",
            "-pd_horizon_ratio": "3", "-output_fields": "", "-output_interval": "1000", "-output_history_interval": "1"}  # fmt: skip
        whole = self.solve(options | {"-ts_max_time": "2e-3"})
        half = self.solve(options | {"-ts_max_time": "2e-3", "-ts_max_steps": "50", "-checkpoint_interval": "50"})
        for ranks in (1, 2):
            on = self.solve(options | {"-ts_max_time": "2e-3", "-restart": str(half.directory / "checkpoint.h5")}, ranks)
            self.assert_same_displacement(whole, on, 1e-11)
            last, other = whole.history()[-1], on.history()[-1]
            for name in ("work", "energy_supports", "reaction_slope_x", "reaction_springs_y", "reaction_pin_x", "moment_turned"):
                self.assertAlmostEqual(last[name], other[name], delta=1e-9 * max(abs(last["work"]), abs(last[name])), msg=name)
        self.assertGreater(max(row["reaction_pin_x"] for row in whole.history()), 0)
        self.assertLess(whole.summary["results"]["energy_drift_ratio"], 1e-2)


class Formulas(program.ProgramTest):
    def test_a_plate_moved_by_a_formula_is_where_it_says(self):
        formula = "min(t/1e-3, 1)*sin(2*pi*t/1e-3) + 0.5*(t/1e-3)^2"
        run = self.solve(SQUARE | {
            "-analysis": "explicit", "-material_density": f"{RHO}", "-ts_max_time": "2e-3", "-bc_names": "all", "-bc_all_box": "-1,-1,2,2",
            "-bc_all_displacement": "1e-3,free", "-bc_all_history_expression": formula, "-output_history": None, "-probe_names": "a",
            "-probe_a_at": "0.5,0.5", "-probe_a_field": "displacement"})  # fmt: skip
        probe = pdxtools.read_curve(run.directory / "probe_a.csv")
        t = np.asarray(probe["time"]) / 1e-3
        expected = 1e-3 * (np.minimum(t, 1) * np.sin(2 * np.pi * t) + 0.5 * t**2)
        self.assertLess(np.abs(np.asarray(probe["displacement_x"]) - expected).max(), 1e-12)

    def test_a_velocity_by_a_formula_adds_up(self):
        run = self.solve(SQUARE | {
            "-analysis": "explicit", "-material_density": f"{RHO}", "-ts_max_time": "2e-3", "-bc_names": "all", "-bc_all_box": "-1,-1,2,2",
            "-bc_all_velocity": "3,free", "-bc_all_history_expression": "exp(-t/1e-3)*step(t-5e-4)", "-output_history": None,
            "-probe_names": "a", "-probe_a_at": "0.5,0.5", "-probe_a_field": "displacement"})  # fmt: skip
        probe = pdxtools.read_curve(run.directory / "probe_a.csv")
        t = np.asarray(probe["time"])
        expected = np.where(t < 5e-4, 0, 3e-3 * (math.exp(-0.5) - np.exp(-t / 1e-3)))
        self.assertLess(np.abs(np.asarray(probe["displacement_x"]) - expected).max(), 1e-10)


if __name__ == "__main__":
    program.main()
