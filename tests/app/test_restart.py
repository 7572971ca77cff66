"""A run that is stopped, killed or cut in two ends like one that was left alone."""

import random
import signal
import subprocess
import time

import program
from torn import COUPLED, RUNNING, SHAPED, TABLES, TORN, checkpoint, results

import h5py
import numpy as np

KILLS = 20


class Restart(program.ProgramTest):
    CRACKS_REACH_BORDERS = True

    def cut_in_two(self, options, ranks, half=200):
        """Runs half of the scene and leaves its directory, with a checkpoint, to go on in."""
        directory = self.scratch / f"half_{self.runs}"
        self.solve(options | {"-ts_max_steps": str(half), "-checkpoint_interval": str(half)}, ranks, directory)
        return directory

    def go_on(self, options, ranks, directory):
        restart = {"-restart": str(directory / "checkpoint.h5"), "-checkpoint_interval": "400"}
        return self.solve(options | restart, ranks, directory)

    def start(self, options, directory, ranks=1):
        return subprocess.Popen(
            [*program.launcher(ranks), program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=program.ROOT,
        )

    def assert_same_bytes(self, a, b, names):
        for name in names:
            self.assertEqual((a / name).read_bytes(), (b / name).read_bytes(), name)

    def test_the_same_ranks_go_on_to_the_last_bit(self):
        for scene in (TORN, RUNNING, COUPLED, SHAPED):
            options = scene | {"-output_fields": "", "-output_interval": "100"}
            for ranks in (1, 2):
                with self.subTest(scene["-case"], ranks=ranks):
                    whole = self.solve(options | {"-checkpoint_interval": "400"}, ranks)
                    rest = self.go_on(options, ranks, self.cut_in_two(options, ranks))
                    self.assertGreater(whole.summary["bonds_broken"], 20)
                    self.assertEqual(results(whole), results(rest))
                    names = ("checkpoint.h5", "history.csv", "fields.xdmf", "crack_path.csv")
                    self.assert_same_bytes(whole.directory, rest.directory, names)
                    self.assert_same_displacement(whole, rest, tolerance=0.0)

    def test_other_ranks_go_on_to_rounding_with_the_same_broken_bonds(self):
        for scene in (TORN, RUNNING, COUPLED, SHAPED):
            for before, after in ((2, 1), (1, 3)):
                with self.subTest(scene["-case"], before=before, after=after):
                    whole = self.solve(scene | {"-checkpoint_interval": "400"}, before)
                    rest = self.go_on(scene, after, self.cut_in_two(scene, before))
                    (a, _), (b, _) = checkpoint(whole.directory), checkpoint(rest.directory)
                    self.assertEqual(a.keys(), b.keys())
                    for name in TABLES:
                        scale = np.abs(a[name]).max()
                        self.assertLessEqual(np.abs(a[name] - b[name]).max(), 1e-9 * scale, name)
                    for name in a.keys() - TABLES - {"rank_sums"}:
                        np.testing.assert_array_equal(a[name], b[name], name)
                    np.testing.assert_allclose(a["rank_sums"].sum(0), b["rank_sums"].sum(0), rtol=1e-9)
                    path, other = (program.rows_of(run.directory / "crack_path.csv") for run in (whole, rest))
                    self.assertEqual(len(path), len(other))
                    for row, other_row in zip(path, other):
                        self.assertEqual(row.keys(), other_row.keys())
                        for name in row:
                            self.assertAlmostEqual(row[name], other_row[name], delta=1e-9 * abs(row[name]), msg=name)

    def test_a_crack_runs_in_both_halves(self):
        rows = {row["step"]: row for row in self.solve(RUNNING).history()}
        grown = [rows[step]["crack_length"] for step in (10, 200, 400)]
        self.assertGreater(min(np.diff(grown)), 0.02)
        self.assertGreater(rows[400]["crack_tips"], 1)

    def test_bonds_that_leave_the_patch_are_among_the_broken(self):
        run = self.solve(COUPLED | {"-checkpoint_interval": "400"})
        self.assertGreater(len(checkpoint(run.directory)[0]["broken_carried_bonds"]), 0)
        self.assertGreater(run.summary["unknowns"]["enriched"], 0)

    def test_a_signal_leaves_a_checkpoint_and_is_no_failure(self):
        long = TORN | {"-ts_max_steps": "4000"}
        whole = self.solve(long | {"-checkpoint_interval": "4000"})
        for ranks, sig in ((1, signal.SIGTERM), (1, signal.SIGUSR1), (2, signal.SIGUSR1)):
            with self.subTest(sig=sig.name, ranks=ranks):
                directory = self.scratch / f"{sig.name}_{ranks}"
                process = self.start(long, directory, ranks)
                while process.poll() is None and not self.has_rows(directory, 5):
                    time.sleep(0.005)
                process.send_signal(sig)
                out, err = process.communicate(timeout=60)
                self.assertEqual((process.returncode, err), (0, ""))
                stopped = program.Run(0, out, err, directory)
                step = stopped.summary["steps"]
                file = str(directory / "checkpoint.h5")
                self.assertTrue(0 < step < 4000, step)
                self.assertIn(f"stopped by {sig.name} at step {step}, time ", out)
                self.assertIn(f"checkpoint written to {file}; go on with -restart {file}", out)
                self.assertEqual(stopped.summary["status"], "stopped")
                rest = self.go_on(long | {"-checkpoint_interval": None}, ranks, directory)
                self.assertEqual(rest.summary["status"], "done")
                self.assertEqual(rest.summary["bonds_broken"], whole.summary["bonds_broken"])
                if ranks == 1:
                    self.assertEqual(results(rest), results(whole))
                    self.assert_same_bytes(whole.directory, directory, ("history.csv",))

    def has_rows(self, directory, rows):
        path = directory / "history.csv"
        return path.exists() and path.read_bytes().count(b"\n") > rows

    def test_killed_at_any_moment_it_ends_the_same(self):
        options = RUNNING | {"-output_fields": "", "-output_interval": "25", "-checkpoint_interval": "7"}
        begin = time.monotonic()
        whole = self.solve(options)
        seconds = time.monotonic() - begin
        chance = random.Random(4)
        moments = [seconds * chance.uniform(0.1, 0.95) for _ in range(KILLS)]

        def kill_and_go_on(number):
            directory = self.scratch / f"killed_{number}"
            file = directory / "checkpoint.h5"
            process = self.start(options, directory)
            while number % 2 and process.poll() is None and not file.exists():  # half of them once there is one
                time.sleep(0.001)
            time.sleep(moments[number] * (0.3 if number % 2 else 1.0))
            process.kill()
            process.communicate()
            restart = {"-restart": str(file)} if file.exists() else {}
            return bool(restart), self.launch(options | restart, directory=directory)

        ends = program.in_pairs(kill_and_go_on, range(KILLS))
        self.assertGreater(sum(restarted for restarted, _ in ends), KILLS // 4)
        tables, numbers = checkpoint(whole.directory)
        for number, (_, run) in enumerate(ends):
            with self.subTest(moment=moments[number]):
                self.assertEqual(run.status, 0, run.err)
                self.assertEqual(results(run), results(whole))
                self.assert_same_bytes(whole.directory, run.directory, ("history.csv", "crack_path.csv"))
                other_tables, other_numbers = checkpoint(run.directory)
                self.assertEqual(numbers | {"fields": 0}, other_numbers | {"fields": 0})
                for name in tables:
                    np.testing.assert_array_equal(tables[name], other_tables[name], name)
                self.assert_same_displacement(whole, run, tolerance=0.0)
                if "fields_before.h5" not in run.files:
                    self.assert_same_bytes(whole.directory, run.directory, ("fields.xdmf",))

    def test_another_directory_gets_files_of_its_own(self):
        directory = self.cut_in_two(TORN, 1)
        rest = self.solve(TORN | {"-restart": str(directory / "checkpoint.h5")})
        self.assertEqual([row["step"] for row in rest.history()], list(range(210, 401, 10)))

    def test_a_run_gone_wild_leaves_its_last_sound_state(self):
        wild = TORN | {"-ts_dt": "4e-6", "-ts_allow_unstable": "", "-checkpoint_interval": "1000"}
        run = self.launch(wild)
        self.assertEqual(run.status, 2, run.err)
        tables, numbers = checkpoint(run.directory)
        self.assertIn(f"the state of step {int(numbers['step'])} is kept", run.err)
        self.assertTrue(np.isfinite(tables["velocity"]).all())

    def test_a_damaged_checkpoint_is_refused_and_its_dataset_named(self):
        directory = self.cut_in_two(TORN, 1, 20)
        whole = (directory / "checkpoint.h5").read_bytes()
        with h5py.File(directory / "checkpoint.h5") as file:
            places = {name: (file[name].id.get_offset(), file[name].id.get_storage_size()) for name in file}
        damaged = self.scratch / "damaged.h5"
        cases = [(at + size // 2, f"dataset /{name} is damaged") for name, (at, size) in places.items() if size]
        self.assertGreater(len(cases), 8)
        cases += [(k * len(whole) // 9, "cannot read '") for k in range(9)]

        def refused(case):
            at, words = case
            file = self.scratch / f"damaged_{at}.h5"
            file.write_bytes(whole[:at] + bytes([whole[at] ^ 4]) + whole[at + 1 :])
            return self.launch(TORN | {"-restart": str(file)}, 1), words

        for run, words in program.in_pairs(refused, cases):
            self.assertEqual(run.status, 1, run.err)
            self.assertIn(words, run.err)
            self.assertEqual(run.err.count("\n"), 1, run.err)
        for size, words in ((0, "too short"), (700, "damaged"), (len(whole) - 1, "damaged"), (len(whole) // 2, "damaged")):
            damaged.write_bytes(whole[:size])
            for ranks in (1, 2):
                run = self.launch(TORN | {"-restart": str(damaged)}, ranks)
                self.assertEqual(run.status, 1, run.err)
                self.assertIn(words, run.err)
                self.assertEqual(run.err.count("\n"), 1, run.err)

    def test_damaged_fields_are_put_aside(self):
        options = TORN | {"-output_fields": "", "-output_interval": "10"}
        directory = self.cut_in_two(options, 1, 20)
        fields = directory / "fields.h5"
        fields.write_bytes(b"\xff" * 200 + fields.read_bytes()[200:])
        for ranks in (1, 2):
            run = self.launch(options | {"-restart": str(directory / "checkpoint.h5"), "-ts_max_steps": "40"}, ranks, directory=directory)
            self.assertEqual(run.status, 0, run.err)
            if ranks == 1:
                self.assertIn("put aside as fields_before.h5", run.err)

    def test_the_same_values_in_other_words_are_the_same_scene(self):
        directory = self.cut_in_two(TORN, 1, 20)
        restart = {"-restart": str(directory / "checkpoint.h5"), "-ts_max_steps": "40"}
        same = {"-material_young": "1000000000.0", "-pd_horizon_ratio": "3.0", "-output_fields": ""}
        self.solve(TORN | restart | same | {"-layout_renew_interval": "5", "-rebalance_threshold": "1.5"})

    def test_what_cannot_go_on_is_refused_in_one_line(self):
        directory = self.cut_in_two(TORN, 1, 20)
        file = str(directory / "checkpoint.h5")
        other = directory / "history.csv"
        for change, words in (
            ({"-material_young": "2e9"}, 'of another scene, which has "material = E 1000000000 '),
            ({"-pd_spacing": "0.002"}, "of another scene"),
            ({"-crack_notch_points": "0,0.02,0.04,0.02"}, 'this one has "crack 1 = (0, 0.02) (0.04, 0.02)"'),
            ({"-bc_names": "top,bottom,left", "-bc_left_on": "left", "-bc_left_displacement": "0,free"},
             'of another scene, which has "supports = '),
            ({"-bc_bottom_displacement": "0,free"}, 'of another scene, which has "supports = '),
            ({"-bc_bottom_displacement": "free,1e-5"}, "-restart: what is held would jump at"),
            ({"-pd_critical_stretch": None}, 'of another scene, which has "-pd_critical_stretch = 0.01"'),
            ({"-ts_dt": "1e-7"}, "-ts_dt is 1e-07, but the steps of"),
            ({"-restart": "nowhere.h5"}, "cannot read 'nowhere.h5': there is no such file"),
            ({"-restart": str(other)}, f"cannot read '{other}'"),
            ({"-restart": str(directory)}, f"cannot read '{directory}': it is no file"),
            ({"-pd_micromodulus": "uniform"}, "of another scene"),
            ({"-xfem_quadrature": "grid"}, 'which has "-xfem_quadrature = polygons"; this one has "-xfem_quadrature = grid"'),
            ({"-xfem_least_share": "0.02"}, 'which has "-xfem_least_share = '),
            ({"-post_tip_damage": "0.5"}, 'which has "-post_tip_damage = '),
            ({"-pd_skip_tolerance": "1e-9"}, 'which has "-pd_skip_tolerance = '),
            (COUPLED, 'of another scene, which has "crack 1 = (0, 0.02) (0.03, 0.02)"'),
            ({"-pd_no_fail": "0,0,0.01,0.01"}, 'which has no more; this one has "no-fail zone = '),
            ({"-crack_names": None, "-crack_notch_points": None}, 'which has "crack 1 = (0, 0.02) (0.03, 0.02)"'),
            ({"-analysis": "implicit", "-ts_dt": "1e-7"}, "-restart: implicit steps have no checkpoint"),
        ):
            with self.subTest(change=change):
                run = self.launch(TORN | {"-restart": file} | change)
                self.assertEqual(run.status, 1, run.err)
                self.assertIn(words, run.err)
                self.assertEqual(run.err.count("\n"), 1, run.err)


if __name__ == "__main__":
    program.main()
