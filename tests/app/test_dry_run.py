"""A dry run says beforehand what the run then is, writes what it begins with, and touches nothing else."""

import program
from torn import TORN

import h5py

IN_TIME = TORN | {"-ts_max_steps": None, "-ts_max_time": "2e-4", "-output_fields": "", "-output_interval": "40"}
AT_REST = program.PATCH | {"-load_steps": "3", "-output_fields": ""}


class DryRun(program.ProgramTest):
    def dry(self, options, ranks=1, directory=None):
        run = self.solve(options | {"-dry_run": ""}, ranks, directory)
        self.assertEqual(run.files, ["dry_run"])
        inner = program.Run(run.status, run.out, run.err, run.directory / "dry_run")
        self.assertEqual(inner.summary["status"], "dry run")
        return inner

    def assert_begins_with(self, dry, time):
        with h5py.File(dry.directory / "fields.h5") as file:
            self.assertEqual(list(file), ["step000000"])
            self.assertEqual(file["step000000"].attrs["time"], time)
            for block in file["step000000"].values():
                self.assertFalse(block["displacement"][()].any())

    def assert_foreseen(self, dry, run):
        self.assertEqual(dry.summary["unknowns"], run.summary["unknowns"])
        told = dry.summary["results"]
        with h5py.File(run.directory / "fields.h5") as file:
            self.assertEqual(told["field_sets"], len(file))
        size = (run.directory / "fields.h5").stat().st_size
        self.assertAlmostEqual(told["field_sets"] * told["bytes_per_field_set"] / size, 1, delta=0.35)
        self.assertGreater(told["memory_mb_largest"], 5)
        self.assertGreaterEqual(told["memory_mb_all"], told["memory_mb_largest"])

    def test_steps_are_foreseen(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                dry, run = self.dry(IN_TIME, ranks), self.solve(IN_TIME, ranks)
                self.assert_begins_with(dry, 0)
                told = dry.summary["results"]
                self.assertEqual(told["steps"], run.summary["steps"])
                self.assertEqual(told["step_length"], run.summary["results"]["step_length"])
                self.assertGreater(told["steps_timed"], 2)
                expected = dry.summary["wall_seconds"]["setup"] + told["steps"] * told["seconds_per_step"]
                self.assertGreaterEqual(told["estimated_seconds"], 0.999 * expected)
                self.assertLess(told["estimated_seconds"], expected + 10 * told["seconds_per_field_set"] + 1)
                self.assert_foreseen(dry, run)

    def test_a_solve_is_foreseen(self):
        dry, run = self.dry(AT_REST), self.solve(AT_REST | {"-load_steps": "1"})
        self.assert_begins_with(dry, 0)
        told = dry.summary["results"]
        self.assertEqual(told["loads"], 3)
        self.assertEqual(told["linear_iterations_per_solve"], run.summary["linear_iterations"])
        self.assert_foreseen(dry, self.solve(AT_REST))

    def test_of_every_kind_of_scene(self):
        cloud = {"-case": "cloud", "-mpm_bodies": "a", "-mpm_spacing": "0.1", "-mpm_a_box": "0,0,1,1", "-mpm_a_velocity": "1,0",
                 "-material_young": "1e9", "-material_density": "1000", "-analysis": "explicit", "-ts_max_steps": "50",
                 "-quiet": ""}  # fmt: skip
        implicit = program.SMALL | {"-analysis": "implicit", "-material_density": "1000", "-ts_dt": "1e-5", "-ts_max_steps": "9"}
        for options, steps in ((cloud, 50), (implicit, 9)):
            self.assertEqual(self.dry(options).summary["results"]["steps"], steps)

    def test_says_it_in_words(self):
        run = self.solve(IN_TIME | {"-dry_run": "", "-quiet": None}, 2)
        for line in (r"bonds: \d+ between particles; a full family has 24 bonds within 0\.003 m \(3 spacings of 0\.001 m\)",
                     r"stable limit [\d.e-]+ s", r"a step of [\d.e-]+ s takes [\d.e-]+ s", r"memory: \d+ MB .* \d+ MB on all",
                     r"fields\.h5: \d+ sets of [\d.]+ [kM]B", r"the run on 2 ranks: about "):  # fmt: skip
            self.assertRegex(run.out, line)

    def test_results_of_an_earlier_run_stay(self):
        run = self.solve(IN_TIME | {"-ts_max_time": "2e-5"})
        before = {name: (run.directory / name).read_bytes() for name in run.files}
        self.solve(IN_TIME | {"-dry_run": ""}, directory=run.directory)
        self.assertEqual(run.files, sorted([*before, "dry_run"]))
        self.assertEqual({name: (run.directory / name).read_bytes() for name in before}, before)

    def test_a_mistake_is_one(self):
        for change, words in (({"-bc_top_on": "nowhere"}, "no such boundary"), ({"-pd_spacing": "0.0007"}, "-pd_spacing")):
            run = self.launch(IN_TIME | change | {"-dry_run": ""})
            self.assertEqual(run.status, 1)
            self.assertRegex(run.err, words)


if __name__ == "__main__":
    program.main()
