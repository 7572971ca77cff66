"""Material points in space beside particles: points that become particles, ranks, restarts, contact.

Usage: test_space.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import program

BAR = {"-options_file": "cases/bar_in_space/case.opts", "-quiet": ""}
STEEL = {
    "-analysis": "explicit",
    "-material_plane": "solid",
    "-material_young": "190e9",
    "-material_poisson": "0.25",
    "-material_density": "8000",
    "-mpm_spacing": "1e-3",
    "-pd_spacing": "1e-3",
    "-pd_horizon_ratio": "3.015",
    "-output_history": "",
    "-output_history_interval": "5",
    "-quiet": "",
}
# A bar strikes particles at the side of a block, which has more of them in its middle.
STRUCK = STEEL | {
    "-mpm_bodies": "bar,block",
    "-mpm_bar_box": "-0.01,-0.002,-0.002,0,0.002,0.002",
    "-mpm_bar_velocity": "10,0,0",
    "-mpm_block_box": "0,-0.004,-0.004,0.016,0.004,0.004",
    "-pd_patches": "0,-0.002,-0.002,0.004,0.002,0.002,0.008,-0.002,-0.002,0.012,0.002,0.002",
    "-ts_max_time": "10e-6",
    "-ts_safety": "0.5",
}
# A cube that spins so fast that all of it becomes particles.
SPINNING = STEEL | {
    "-mpm_bodies": "cube",
    "-mpm_cube_box": "0,0,0,0.012,0.012,0.012",
    "-mpm_cube_spin": "3000,6000,2000",
    "-adapt": "expand",
    "-adapt_trigger": "stretch",
    "-adapt_stretch": "0.001",
    "-adapt_margin": "6",
    "-pd_critical_stretch": "0.02",
    "-ts_max_time": "10e-6",
}


class Space(program.ProgramTest):
    def test_bodies_of_points_and_particles_strike_each_other(self):
        runs = [self.solve(STRUCK, ranks) for ranks in (1, 2, 3)]
        results = runs[0].summary["results"]
        self.assertLess(results["momentum_error_ratio"], 1e-12)
        self.assertLess(results["energy_drift_ratio"], 1e-3)
        last = runs[0].history()[-1]
        self.assertLess(last["velocity_bar_x"], 0.5 * 10.0)  # a block of twice the length and four times the section
        for other in runs[1:]:
            row = other.history()[-1]
            for name in ("velocity_bar_x", "energy_points", "energy_bonds", "energy_interface"):
                scale = last["energy_points"] if name.startswith("energy") else 10.0
                self.assertLess(abs(row[name] - last[name]), 1e-10 * scale, name)

    def test_a_bar_spalls_alike_on_any_number_of_ranks(self):
        # Plane waves: .0400 m, 1.000 ms; mpm.md section 5 for 1 mm.
        runs = [self.solve(BAR, ranks) for ranks in (1, 2, 3)]
        first = runs[0].summary["results"]
        for run in runs:
            results = run.summary["results"]
            self.assertTrue(0.039 <= results["spall_position"] <= 0.041, results["spall_position"])
            self.assertTrue(1.00e-3 <= results["spall_time"] <= 1.06e-3, results["spall_time"])
            self.assertEqual(results["spall_body"], "bar")
            self.assertEqual(results["bonds_broken"], first["bonds_broken"])
            self.assertLess(abs(results["fracture_energy"] - first["fracture_energy"]), 1e-10 * first["fracture_energy"])
            self.assertLess(results["energy_drift_ratio"], 1e-3)

    def test_a_restart_between_conversions_changes_nothing(self):
        whole = self.solve(BAR)
        for step in ("2080", "2200"):
            directory = self.scratch / f"stopped_{step}"
            self.solve(BAR | {"-ts_max_steps": step, "-checkpoint_interval": step}, 1, directory)
            rest = self.solve(BAR | {"-restart": str(directory / "checkpoint.h5")}, 1, directory)
            self.assertEqual(whole.summary["results"]["spall_time"], rest.summary["results"]["spall_time"])
            self.assertEqual(whole.history(), rest.history())

    def test_a_cube_that_spins_keeps_its_momenta_as_it_becomes_particles(self):
        run = self.solve(SPINNING, 2)
        first, last = run.history()[0], run.history()[-1]
        self.assertGreater(run.summary["results"]["relocations"], 0)
        self.assertEqual(last["points"], 0)
        scale = sum(first[f"angular_momentum_{axis}"] ** 2 for axis in "xyz") ** 0.5
        for axis in "xyz":
            self.assertLess(abs(last[f"angular_momentum_{axis}"] - first[f"angular_momentum_{axis}"]), 1e-3 * scale)


if __name__ == "__main__":
    program.main()
