"""Cracks that meet in elements: what they cut off moves by itself, in any analysis and on any number of ranks.

Usage: test_junctions.py PDXSOLVE [unittest arguments]; environment as for test_bad_input.py.
"""

import numpy as np
import program
from program import pdxtools
from torn import checkpoint

# A plate of 9 x 9 elements, cut into three by a Y: above, below and on the right.
Y = {
    "-case": "y",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "9,9",
    "-material_young": "1e9",
    "-material_density": "1000",
    "-crack_names": "through,branch",
    "-crack_through_points": "0,0.53,0.49,0.52,1,0.83",
    "-crack_branch_points": "1,0.21,0.49,0.52",
    "-output_fields": "",
    "-quiet": "",
}
MOTIONS = {"above": (1e-3, 2e-3), "below": (-2e-3, -1e-3), "right": (3e-3, 0.0)}
BOXES = {"above": "-0.1,0.9,1.1,1.1", "below": "-0.1,-0.1,1.1,0.1", "right": "0.9,0.4,1.1,0.6"}


def body_of(x):
    """Which of the three a place is in."""
    above = x[1] > (0.53 - 0.01 * x[0] / 0.49 if x[0] < 0.49 else 0.52 + 0.31 * (x[0] - 0.49) / 0.51)
    below = x[0] < 0.49 or x[1] < 0.52 - 0.31 * (x[0] - 0.49) / 0.51
    return "above" if above else "below" if below else "right"


def held(names):
    options = {"-bc_names": ",".join(names)}
    for name in names:
        options |= {f"-bc_{name}_box": BOXES[name], f"-bc_{name}_displacement": "{},{}".format(*MOTIONS[name])}
    return options


class Junctions(program.ProgramTest):
    def assert_moves_rigidly(self, run, scale=1.0):
        _, step = pdxtools.read_step(run.directory)
        for block in ("mesh", "cut_cells"):
            places, moved = step[block].points[:, :2], step[block]["displacement"][:, :2]
            for x, u in zip(places, moved):
                if block == "mesh" or not near_crack(x):
                    np.testing.assert_allclose(u, scale * np.array(MOTIONS[body_of(x)]), atol=1e-10 * scale, rtol=0.0)
        seen = {tuple(np.round(u / scale, 9)) for u in step["cut_cells"]["displacement"][:, :2]}
        self.assertEqual(seen, set(MOTIONS.values()))  # nothing of a cut cell moves in any other way

    def test_three_pieces_move_as_they_are_held(self):
        for ranks in (1, 2):
            run = self.solve(Y | held(MOTIONS), ranks)
            self.assert_moves_rigidly(run)
            self.assertLess(abs(run.summary["results"]["strain_energy"]), 1e-9)  # of some 1e3 J if they were one

    def test_a_piece_that_nothing_holds_is_named(self):
        run = self.launch(Y | held(["above", "below"]))
        self.assertEqual(run.status, 1, run.err)
        self.assertIn("a part of the body", run.err)
        self.assertEqual(run.err.count("\n"), 1, run.err)

    def test_a_meeting_may_lie_anywhere_beside_an_edge(self):
        # Of 12 x 12 elements an edge is at x = 0.25. What is pulled up takes nothing along: the cracks part all of it.
        for beside in ("0.25", "0.250000000001", "0.2500000001", "0.25000001", "0.2501", "0.26"):
            cracks = {"-mesh_cells": "12,12", "-crack_through_points": f"0,0.62,{beside},0.49,1,0.4",
                      "-crack_branch_points": f"0.05,0,{beside},0.49"}  # fmt: skip
            held = {"-bc_names": "low,high,rest", "-bc_low_on": "bottom", "-bc_low_displacement": "0,0",
                    "-bc_high_on": "top", "-bc_high_displacement": "0,1e-3", "-bc_rest_box": "-1,0.1,0.02,0.4",
                    "-bc_rest_displacement": "0,0"}  # fmt: skip
            run = self.solve(Y | cracks | held)
            self.assertEqual(run.err, "")
            self.assertLess(abs(run.summary["results"]["strain_energy"]), 1e-9, beside)  # of some 1e3 J

    def test_a_branch_within_one_element_parts_nothing(self):
        held = {"-bc_names": "low,high", "-bc_low_on": "bottom", "-bc_low_displacement": "0,0", "-bc_high_on": "top",
                "-bc_high_displacement": "0,1e-3"}  # fmt: skip
        short = {"-crack_through_points": "0,0.52,0.6,0.52", "-crack_branch_points": "0.52,0.52,0.52,0.54"}
        alone = {"-crack_names": "through", "-crack_branch_points": None} | {"-crack_through_points": "0,0.52,0.6,0.52"}
        with_branch, without = (self.launch(Y | held | cracks) for cracks in (short, alone))
        self.assertIn("the crack tip at (0.52, 0.54) ends in elements", with_branch.err)
        a, b = (run.summary["results"]["strain_energy"] for run in (with_branch, without))
        self.assertLess(abs(a / b - 1.0), 1e-9)

    def test_a_crossing_is_solved_on_any_number_of_ranks(self):
        # On 3 ranks sweeps of multigrid were not definite.
        cross = {"-mesh_cells": "12,13", "-crack_names": "a,b",
                 "-crack_a_points": "0.63786648602735385,1,0.6048638697207811,0",
                 "-crack_b_points": "0.19805958867194517,0,1,0.71401348757604899"}  # fmt: skip
        held = {"-bc_names": "l,r,t,b", "-bc_l_on": "left", "-bc_l_displacement": "0,0", "-bc_l_box": "-1,0.02,2,0.98",
                "-bc_r_on": "right", "-bc_r_displacement": "1e-3,2e-4", "-bc_r_box": "-1,0.02,2,0.98", "-bc_t_on": "top",
                "-bc_t_displacement": "2e-4,1e-3", "-bc_b_on": "bottom", "-bc_b_displacement": "0,-5e-4"}  # fmt: skip
        scene = {name: value for name, value in Y.items() if "crack" not in name} | cross | held
        one, three = (self.solve(scene, ranks).summary["results"]["strain_energy"] for ranks in (1, 3))
        self.assertLess(abs(three / one - 1.0), 1e-9)

    def test_loads_reach_every_piece(self):
        held = {"-bc_names": "a,b,c,r"}
        for name, box in (("a", "-0.1,0.9,0.3,1.1"), ("b", "-0.1,-0.1,1.1,0.1"), ("c", "0.7,0.4,0.9,0.6")):
            held |= {f"-bc_{name}_box": box, f"-bc_{name}_displacement": "0,0"}
        for load in ({"-bc_r_on": "right", "-bc_r_traction": "1e6,2e5"},  # a side that two cracks part
                     {"-bc_r_box": "-1,-1,2,2", "-bc_r_body": "1e6,2e5"},
                     {"-bc_r_on": "right", "-bc_r_traction": "1e6,2e5", "-kinematics": "finite"}):  # fmt: skip
            run = self.solve(Y | held | load)
            reaction = np.sum(list(run.summary["results"]["reaction"].values()), axis=0)
            np.testing.assert_allclose(reaction, (-1e6, -2e5), rtol=1e-8)  # side and area are 1

    def test_a_restart_goes_on(self):
        pulled = Y | {"-analysis": "explicit", "-bc_names": "t,b", "-bc_t_on": "top", "-bc_t_traction": "0,1e6",
                      "-bc_b_on": "bottom", "-bc_b_displacement": "free,0", "-output_fields": None}  # fmt: skip
        whole = self.solve(pulled | {"-ts_max_steps": "60", "-checkpoint_interval": "60"})
        half = self.solve(pulled | {"-ts_max_steps": "30", "-checkpoint_interval": "30"})
        go_on = {"-restart": str(half.directory / "checkpoint.h5"), "-ts_max_steps": "60", "-checkpoint_interval": "60"}
        rest = self.solve(pulled | go_on, 2)
        (a, _), (b, _) = checkpoint(whole.directory), checkpoint(rest.directory)
        np.testing.assert_array_equal(a["row_names"], b["row_names"])
        for name in ("displacement", "velocity"):
            self.assertLess(np.abs(a[name] - b[name]).max(), 1e-10 * np.abs(a[name]).max(), name)

    def test_pieces_fly_side_by_side(self):
        whole = {"-bc_names": "all", "-bc_all_box": "-1,-1,2,2", "-bc_all_initial_velocity": "0.3,0.2"}
        for analysis, steps in (("explicit", {"-ts_max_steps": "50"}), ("implicit", {"-ts_max_steps": "5", "-ts_dt": "1e-5"})):
            run = self.solve(Y | whole | steps | {"-analysis": analysis})
            _, step = pdxtools.read_step(run.directory)
            moved = np.vstack([step[block]["displacement"][:, :2] for block in ("mesh", "cut_cells")])
            np.testing.assert_allclose(moved, np.broadcast_to(moved[0], moved.shape), atol=1e-9 * np.abs(moved).max())
            self.assertGreater(np.abs(moved).max(), 0.0)


def near_crack(x):
    """Near the border of two bodies, where points of cut cells lie twice."""
    return len({body_of(x + 0.02 * np.array([np.cos(a), np.sin(a)])) for a in np.linspace(0.1, 6.2, 16)}) > 1


if __name__ == "__main__":
    program.main()
