"""Material points beside elements and particles: contact between all three, bulk that becomes particles, ranks, restarts.

Usage: test_mixed.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import re

import numpy as np
import program
from pdxtools import draw

STEEL = {
    "-analysis": "explicit",
    "-material_young": "190e9",
    "-material_poisson": "0.33333333333333333",
    "-material_density": "8000",
    "-pd_spacing": "1e-3",
    "-pd_horizon_ratio": "3",
    "-mpm_spacing": "1e-3",
    "-output_history": "",
    "-output_history_interval": "5",
    "-quiet": "",
}
# A bar of points strikes a block of elements with a patch of particles in its middle, and leaves it.
STRUCK = STEEL | {
    "-mesh_lower": "0,-0.02",
    "-mesh_upper": "0.04,0.02",
    "-mesh_cells": "20,20",
    "-pd_patches": "0.014,-0.006,0.026,0.006",
    "-mpm_bodies": "bar",
    "-mpm_bar_box": "-0.04,-0.01,0,0.01",
    "-mpm_bar_velocity": "10,0",
    "-ts_max_time": "30e-6",
    "-ts_safety": "0.5",
}
# The same bar strikes particles at the side of another body of points.
ON_PARTICLES = {key: value for key, value in STRUCK.items() if not key.startswith("-mesh_")} | {
    "-mpm_bodies": "bar,block",
    "-mpm_block_box": "0,-0.02,0.04,0.02",
    "-pd_patches": "0,-0.006,0.012,0.006",
}
# A pulse of tension runs through a bar: it becomes particles before it, and points again behind it.
PULSE = STEEL | {
    "-mpm_bodies": "bar",
    "-mpm_bar_box": "0,0,0.08,0.01",
    "-adapt": "expand",
    "-adapt_trigger": "stretch",
    "-adapt_stretch": "0.02",
    "-pd_critical_stretch": "0.02",
    "-bc_names": "pull",
    "-bc_pull_on": "left",
    "-bc_pull_traction": "-115e6,0",
    "-bc_pull_history": "gaussian",
    "-bc_pull_history_time": "6e-6",
    "-bc_pull_history_width": "2e-6",
    "-ts_max_time": "38e-6",
    "-ts_dt": "0.1e-6",
}
# A block that flies onto a bar with a crack, held at its right end: both become particles where they bear much, and break.
DROPPED = STEEL | {
    "-mpm_bodies": "bar,block",
    "-mpm_bar_box": "0,0,0.04,0.012",
    "-mpm_block_box": "0.0163,0.0132,0.0243,0.0212",
    "-mpm_block_velocity": "0,-400",
    "-crack_names": "crack",
    "-crack_crack_points": "0.02,0,0.02,0.006",
    "-adapt": "expand",
    "-adapt_trigger": "connection,damage",
    "-pd_critical_stretch": "0.003",
    "-bc_names": "right",
    "-bc_right_of": "bar",
    "-bc_right_on": "right",
    "-bc_right_displacement": "0,0",
    "-ts_max_time": "8e-6",
    "-ts_safety": "0.5",
}
# A square that spins so fast that all of it becomes particles.
SPINNING = STEEL | {
    "-mpm_bodies": "square",
    "-mpm_square_box": "0,0,0.04,0.04",
    "-mpm_square_spin": "2000",
    "-adapt": "expand",
    "-adapt_trigger": "stretch",
    "-adapt_stretch": "0.001",
    "-adapt_margin": "10",
    "-pd_critical_stretch": "0.02",
    "-ts_max_time": "30e-6",
}
# A strip with two holes that is pulled by its ends; bonds 2 mm apart break at 23 MPa or less.
HOLES = {
    "-analysis": "explicit",
    "-material": "pmma",
    "-material_poisson": "1/3",
    "-mpm_bodies": "strip",
    "-mpm_strip_box": "0,0,80mm,48mm",
    "-mpm_strip_hole": "30mm,18mm,6mm,50mm,30mm,6mm",
    "-mpm_spacing": "2mm",
    "-pd_spacing": "2mm",
    "-adapt": "expand",
    "-adapt_trigger": "stress",
    "-adapt_stress": "40MPa",
    "-bc_names": "left,right",
    "-bc_left_on": "left",
    "-bc_left_velocity": "-2,0",
    "-bc_right_on": "right",
    "-bc_right_velocity": "2,0",
    "-ts_max_time": "200us",
    "-output_fields": "",
    "-output_interval": "1000000",
    "-output_history": "",
}
# A bar that is pulled apart by its own motion until it becomes particles in its middle and breaks there.
EARLY, LATE = "2095", "2110"  # steps before and after what is held by waves becomes particles


# A body 11 mm high, in cells of 2 mm, on which another falls: the uppermost cells of one reach into the box of the other.
SOFT = {
    "-analysis": "explicit",
    "-material_young": "1e9",
    "-material_poisson": "1/3",
    "-material_density": "1000",
    "-mpm_spacing": "1e-3",
    "-pd_spacing": "1e-3",
    "-pd_critical_stretch": "0.5",
    "-adapt": "expand",
    "-adapt_trigger": "stress",
    "-adapt_stress": "6e6",
    "-quiet": "",
}
UNEVEN = SOFT | {
    "-mpm_bodies": "a,b",
    "-mpm_a_box": "0,0,0.02,0.011",
    "-mpm_b_box": "0,0.011,0.02,0.021",
    "-mpm_b_velocity": "0,-30",
    "-ts_max_time": "20e-6",
}
# A part of a body is thrown, to where its cells end, and becomes particles.
PART_THROWN = SOFT | {
    "-mpm_bodies": "a",
    "-mpm_a_box": "0,0,0.04,0.02",
    "-bc_names": "part",
    "-bc_part_box": "0,0,0.012,0.02",
    "-bc_part_initial_velocity": "20,0",
    "-adapt_stress": "5e6",
    "-output_history": "",
    "-ts_max_time": "60e-6",
}


class Mixed(program.ProgramTest):
    def test_cells_that_stick_out_of_their_body_are_none_of_its_neighbour_s(self):
        for ranks in (1, 2):
            run = self.solve(UNEVEN, ranks)
            self.assertGreater(run.summary["relocations"], 1)
            self.assertLess(run.summary["results"]["momentum_error_ratio"], 1e-12)

    def test_the_start_is_that_of_the_first_layout(self):
        # Nodes of points at the edge of the box move, of particles those inside alone: the start is not to be asked again.
        whole = self.solve(PART_THROWN)
        self.assertGreater(whole.summary["relocations"], 1)
        self.assertLess(whole.summary["results"]["momentum_error_ratio"], 1e-12)
        rows, directory = whole.history(), self.scratch / "again"
        turning = max(abs(row["angular_momentum_z"] - rows[0]["angular_momentum_z"]) for row in rows)
        self.assertLess(turning, 1e-12 * rows[0]["momentum_x"] * 0.02)
        middle = str(int(rows[-1]["step"]) - 3)
        self.solve(PART_THROWN | {"-ts_max_steps": middle, "-checkpoint_interval": middle}, 1, directory)
        rest = self.solve(PART_THROWN | {"-restart": str(directory / "checkpoint.h5")}, 1, directory)
        for name in ("momentum_error_ratio", "initial_energy"):
            self.assertEqual(rest.summary["results"][name], whole.summary["results"][name], name)

    def test_probes_know_the_velocity_of_all_that_moves(self):
        # Elements and particles, which are struck, and points, which strike. Steps are central differences, the last is shorter.
        places = {"e": "0.005,0", "p": "0.02,0.001", "m": "-0.0105,0.0005"}
        probes = {"-probe_names": ",".join(places), "-ts_max_time": "6e-6", "-output_history_interval": "1"}
        for name, place in places.items():
            probes |= {f"-probe_{name}_at": place, f"-probe_{name}_field": "displacement,velocity"}
        run = self.solve(STRUCK | probes)
        for name in places:
            time, u, v = (np.array([row[key] for row in program.rows_of(run.directory / f"probe_{name}.csv")])
                          for key in ("time", "displacement_x", "velocity_x"))  # fmt: skip
            self.assertGreater(abs(v).max(), 0.1 * 10.0, name)
            rate = (u[2:-1] - u[:-3]) / (time[2:-1] - time[:-3])
            self.assertLess(abs(rate - v[1:-2]).max(), 1e-10 * 10.0, name)

    def test_bodies_of_all_kinds_strike_each_other(self):
        for scene in (STRUCK, ON_PARTICLES):
            one = self.solve(scene)
            results = one.summary["results"]
            self.assertLess(results["momentum_error_ratio"], 1e-12)
            self.assertLess(results["energy_drift_ratio"], 1e-3)
            # As waves of one impedance hand it over: half of the speed stays in a longer block than bar at the most.
            last = one.history()[-1]
            self.assertLess(last["velocity_bar_x"], 0.3 * 10.0)
            self.assertEqual(last["contact_bar_" + ("mesh" if scene is STRUCK else "block") + "_force_x"], 0.0)
            for ranks in (2, 3):
                other = self.solve(scene, ranks).history()[-1]
                for name in ("velocity_bar_x", "energy_points", "energy_bonds", "energy_residual"):
                    scale = last["energy_points"] if name.startswith("energy") else 10.0
                    self.assertLess(abs(other[name] - last[name]), 1e-10 * scale, name)

    def test_damage_of_a_body_without_a_crack_is_none_of_the_crack_s(self):
        runs = [self.solve(DROPPED, ranks) for ranks in (1, 2)]
        self.assertEqual(runs[0].history()[-1]["bonds_broken"], runs[1].history()[-1]["bonds_broken"])
        for run in runs:
            tips = run.summary["results"]["tips"]
            self.assertEqual([tip["start"] for tip in tips], [[0.02, 0.006]] * len(tips))
            self.assertTrue(all(tip["at"][1] < 0.012 for tip in tips), tips)
            self.assertNotIn("momentum_error_ratio", run.summary["results"])  # whichever rank holds what is held

    def test_a_strip_with_two_holes_breaks_and_says_so(self):
        run = self.launch(HOLES)
        self.assertEqual(run.status, 0, run.err)
        # Cells of 4 mm with their middle within 6 mm of a hole's: of (30, 18) 6, of (50, 30) 6; 4 points each.
        near = [(x, y) for x in range(2, 80, 4) for y in range(2, 48, 4)
                if any((x - a) ** 2 + (y - b) ** 2 < 36 * (1 - 1e-9) for a, b in ((30, 18), (50, 30)))]  # fmt: skip
        self.assertEqual(run.history()[0]["points"], 4 * (20 * 12 - len(near)))
        self.assertIn("bonds: none before bulk becomes particles\n", run.out)
        broken = int(re.search(r"(?m)^(\d+) bonds broken, ([\d.]+) J$", run.out)[1])
        self.assertEqual(broken, run.summary["bonds_broken"])
        self.assertGreater(broken, 0)
        self.assertRegex(run.err, r"-adapt_stress is 4e\+07 Pa, but bonds 0\.002 m apart break at \d\S* Pa")
        self.solve(HOLES | {"-adapt_stress": "5MPa", "-ts_max_steps": "2"})  # without a word

        picture = draw.Run(run.directory)  # of particles in the midst of points both are drawn
        lower, upper = (1e3 * edge(draw.extent_of(picture, 0.0) / picture.metre, axis=0) for edge in (np.min, np.max))
        self.assertLess(abs(np.concatenate([lower - 1, upper - [79, 47]])).max(), 1.1)
        self.assertGreater(len(picture.particles.points), 0)

    def test_nothing_is_paid_for_what_is_not_there(self):
        events = self.solve(STRUCK | {"-contact": "none", "-ts_max_time": "2e-6"}).events
        self.assertFalse([name for name in events if name.startswith(("contact_", "adapt_", "pd_break"))])
        alone = {key: value for key, value in STRUCK.items() if not key.startswith("-mpm_")}
        thrown = {"-bc_names": "all", "-bc_all_initial_velocity": "1,0"}
        events = self.solve(alone | thrown | {"-ts_max_time": "2e-6"}).events
        self.assertFalse([name for name in events if name.startswith(("mpm_", "contact_"))])

    def test_cells_at_rest_beside_particles_are_skipped_without_changing_a_bit(self):
        # The bar flies and all of it moves; of the block it has struck a wave has gone half through.
        some, every = (self.solve(ON_PARTICLES | {"-ts_max_time": "4e-6", "-mpm_skip_rest": how}, 2) for how in ("1", "0"))
        computed, skipped = (some.summary["results"][f"mpm_cells_{what}"] for what in ("computed", "skipped"))
        self.assertGreater(skipped, 0.05 * computed)
        self.assertEqual(every.summary["results"]["mpm_cells_computed"], computed + skipped)
        self.assertEqual(some.history(), every.history())

    def spall(self, options, ranks=1, directory=None):
        return self.solve({"-options_file": "cases/spallation/case.opts", "-quiet": ""} | options, ranks, directory)

    def test_a_bar_spalls_alike_on_any_number_of_ranks(self):
        runs = [self.spall({}, ranks) for ranks in (1, 2, 3)]
        for run in runs:
            results = run.summary["results"]
            self.assertTrue(0.039 <= results["spall_position"] <= 0.041, results["spall_position"])
            self.assertTrue(1.00e-3 <= results["spall_time"] <= 1.06e-3, results["spall_time"])
            self.assertLess(results["energy_drift_ratio"], 1e-4)
        rows = [run.history()[-1] for run in runs]
        for row in rows[1:]:
            self.assertEqual(row["bonds_broken"], rows[0]["bonds_broken"])
            self.assertAlmostEqual(row["energy_fracture"] / rows[0]["energy_fracture"], 1.0, delta=1e-10)

    def test_particles_that_are_quiet_become_points_again(self):
        quiet = PULSE | {"-adapt_hand_back": "40"}
        one, two = (self.solve(quiet, ranks) for ranks in (1, 2))
        rows = one.history()
        points = [row["points"] for row in rows]
        self.assertLess(min(points), 0.9 * points[0])
        self.assertEqual(points[-1], points[0])
        self.assertLess(one.summary["results"]["energy_drift_ratio"], 1e-3)
        last = rows[-1]["momentum_x"]  # of the pull alone, which is over after 20 us
        for row in rows:
            self.assertTrue(row["time"] < 20e-6 or abs(row["momentum_x"] - last) < 1e-12 * abs(last), row["time"])
        other = two.history()
        self.assertEqual([row["points"] for row in other], points)
        self.assertLess(abs(other[-1]["energy_points"] - rows[-1]["energy_points"]), 1e-9 * rows[-1]["work"])
        directory, middle = self.scratch / "again", str(int(rows[points.index(min(points))]["step"]) + 30)
        self.solve(quiet | {"-ts_max_steps": middle, "-checkpoint_interval": middle}, 1, directory)
        rest = self.solve(quiet | {"-restart": str(directory / "checkpoint.h5")}, 1, directory)
        self.assertEqual(rest.history(), rows)

    def test_a_body_that_spins_keeps_its_angular_momentum_when_it_converts(self):
        for coarser in (1, 2):
            rows = self.solve(SPINNING | {"-mpm_spacing": repr(coarser * 1e-3)}).history()
            self.assertEqual(rows[-1]["points"], 0)
            turning = rows[0]["angular_momentum_z"]
            for row in rows:
                self.assertLess(abs(row["angular_momentum_z"] - turning), 1e-12 * turning)

    def test_a_section_beside_a_hole_is_told(self):
        # Half of the bar's height is missing between 40 and 42 mm, where plane waves would part it too.
        for ranks in (1, 2):
            results = self.spall({"-mpm_bar_hole": "0.041,0.001,0.0009"}, ranks).summary["results"]
            self.assertTrue(0.040 <= results["spall_position"] <= 0.042, results["spall_position"])
            self.assertTrue(1.00e-3 <= results["spall_time"] <= 1.07e-3, results["spall_time"])

    def test_a_step_that_is_too_long_beside_particles_becomes_shorter(self):
        # Points alone take steps twice as long as particles: the one given ends where the first particles come.
        begin = self.spall({"-ts_max_steps": "1", "-ts_dt": None}).summary["results"]["stable_step"]
        long = {"-ts_dt": repr(0.9 * begin), "-ts_max_time": "1.3e-3"}
        case = {"-options_file": "cases/spallation/case.opts", "-quiet": ""} | long
        whole = self.launch(case)
        self.assertEqual(whole.status, 0, whole.err)
        warnings = [line for line in whole.err.splitlines() if "-ts_dt of" in line]
        self.assertEqual(len(warnings), 1, warnings)
        results = whole.summary["results"]
        self.assertLess(results["step_length"], 0.8 * begin)
        self.assertTrue(0.039 <= results["spall_position"] <= 0.041)
        rows, directory = whole.history(), self.scratch / "long"
        later = str(next(int(row["step"]) for row in rows if row["points"] < rows[0]["points"]) + 5)
        self.launch(case | {"-ts_max_steps": later, "-checkpoint_interval": later}, directory=directory)
        rest = self.launch(case | {"-restart": str(directory / "checkpoint.h5")}, directory=directory)
        self.assertEqual(rest.status, 0, rest.err)
        self.assertEqual(rows, rest.history())

    def test_a_restart_between_conversions_goes_on_to_the_last_bit(self):
        whole = self.spall({})
        for step in (EARLY, LATE):
            directory = self.scratch / f"stopped_{step}"
            self.spall({"-ts_max_steps": step, "-checkpoint_interval": step}, 1, directory)
            rest = self.spall({"-restart": str(directory / "checkpoint.h5")}, 1, directory)
            self.assertEqual(whole.history(), rest.history())
            self.assertEqual(whole.summary["results"]["spall_time"], rest.summary["results"]["spall_time"])


if __name__ == "__main__":
    program.main()
