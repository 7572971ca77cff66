"""A static run that is stopped, killed or cut in two between its loads ends like one that was left alone."""

import shutil
import subprocess
import time

import program
import test_conditions
import test_points
import torn
from torn import checkpoint

import numpy as np

BEAM = torn.BEAM | {"-checkpoint_interval": "1"}
SHORT = {"-bc_top_displacement": "0,0.75e-6", "-bc_bottom_displacement": "0,-0.75e-6", "-load_steps": "5"}
SNAIL = BEAM | {"-pd_patches": "0.2e-3,0.15e-3,0.4e-3,0.30e-3", "-adapt": "relocate"}
SCENES = {"none": (BEAM | SHORT, 4), "relocate": (SNAIL, 5)}  # and a load
SAME = ("gone_bonds", "broken_carried_bonds", "row_names", "layout_patches", "layout_cracks")
FROM_START = ("solve_iterations", "solve_seconds", "solve_bonds_broken", "layout_seconds", "halvings")  # lists, times


def numbers_in(result):
    if isinstance(result, dict):
        return [number for key in sorted(result) for number in numbers_in(result[key])]
    if isinstance(result, list):
        return [number for entry in result for number in numbers_in(entry)]
    return [result] if isinstance(result, (int, float)) else []


class StaticRestart(program.ProgramTest):
    CRACKS_REACH_BORDERS = True

    def watched(self, options, step):
        """Runs a scene, and copies what lies in its directory once a checkpoint of a load is there: what a run that is
        killed at that moment leaves."""
        directory = self.scratch / f"watched_{step}_{options.get('-adapt', 'none')}_{options.get('-case', '')}"
        copy = directory.with_name(directory.name + "_copy")
        command = [program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, cwd=program.ROOT)  # fmt: skip
        while process.poll() is None and self.step_of(directory) < step:
            time.sleep(0.002)
        shutil.copytree(directory, copy, ignore=shutil.ignore_patterns("*.part"))  # which comes and goes
        out, err = process.communicate()
        self.assertEqual(process.returncode, 0, err)
        return program.Run(0, out, err, directory), copy

    @staticmethod
    def step_of(directory):
        try:
            return checkpoint(directory)[1]["step"]
        except (OSError, KeyError):  # none yet
            return -1

    def assert_ends_alike(self, whole, rest):
        tables, numbers = checkpoint(whole.directory)
        others, other_numbers = checkpoint(rest.directory)
        self.assertEqual(tables.keys(), others.keys())
        for name in SAME:
            if name in tables:
                np.testing.assert_array_equal(tables[name], others[name], name)
        scale = np.abs(tables["displacement"]).max()
        self.assertLess(np.abs(tables["displacement"] - others["displacement"]).max(), 1e-9 * scale)
        for name in ("step", "load", "bonds_broken", "relocations", "increments", "part_done", "passes"):
            self.assertEqual(numbers[name], other_numbers[name], name)
        for name in ("work", "dissipated", "energy_broken", "converted"):
            self.assertAlmostEqual(numbers[name], other_numbers[name], delta=1e-7 * numbers["work"], msg=name)
        a, b = (run.summary["results"] for run in (whole, rest))
        self.assertEqual(a.keys(), b.keys())
        for name in a.keys() - {*FROM_START, "peak_reaction_load"}:
            self.assert_near(a[name], b[name], name)
        largest = max(map(abs, numbers_in(a["peak_reaction"])))
        for peak, *loads in zip(*map(numbers_in, (a["peak_reaction"], a["peak_reaction_load"], b["peak_reaction_load"]))):
            if abs(peak) > 1e-9 * largest:  # of what is 0 the rounding has its peak anywhere
                self.assertEqual(*loads)
        path, other = (program.rows_of(run.directory / "crack_path.csv") for run in (whole, rest))
        self.assertEqual([row["load"] for row in path], [row["load"] for row in other])

    def assert_near(self, a, b, name):
        """Numbers of one result, to what solvers leave of the largest."""
        one, other = numbers_in(a), numbers_in(b)
        self.assertEqual(len(one), len(other), name)
        scale = max((abs(value) for value in one), default=0.0)
        for value, again in zip(one, other):
            self.assertLessEqual(abs(value - again), 1e-6 * scale, name)

    def test_killed_between_loads_it_breaks_the_same_bonds(self):
        for name, (options, step) in SCENES.items():
            with self.subTest(adapt=name):
                whole, directory = self.watched(options, step)
                self.assertGreater(whole.summary["bonds_broken"], 300)
                if name != "none":
                    self.assertGreater(whole.summary["relocations"], checkpoint(directory)[1]["relocations"])
                loads = int(options["-load_steps"])
                self.assertTrue(step <= self.step_of(directory) < loads, self.step_of(directory))
                rest = self.solve(options | {"-restart": str(directory / "checkpoint.h5")}, directory=directory)
                self.assert_ends_alike(whole, rest)
                self.assertEqual([row["step"] for row in rest.history()], list(range(1, loads + 1)))

    def test_other_ranks_go_on(self):
        pins = test_conditions.Pins.PINNED
        for name, scene in (("elements", program.SMALL_PATCH), ("points", test_points.PATCHED), ("pins", pins)):
            with self.subTest(around_particles=name):
                options = scene | {"-load_steps": "4", "-checkpoint_interval": "2", "-output_history": "", "-case": name}
                whole, half = self.watched(options, 2)
                rest = self.solve(options | {"-restart": str(half / "checkpoint.h5")}, 2, half)
                for one, other in zip(whole.history(), rest.history(), strict=True):
                    self.assertAlmostEqual(one["work"], other["work"], delta=1e-9 * one["work"])
                for result in ("strain_energy", "external_work"):
                    a, b = (run.summary["results"][result] for run in (whole, rest))
                    self.assertAlmostEqual(a, b, delta=1e-9 * a, msg=result)

    def test_what_cannot_go_on_is_refused_in_one_line(self):
        plate = program.SMALL_PATCH | {"-load_steps": "4", "-checkpoint_interval": "2"}
        file = self.solve(plate).directory / "checkpoint.h5"
        for change, words in (
            ({"-load_steps": "5"}, 'of another scene, which has "-load_steps = 4"; this one has "-load_steps = 5"'),
            ({"-bc_load_traction": "2e6,1e6"}, 'of another scene, which has "-bc_load_traction = 1000000,1000000"'),
            ({"-analysis": "explicit", "-load_steps": None, "-material_density": "1000", "-ts_max_steps": "3"},
             "of another scene, which has "),
        ):
            run = self.launch(plate | {"-restart": str(file)} | change)
            self.assertEqual((run.status, run.err.count("\n")), (1, 1), run.err)
            self.assertIn(words, run.err)
        done = self.solve(plate | {"-restart": str(file)})  # nothing is left to do
        self.assertEqual(done.summary["status"], "done")
        self.assertGreater(done.summary["results"]["strain_energy"], 0.0)


if __name__ == "__main__":
    program.main()
