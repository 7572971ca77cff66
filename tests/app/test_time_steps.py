"""Steps in time as a user meets them: limits, runs gone wild, and when fields are written.

Usage: test_time_steps.py PDXSOLVE [unittest arguments].
"""

import h5py
import program
from program import SMALL_PATCH, pdxtools

# The small plate with a patch, hit at one corner: every frequency moves.
HIT = SMALL_PATCH | {
    "-analysis": "explicit",
    "-material_young": "1",
    "-material_density": "1",
    "-bc_names": "hit",
    "-bc_clamp_on": None,
    "-bc_clamp_displacement": None,
    "-bc_load_on": None,
    "-bc_load_traction": None,
    "-bc_hit_box": "0,0,0.3,0.3",
    "-bc_hit_initial_velocity": "1e-3,2e-3",
    "-ts_max_steps": "2000",
}

class Limit(program.ProgramTest):
    def limit(self):
        return self.solve(HIT | {"-ts_max_steps": "1"}).summary["results"]["stable_step"]

    def wild(self, step):
        return self.launch(HIT | {"-ts_dt": f"{step:.17g}", "-ts_allow_unstable": "", "-output_fields": ""})

    def test_a_step_above_the_bound_is_refused(self):
        step = 1.02 * self.limit()
        run = self.launch(HIT | {"-ts_dt": f"{step:.17g}"})
        self.assertEqual(run.status, 1)
        self.assertIn("above the stable limit", run.err)
        self.assertIn("-ts_allow_unstable", run.err)

    def test_a_step_above_the_true_limit_is_caught_and_the_last_sound_state_kept(self):
        low, high = self.limit(), 3.0 * self.limit()  # stable, wild
        self.assertEqual(self.wild(low).status, 0)
        while high / low > 1.01:
            middle = (low * high) ** 0.5
            low, high = (low, middle) if self.wild(middle).status == 2 else (middle, high)
        run = self.wild(1.02 * high)
        self.assertEqual(run.status, 2)
        self.assertIn("grew beyond all work done", run.err)
        self.assertEqual(run.summary["status"], "failed")
        self.assertLessEqual(run.summary["steps"], 200)
        results = run.summary["results"]
        self.assertLessEqual(results["kinetic_energy"], 2.0 * results["initial_energy"])
        time, blocks = pdxtools.read_step(run.directory)
        self.assertEqual(time, results["time"])
        for block in blocks.values():
            self.assertLess(abs(block["displacement"]).max(), 0.1)

class Histories(program.ProgramTest):
    def test_points_of_a_table_in_place(self):
        """A free plate under a body force b f(t): v = b / rho times the integral of f, kinetic energy m v^2 / 2 [closed form]."""
        pushed = HIT | {"-bc_hit_box": None, "-bc_hit_initial_velocity": None, "-bc_hit_body": "3,4", "-bc_hit_history_points": "0:0,1:1,3000ms:0",
                        "-ts_max_steps": None, "-ts_max_time": "4", "-ts_safety": "0.2"}  # fmt: skip
        self.assertAlmostEqual(self.solve(pushed).summary["results"]["kinetic_energy"], 0.5 * (5 * 1.5) ** 2, delta=0.01)


class Ranks(program.ProgramTest):
    def test_without_particles_step_too(self):
        scene = HIT | {"-mesh_cells": "32,32", "-pd_patches": "0.125,0.125,0.25,0.25", "-output_fields": ""}
        scene |= {"-pd_spacing": "0.015625", "-ts_max_steps": "50"}
        one, three = self.solve(scene), self.solve(scene, 3)
        self.assertEqual(min(three.summary["partition"]["particles_per_rank"]), 0)
        self.assert_same_displacement(one, three, tolerance=1e-10)


class Fields(program.ProgramTest):
    def times(self, options):
        run = self.solve(HIT | {"-output_fields": "", "-ts_dt": "0.005", "-ts_max_steps": "100"} | options)
        with h5py.File(run.directory / "fields.h5", "r") as file:
            return [round(float(file[name].attrs["time"]), 9) for name in sorted(file)]

    def test_are_written_at_the_steps_nearest_to_the_times_asked_for(self):
        self.assertEqual(self.times({"-output_times": "0.2,0.101,0.1026,0.2001"}), [0.1, 0.105, 0.2, 0.5])

    def test_midway_between_steps_are_written_once(self):
        midway = [0.005 * (k + 0.5) for k in range(10, 90)]
        self.assertEqual(len(self.times({"-output_times": ",".join(f"{time:.4f}" for time in midway)})), len(midway) + 1)

    def test_are_written_at_times_and_intervals(self):
        self.assertEqual(self.times({"-output_times": "0.1", "-output_interval": "40"}), [0.1, 0.2, 0.4, 0.5])

    def test_times_beyond_the_end_are_left_out(self):
        self.assertEqual(self.times({"-output_times": "7"}), [0.5])

    def test_times_of_a_static_run_are_refused(self):
        run = self.launch(SMALL_PATCH | {"-output_times": "1"})
        self.assertEqual(run.status, 1)
        self.assertIn("-output_times", run.err)

if __name__ == "__main__":
    program.main()
