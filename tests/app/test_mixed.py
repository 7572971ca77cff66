"""Material points beside elements and particles: contact between all three, bulk that becomes particles, ranks, restarts.

Usage: test_mixed.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import program

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
# A bar that is pulled apart by its own motion until it becomes particles in its middle and breaks there.
EARLY, LATE = "2095", "2110"  # steps before and after what is held by waves becomes particles


class Mixed(program.ProgramTest):
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
