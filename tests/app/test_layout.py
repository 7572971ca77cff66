"""A scene whose rows, Terms and solvers are made anew while it runs ends like one that was left alone."""

import signal
import subprocess
import time

import program
from torn import COUPLED, RUNNING, SHAPED, TORN, checkpoint, results

import numpy as np

RENEWED = {"-layout_renew_interval": "7"}
WRITTEN = {"-output_fields": "", "-output_interval": "100", "-checkpoint_interval": "400"}
# The double cantilever beam up to half of its load; bonds break over the last loads.
GROWING = {
    "-options_file": "cases/dcb/smoke.opts",
    "-bc_top_displacement": "0,0.75e-6",
    "-bc_bottom_displacement": "0,-0.75e-6",
    "-load_steps": "5",
    "-output_fields": "false",
    "-output_history": "",
    "-quiet": "",
}
# A block in space, with a crack through half of it.
BLOCK = TORN | {
    "-case": "block",
    "-material_plane": "solid",
    "-material_thickness": "0.006",
    "-mesh_upper": "0.02,0.016",
    "-pd_horizon_ratio": "2.015",
    "-pd_micromodulus": "uniform",
    "-crack_notch_points": "0,0.008,0.006,0.008",
    "-ts_max_steps": "150",
}


class Layout(program.ProgramTest):
    CRACKS_REACH_BORDERS = True

    def assert_the_same(self, whole, other):
        self.assertEqual(results(whole), results(other))
        names = [name for name in ("checkpoint.h5", "history.csv", "fields.xdmf", "crack_path.csv") if name in whole.files]
        for name in names:
            self.assertEqual((whole.directory / name).read_bytes(), (other.directory / name).read_bytes(), name)
        self.assertIn("checkpoint.h5", names)
        self.assert_same_displacement(whole, other, tolerance=0.0)

    def test_nothing_changes_to_the_last_bit(self):
        for scene in (TORN, RUNNING, COUPLED, SHAPED, BLOCK):
            for ranks in (1, 3) if scene in (TORN, RUNNING) else (1, 2, 3):
                with self.subTest(scene["-case"], ranks=ranks):
                    whole = self.solve(scene | WRITTEN, ranks)
                    renewed = self.solve(scene | WRITTEN | RENEWED, ranks)
                    self.assertGreater(whole.summary["bonds_broken"], 20)
                    self.assertNotIn("layout_change", whole.events)
                    self.assertEqual(renewed.summary["results"]["energy_converted"], 0.0)
                    self.assertEqual(renewed.events["layout_change"], (int(scene["-ts_max_steps"]) - 1) // 7)
                    self.assert_the_same(whole, renewed)

    def test_loads_go_on_by_the_same_passes_and_bonds(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                both = (GROWING, GROWING | {"-layout_renew_interval": "1"})
                whole, renewed = program.in_pairs(self.shared, both) if ranks == 1 else [self.solve(one, ranks) for one in both]
                self.assertGreater(whole.summary["bonds_broken"], 500)
                self.assertEqual(renewed.events["layout_change"], 4)
                self.assertGreater([row["bonds_broken"] for row in whole.history()][-2], 100)  # the last change carries some
                for name in ("passes", "halvings", "solve_bonds_broken", "load_steps_accepted"):
                    self.assertEqual(whole.summary["results"][name], renewed.summary["results"][name], name)
                rows = list(zip(whole.history(), renewed.history(), strict=True))
                for name in rows[0][0]:
                    of = "reaction_top_y" if name.startswith("reaction") else name
                    largest = max(abs(row[of]) for row, _ in rows)
                    for row, other in rows:
                        self.assertAlmostEqual(row[name], other[name], delta=1e-9 * largest, msg=name)

    def test_a_restart_goes_on_between_changes(self):
        whole = self.solve(SHAPED | WRITTEN)
        directory = self.scratch / "half"
        self.solve(SHAPED | WRITTEN | RENEWED | {"-ts_max_steps": "200", "-checkpoint_interval": "200"}, directory=directory)
        rest = self.solve(SHAPED | WRITTEN | RENEWED | {"-restart": str(directory / "checkpoint.h5")}, directory=directory)
        self.assert_the_same(whole, rest)

    def test_a_checkpoint_holds_names_and_layout(self):
        run = self.solve(SHAPED | {"-ts_max_steps": "10", "-checkpoint_interval": "10"})
        tables, _ = checkpoint(run.directory)
        names = tables["row_names"][:, 0]
        rows = names[names > 0]
        unknowns = run.summary["unknowns"]
        self.assertEqual(len(np.unique(rows)), len(rows))
        self.assertEqual(2 * len(rows), unknowns["fe"] + unknowns["enriched"] + unknowns["pd"])
        kinds = rows >> np.uint64(62)
        self.assertEqual([2 * np.count_nonzero(kinds == kind) for kind in (1, 2, 3)],
                         [unknowns["fe"], unknowns["enriched"], unknowns["pd"]])
        self.assertEqual(tables["layout_patches"].shape, (2, 5))
        np.testing.assert_allclose(tables["layout_patches"][:, 0], 0.025)
        np.testing.assert_allclose(tables["layout_cracks"], [[0, 0, 0.275], [0, 0.55, 0.275]])

    def test_a_skewed_load_is_dealt_out_anew(self):
        # All particles in the lower half of the cells, which one rank has at first.
        skewed = COUPLED | {
            "-case": "skewed",
            "-mesh_cells": "40,20",
            "-pd_patches": "0.2,0.05,0.8,0.15",
            "-pd_spacing": "0.00625",
            "-crack_notch_points": "0,0.1125,0.45,0.1125",
            "-petscpartitioner_type": "simple",
            "-ts_max_steps": "800",
            "-checkpoint_interval": "800",
        }
        for ranks in (2, 3):
            with self.subTest(ranks=ranks):
                left = self.solve(skewed, ranks)
                dealt = self.solve(skewed | {"-rebalance_threshold": "1.3"}, ranks)
                particles = left.summary["partition"]["particles_per_rank"]
                self.assertEqual(max(particles), sum(particles))
                self.assertGreaterEqual(dealt.summary["results"]["rebalances"], 1)
                self.assertLess(dealt.summary["partition"]["imbalance"], 1.1)  # by the costs it was cut by
                if ranks == 2:  # and as measured afterwards; more ranks than cores measure each other
                    self.assertLess(dealt.summary["results"]["imbalance"], 1.4)
                work = abs(left.summary["results"]["external_work"])
                self.assertLess(abs(dealt.summary["results"]["energy_converted"]), 1e-12 * work)
                self.assertGreater(left.summary["bonds_broken"], 100)
                (a, numbers), (b, other_numbers) = checkpoint(left.directory), checkpoint(dealt.directory)
                for name in ("gone_bonds", "broken_carried_bonds", "row_names"):
                    np.testing.assert_array_equal(a[name], b[name], name)
                for name in ("displacement", "velocity"):
                    self.assertLessEqual(np.abs(a[name] - b[name]).max(), 1e-12 * np.abs(a[name]).max(), name)

    def test_a_signal_between_layouts_leaves_a_checkpoint(self):
        options = TORN | {"-pd_critical_stretch": "1", "-ts_max_steps": "100000", "-layout_renew_interval": "1"}
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                directory = self.scratch / f"told_{ranks}"
                command = [*program.launcher(ranks), program.PROGRAM, *program.words_of(options), "-output_dir", str(directory)]
                process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=program.ROOT)
                while process.poll() is None and not (directory / "history.csv").exists():
                    time.sleep(0.01)
                time.sleep(0.5)
                process.send_signal(signal.SIGUSR1)
                out, err = process.communicate(timeout=60)
                self.assertEqual((process.returncode, err), (0, ""))
                self.assertRegex(out, r"stopped by SIGUSR1 at step \d+, .*: checkpoint written to")
                self.assertTrue((directory / "checkpoint.h5").exists())

    def test_a_run_gone_wild_keeps_what_it_would_have_kept(self):
        wild = TORN | {"-pd_critical_stretch": "10", "-ts_dt": "4e-6", "-ts_allow_unstable": "", "-checkpoint_interval": "1000"}
        for interval in ("3", "50"):
            with self.subTest(interval=interval):
                left = self.launch(wild)
                renewed = self.launch(wild | {"-layout_renew_interval": interval})
                self.assertEqual((left.status, renewed.status), (2, 2), renewed.err)
                (a, numbers), (b, other) = checkpoint(left.directory), checkpoint(renewed.directory)
                self.assertLessEqual(np.abs(b["velocity"]).max(), 1.001 * np.abs(a["velocity"]).max())
                self.assertLessEqual(other["step"], numbers["step"] + 20)

    def test_both_ways_of_change_at_once(self):
        run = self.solve(COUPLED | RENEWED | {"-rebalance_threshold": "1.01", "-petscpartitioner_type": "simple"}, 2)
        self.assertGreaterEqual(run.summary["results"]["rebalances"], 1)

    def test_implicit_steps_keep_their_layout(self):
        run = self.launch(TORN | RENEWED | {"-analysis": "implicit", "-ts_dt": "1e-6", "-pd_critical_stretch": None})
        self.assertEqual(run.status, 1, run.err)
        self.assertIn("implicit steps keep their layout", run.err)


if __name__ == "__main__":
    program.main()
