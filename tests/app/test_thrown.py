"""One half of a body that a crack cuts in two is thrown, pushed or held, and the other does not notice.

Usage: test_thrown.py PDXSOLVE [unittest arguments].
"""

import program

# 0.1 x 0.1 m, 1 m thick, cut through at x = 0.053 m (inside elements): 13.25 kg left of the crack, 11.75 kg right.
LEFT, RIGHT = 13.25, 11.75
CUT = {
    "-mesh_lower": "0,0",
    "-mesh_upper": "0.1,0.1",
    "-mesh_cells": "10,10",
    "-material_young": "70e9",
    "-material_density": "2500",
    "-analysis": "explicit",
    "-ts_max_time": "2e-6",
    "-crack_names": "c",
    "-crack_c_points": "0.053,-1,0.053,1",
    "-output_fields": "",
    "-quiet": "",
}
LEFT_BOX, RIGHT_BOX = "-1,-1,0.053,1", "0.053,-1,1,1"
PATCH = CUT | {
    "-mesh_cells": "20,20",
    "-pd_patches": "0.03,0.03,0.07,0.07",
    "-pd_spacing": "2.5e-3",
    "-crack_c_points": "0.05,-1,0.05,1",
}


class Thrown(program.ProgramTest):
    def kinetic(self, options, ranks=1):
        return self.solve(options, ranks).summary["results"]["kinetic_energy"]

    def throw(self, options, box, ranks=1):
        thrown = {"-bc_names": "t", "-bc_t_box": box, "-bc_t_initial_velocity": "0,10"}
        return self.solve(options | thrown, ranks)

    def test_a_half_has_its_own_energy_and_the_other_none(self):
        for box, mass, ranks in ((LEFT_BOX, LEFT, 1), (RIGHT_BOX, RIGHT, 1), (RIGHT_BOX, RIGHT, 2)):
            with self.subTest(box=box, ranks=ranks):
                run = self.throw(CUT, box, ranks)
                self.assertAlmostEqual(run.summary["results"]["kinetic_energy"], 50.0 * mass, delta=1e-9 * mass)
                self.assertLess(run.summary["results"]["strain_energy"], 1e-9)
                blocks = program.pdxtools.read_step(run.directory)[1]
                moved = blocks["mesh"]["displacement"][:, 1]
                inside = blocks["mesh"].points[:, 0] < 0.053 if box == LEFT_BOX else blocks["mesh"].points[:, 0] > 0.053
                self.assertLess(abs(moved[inside] - 2e-5).max(), 1e-14)
                self.assertLess(abs(moved[~inside]).max(), 1e-18)

    def test_with_a_patch_and_a_crack_between_rows(self):
        run = self.throw(PATCH, "-1,-1,0.05,1")
        self.assertAlmostEqual(run.summary["results"]["kinetic_energy"], 625.0, delta=1e-6)
        self.assertLess(run.summary["results"]["strain_energy"], 1e-9)

    def test_both_halves_apart(self):
        both = {
            "-bc_names": "l,r",
            "-bc_l_box": LEFT_BOX,
            "-bc_l_initial_velocity": "-3,0",
            "-bc_r_box": RIGHT_BOX,
            "-bc_r_initial_velocity": "4,0",
        }
        self.assertAlmostEqual(self.kinetic(CUT | both), 0.5 * (9 * LEFT + 16 * RIGHT), delta=1e-7)

    def test_a_crack_along_a_line_of_nodes(self):
        on_nodes = CUT | {"-crack_c_points": "0.05,-1,0.05,1"}
        for box in ("-1,-1,0.05,1", "0.05,-1,1,1"):
            run = self.throw(on_nodes, box)
            self.assertAlmostEqual(run.summary["results"]["kinetic_energy"], 625.0, delta=1e-3)
            self.assertLess(run.summary["results"]["strain_energy"], 1e-6)

    def test_body_force_on_a_half(self):
        weight = {"-bc_names": "w", "-bc_w_box": RIGHT_BOX, "-bc_w_body": "0,2.5e7"}  # 1e4 m/s^2: 0.02 m/s at the end
        run = self.solve(CUT | weight)
        energy = run.summary["results"]["kinetic_energy"]
        self.assertAlmostEqual(energy / (0.5 * RIGHT * 0.02**2), 1.0, delta=0.01)  # cut cells are lumped
        left = program.pdxtools.read_step(run.directory)[1]["mesh"]
        self.assertLess(abs(left["displacement"][left.points[:, 0] < 0.053]).max(), 1e-18)

    def test_a_half_that_is_held_leaves_the_other_free(self):
        held = {
            "-bc_names": "h,t",
            "-bc_h_box": LEFT_BOX,
            "-bc_h_displacement": "0,0",
            "-bc_t_box": RIGHT_BOX,
            "-bc_t_initial_velocity": "0,10",
        }
        run = self.solve(CUT | held)
        self.assertAlmostEqual(run.summary["results"]["kinetic_energy"], 50.0 * RIGHT, delta=1e-6)
        self.assertLess(run.summary["results"]["strain_energy"], 1e-6)

    def test_a_half_that_is_moved_leaves_the_other_at_rest(self):
        moved = {"-bc_names": "h", "-bc_h_box": LEFT_BOX, "-bc_h_velocity": "0,10"}
        run = self.solve(CUT | moved)
        right = program.pdxtools.read_step(run.directory)[1]["mesh"]
        at_rest = right["displacement"][right.points[:, 0] > 0.053]
        self.assertLess(abs(at_rest).max(), 1e-18)

    def test_a_crack_beside_a_held_side_parts_the_body_from_it(self):
        # What lies beyond the crack moves as its own side does: nothing is strained. As one body it holds some 4e4 J.
        across = {"-crack_c_points": "0,0.007,0.1,0.003"}
        joined = {"-crack_names": "c,d", "-crack_c_points": "0,0.007,0.1,0.007", "-crack_d_points": "0.053,0.007,0.053,0"}
        beside_right = {"-crack_c_points": "0.093,-1,0.098,1"}
        for sides, crack in ((("bottom", "top"), across), (("top", "bottom"), across), (("bottom", "top"), joined),
                             (("right", "left"), beside_right)):  # fmt: skip
            for ranks in (1, 2):
                with self.subTest(sides=sides, crack=crack, ranks=ranks):
                    held = {"-analysis": "static", "-ts_max_time": None, "-bc_names": "a,b", "-bc_a_on": sides[0],
                            "-bc_a_displacement": "0,0", "-bc_b_on": sides[1], "-bc_b_displacement": "2e-5,1e-4"}  # fmt: skip
                    run = self.solve(CUT | crack | held, ranks)
                    self.assertLess(abs(run.summary["results"]["strain_energy"]), 1e-8)

    def test_a_side_that_moves_leaves_what_a_crack_parts_from_it_at_rest(self):
        moved = {"-crack_c_points": "0,0.007,0.1,0.003", "-bc_names": "h", "-bc_h_on": "bottom", "-bc_h_velocity": "0,10"}
        for ranks in (1, 2):
            run = self.solve(CUT | moved, ranks)
            above = program.pdxtools.read_step(run.directory)[1]["mesh"]
            self.assertLess(abs(above["displacement"][above.points[:, 1] > 0.008]).max(), 1e-18)


if __name__ == "__main__":
    program.main()
