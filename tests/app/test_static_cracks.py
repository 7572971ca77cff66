"""Where cracks are in statics: history.csv, crack_path.csv and the tips of the summary, for cracks that turn and for two of
them, in a patch that stays and in patches that go along with the tips."""

import program

import pdxtools
import numpy as np

SPACING = 1e-5
PLATE = {
    "-case": "static_cracks",
    "-mesh_lower": "0,0",
    "-mesh_upper": "0.9e-3,0.46e-3",
    "-mesh_cells": "45,23",
    "-material_young": "75e9",
    "-material_thickness": "1e-3",
    "-material_toughness": "5",
    "-pd_spacing": "1e-5",
    "-pd_horizon_ratio": "3",
    "-bc_top_on": "top",
    "-bc_bottom_on": "bottom",
    "-output_history": "",
    "-output_fields": "",
    "-quiet": "",
}
# A crack that begins at 30 degrees, pulled open and sheared from above and below: it turns at once, and again on its way.
TURNS = PLATE | {
    "-crack_names": "crack",
    "-crack_crack_points": "0,0.16e-3,0.2e-3,0.16e-3,0.3e-3,0.21773502691896e-3",
    "-bc_names": "right,top,bottom",
    "-bc_right_on": "right",
    "-bc_right_displacement": "0,0",
    "-bc_top_box": "-1e-6,0.45e-3,0.4e-3,0.47e-3",
    "-bc_top_displacement": "0.1e-6,0.3e-6",
    "-bc_bottom_box": "-1e-6,-0.01e-3,0.4e-3,0.01e-3",
    "-bc_bottom_displacement": "-0.1e-6,-0.3e-6",
    "-load_steps": "20",
    "-pd_patches": "0.2e-3,0.1e-3,0.84e-3,0.36e-3",
}
GIVEN = 0.2e-3 + np.hypot(0.1e-3, 0.05773502691896e-3)  # of it [m]
TIP = {"-adapt": "relocate", "-pd_patches": "0.24e-3,0.14e-3,0.36e-3,0.28e-3"}
# Two that come from either side and pass each other.
TWO = PLATE | {
    "-crack_names": "a,b",
    "-crack_a_points": "0,0.2e-3,0.3e-3,0.2e-3",
    "-crack_b_points": "0.9e-3,0.26e-3,0.6e-3,0.26e-3",
    "-bc_names": "top,bottom",
    "-bc_top_displacement": "0,0.3e-6",
    "-bc_bottom_displacement": "0,-0.3e-6",
    "-load_steps": "12",
    "-pd_patches": "0.2e-3,0.1e-3,0.7e-3,0.36e-3",
}
TIPS = {"-adapt": "relocate", "-pd_patches": "0.24e-3,0.14e-3,0.36e-3,0.26e-3,0.54e-3,0.2e-3,0.66e-3,0.32e-3",
        "-pd_spacing": "1e-5,1e-5"}  # fmt: skip


def paths_of(run):
    """Of each tip: loads, and points [m]."""
    rows = program.rows_of(run.directory / "crack_path.csv")
    numbers = sorted({int(row["tip"]) for row in rows})
    return {
        number: (np.array([row["load"] for row in rows if row["tip"] == number]),
                 np.array([(row["x"], row["y"]) for row in rows if row["tip"] == number]))
        for number in numbers
    }  # fmt: skip


def length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


class StaticCracks(program.ProgramTest):
    def expect_whole(self, run, given):
        """What files and summary say of the cracks goes together."""
        last, results = run.history()[-1], run.summary["results"]
        paths = paths_of(run)
        self.assertAlmostEqual(last["crack_length"], given + sum(length(x) for _, x in paths.values()), delta=1e-9)
        self.assertEqual(len(results["tips"]), len(paths))
        for number, (loads, points) in paths.items():
            tip = results["tips"][number - 1]
            self.assertTrue((np.diff(loads) >= 0).all())
            np.testing.assert_allclose(points[0], tip["start"], atol=1e-12)
            for at in (tip["at"], results["crack_tips"][number - 1], (last[f"tip{number}_x"], last[f"tip{number}_y"])):
                np.testing.assert_allclose(points[-1], at, atol=1e-12)
            self.assertAlmostEqual(tip["grown"], length(points), delta=1e-9)
            for row in run.history():  # a tip is where its path has been by then
                seen = points[loads <= row["load"] * (1 + 1e-9)]
                at = np.array((row[f"tip{number}_x"], row[f"tip{number}_y"]))
                nearest = np.linalg.norm(points - at, axis=1).min()
                self.assertLess(nearest, 5 * SPACING)
                if len(seen) > 1:
                    self.assertLess(np.linalg.norm(seen[-1] - at), 6 * SPACING)

    def expect_where_bonds_broke(self, run, points):
        """The path goes between particles that lost bonds."""
        block = pdxtools.read_step(run.directory)[1]["particles"]
        damaged = block.points[block["damage"] > 0.25, :2]
        for x in points:
            self.assertLess(np.linalg.norm(damaged - x, axis=1).min(), 1.5 * SPACING)

    def test_a_crack_that_turns_is_followed(self):
        large = self.solve(TURNS)
        self.expect_whole(large, GIVEN)
        loads, points = paths_of(large)[1]
        self.expect_where_bonds_broke(large, points)
        self.assertGreater(length(points), 20 * SPACING)
        directions = np.degrees(np.arctan2(*np.diff(points[[0, len(points) // 2, -1]], axis=0).T[::-1]))
        self.assertGreater(30 - directions[0], 20)  # from the 30 degrees of the given tip
        self.assertGreater(directions[0] - directions[1], 15)
        self.assertEqual(loads[-1], 1.0)
        tip = large.summary["results"]["tips"][0]
        self.assertLess(abs(tip["farthest_broken"] - tip["grown"]), 3 * SPACING)
        self.assertLess(tip["angle_degrees"], -30)
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                moved = self.solve(TURNS | TIP, ranks)
                self.assertGreaterEqual(moved.summary["relocations"], 8)
                self.expect_whole(moved, GIVEN)
                for a, b in zip(large.history(), moved.history(), strict=True):
                    for name in ("crack_length", "tip1_x", "tip1_y"):
                        self.assertLess(abs(a[name] - b[name]), 1.5 * SPACING, (a["load"], name))
                ends = np.array([points[-1], paths_of(moved)[1][1][-1]])
                self.assertLess(np.linalg.norm(ends[0] - ends[1]), 1.5 * SPACING)

    def test_ranks_follow_alike(self):
        for options in (TURNS | TIP, TWO):
            one, more = self.solve(options), self.solve(options, 3)
            for a, b in zip(one.history(), more.history(), strict=True):
                for name in ("crack_length", "crack_first_intact", "crack_farthest_broken", "tip1_x", "tip1_y"):
                    self.assertLess(abs(a[name] - b[name]), 1e-6 * SPACING, name)
            for (_, a), (_, b) in zip(paths_of(one).values(), paths_of(more).values(), strict=True):
                np.testing.assert_allclose(a, b, atol=1e-6 * SPACING)

    def test_each_of_two_cracks_has_its_tip(self):
        middle = np.array((0.45e-3, 0.23e-3))
        for more in ({}, TIPS):
            with self.subTest(adapt=bool(more)):
                run = self.solve(TWO | more)
                self.expect_whole(run, 0.6e-3)
                paths = paths_of(run)
                self.assertEqual(list(paths), [1, 2])
                a, b = (points for _, points in paths.values())
                self.expect_where_bonds_broke(run, b if not more else b[-3:])
                for points in (a, b):
                    self.assertGreater(length(points), 13 * SPACING)
                self.assertLess(np.linalg.norm(a[-1] + b[-1] - 2 * middle), SPACING)  # one is the other, turned

    def test_a_crack_that_stays_has_no_path(self):
        run = self.solve(TURNS | {"-bc_top_displacement": "1e-8,3e-8", "-bc_bottom_displacement": "-1e-8,-3e-8", "-load_steps": "2"})
        self.assertEqual(paths_of(run), {})
        self.assertAlmostEqual(run.history()[-1]["crack_length"], GIVEN, delta=1e-12)
        self.assertEqual(run.summary["results"]["tips"][0]["grown"], 0.0)


if __name__ == "__main__":
    program.main()
