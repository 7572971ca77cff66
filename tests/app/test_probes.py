"""Probes write what a closed form says, at points of elements and between particles, on any number of ranks."""

import csv

import program
from torn import TORN

YOUNG, POISSON, TRACTION = 1e9, 1 / 3, 1e6
# Pulled evenly along x and free along y: u = (x, -nu y) TRACTION / YOUNG, a patch in the middle.
EVEN = program.EVEN | {
    "-case": "even",
    "-mesh_lower": "2,1",
    "-mesh_upper": "3,2",
    "-mesh_cells": "8,8",
    "-pd_patches": "2.25,1.25,2.75,1.75",
    "-pd_spacing": "0.03125",
    "-load_steps": "2",
}
PROBED = {
    "-probe_names": "element,particle,across",
    "-probe_element_at": "2.11,1.93",
    "-probe_element_field": "displacement,stress",
    "-probe_particle_at": "2.51,1.43",
    "-probe_across_line": "2.05,1.05,2.95,1.95,7",
}
# The same plate flying.
FLYING = {key: value for key, value in EVEN.items() if not key.startswith(("-bc_", "-load_"))} | {
    "-analysis": "explicit",
    "-material_density": "1000",
    "-ts_max_steps": "25",
    "-bc_names": "all",
    "-bc_all_box": "0,0,9,9",
    "-bc_all_initial_velocity": "3,-2",
    "-probe_names": "a,b",
    "-probe_a_at": "2.1,1.1",
    "-probe_a_field": "displacement,velocity",
    "-probe_a_every": "10",
    "-probe_b_line": "2.5,1.0625,2.5,1.9375,8",
    "-probe_b_field": "velocity",
    "-probe_b_every": "25",
}


def header(path):
    with open(path, newline="", encoding="utf-8") as file:
        return next(csv.reader(file))


class Probes(program.ProgramTest):
    def rows(self, run, name):
        return program.rows_of(run.directory / f"probe_{name}.csv")

    def assert_even(self, row, x, y, load):
        self.assertAlmostEqual(row["displacement_x"], load * TRACTION / YOUNG * (x - 2), delta=1e-12)
        self.assertAlmostEqual(row["displacement_y"], -load * POISSON * TRACTION / YOUNG * (y - 1), delta=1e-12)

    def test_uniform_strain(self):
        for ranks in (1, 2, 3):
            with self.subTest(ranks=ranks):
                run = self.solve(EVEN | PROBED, ranks)
                self.assertEqual(header(run.directory / "probe_element.csv"),
                                 ["step [-]", "load [-]", "displacement_x [m]", "displacement_y [m]", "stress_xx [Pa]",
                                  "stress_xy [Pa]", "stress_yy [Pa]"])  # fmt: skip
                rows = self.rows(run, "element")
                self.assertEqual([row["load"] for row in rows], [0, 0.5, 1])
                for row in rows:
                    self.assert_even(row, 2.11, 1.93, row["load"])
                    for name, value in (("xx", TRACTION), ("xy", 0), ("yy", 0)):
                        self.assertAlmostEqual(row[f"stress_{name}"], row["load"] * value, delta=1e-6 * TRACTION)
                for row in self.rows(run, "particle"):
                    self.assert_even(row, 2.51, 1.43, row["load"])
                line = self.rows(run, "across")
                self.assertEqual(len(line), 3 * 7)
                for k, row in enumerate(line):
                    at = k % 7 * 0.15
                    self.assertAlmostEqual(row["along"], at * 2**0.5, delta=1e-12)
                    self.assert_even(row, 2.05 + at, 1.05 + at, row["load"])

    def test_in_time(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                run = self.solve(FLYING, ranks)
                rows = self.rows(run, "a")
                self.assertEqual([row["step"] for row in rows], [0, 10, 20, 25])
                for row in rows:
                    for axis, v in (("x", 3), ("y", -2)):
                        self.assertAlmostEqual(row[f"velocity_{axis}"], v, delta=1e-9)
                        self.assertAlmostEqual(row[f"displacement_{axis}"], v * row["time"], delta=1e-9 * row["time"])
                self.assertEqual([row["step"] for row in self.rows(run, "b")], 8 * [0] + 8 * [25])

    def test_a_restart_goes_on(self):
        probe = {"-probe_names": "p", "-probe_p_at": "0.06,0.03", "-probe_p_field": "displacement,damage", "-probe_p_every": "7"}
        whole = self.solve(TORN | probe | {"-ts_max_steps": "100"})
        half = self.solve(TORN | probe | {"-ts_max_steps": "50", "-checkpoint_interval": "50"})
        self.solve(TORN | probe | {"-ts_max_steps": "100", "-restart": str(half.directory / "checkpoint.h5")}, directory=half.directory)
        a, b = self.rows(whole, "p"), [row for row in self.rows(half, "p") if row["step"] != 50]  # its end then
        self.assertEqual(a, b)

    def test_files_of_an_earlier_run_go(self):
        run = self.solve(EVEN | PROBED)
        self.solve(EVEN | {"-probe_names": "other", "-probe_other_at": "2.5,1.5"}, directory=run.directory)
        self.assertEqual([name for name in run.files if name.startswith("probe_")], ["probe_other.csv"])

    def test_what_cannot_be_probed_is_refused(self):
        for change, words in (
            ({"-probe_element_at": "1.9,1.5"}, r"-probe_element_at has \(1\.9, 1\.5\): no element and no particle is there"),
            ({"-probe_element_at": None}, "-probe_element: a probe has one place or one line"),
            ({"-probe_element_at": "2"}, "-probe_element_at has 1 values: must have 2"),
            ({"-probe_element_field": "stres"}, r"-probe_element_field is stres: .* it has damage, |-probe_element_field is stres: .*displacement"),
            ({"-probe_across_line": "2.05,1.05,2.95,1.95"}, "-probe_across_line has 4 values: must have 5"),
            ({"-probe_across_line": "2.05,1.05,2.95,1.95,1"}, "-probe_across_line has 1 places"),
            ({"-probe_across_line": "2.05,1.05,3.95,1.95,9"}, r"-probe_across_line has \(3\.\d+, 1\.\d+\): no element"),
            ({"-probe_names": "element,element"}, "-probe_names lists element twice"),
            ({"-probe_third_at": "2.5,1.5"}, r"-probe_third_at is no option of pdxsolve: third is not in -probe_names \(element,particle,across\)"),
        ):
            with self.subTest(change):
                run = self.launch(EVEN | PROBED | change)
                self.assertEqual((run.status, run.err.count("\n")), (1, 1), run.err)
                self.assertRegex(run.err, words)


if __name__ == "__main__":
    program.main()
