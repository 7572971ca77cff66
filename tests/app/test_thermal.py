"""Heat that strains the body: what is free expands without stress, what is held bears what the textbook says, and a strip that
is quenched has the stress of its temperature. Timoshenko, Goodier: Theory of Elasticity, ch. 13."""

import math

import program

import pdxtools
import numpy as np

ALPHA, YOUNG, POISSON, DEGREES = 7.5e-6, 370e9, 1.0 / 3.0, -280.0
EXACT = {"-pc_type": "cholesky", "-ksp_type": "preonly"}
HOT = {"-material_young": "370e9", "-material_expansion": "7.5e-6", "-thermal_initial": "300", "-quiet": "", "-output_fields": "",
       "-thermal_field": "uniform", "-thermal_ambient": "20"} | EXACT  # fmt: skip
# Elements with a patch and a crack that ends in it, held so that it may grow and shrink.
PLATE = HOT | {
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "10,10",
    "-pd_patches": "0.3,0.3,0.7,0.7",
    "-pd_spacing": "0.05",
    "-pd_horizon_ratio": "3",
    "-crack_names": "a",
    "-crack_a_points": "0,0.53,0.5,0.53",
    "-bc_names": "left,bottom",
    "-bc_left_on": "right",
    "-bc_left_displacement": "0,free",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_displacement": "free,0",
}
# All sides held square to themselves.
CLAMPED = PLATE | {
    "-crack_names": None,
    "-crack_a_points": None,
    "-bc_names": "left,right,bottom,top",
    "-bc_left_on": "left",
    "-bc_right_on": "right",
    "-bc_right_displacement": "0,free",
    "-bc_top_on": "top",
    "-bc_top_displacement": "free,0",
}


def cooled(depth, fourier):
    """Share of the difference of temperatures left in a wall whose face took on the medium's at once, by images."""
    scale, total = 2.0 * math.sqrt(fourier), 1.0
    for n in range(40):
        total -= (-1) ** n * (math.erfc((2 * n + depth) / scale) + math.erfc((2 * n + 2 - depth) / scale))
    return total


def last(run):
    return pdxtools.read_step(run.directory)[1]


class Thermal(program.ProgramTest):
    def expect_free(self, run, strain):
        """u = strain x from the right side and the bottom on, no stress and no energy."""
        for name, block in last(run).items():
            if "displacement" not in block or name == "cut_cells":
                continue
            exact = strain * (block.points[:, :2] - [1.0, 0.0])
            error = np.abs(block["displacement"][:, :2] - exact).max()
            self.assertLess(error, 1e-12 * abs(strain) + 1e-16, name)
        held = YOUNG * strain**2  # energy of the plate, were it held
        self.assertLess(abs(run.summary["results"]["strain_energy"]), 1e-12 * held)

    def test_a_free_body_shrinks_without_stress(self):
        for more in ({}, {"-kinematics": "mixed", "-load_steps": "2", "-pd_operator": "assembled"},
                     {"-material_plane": "strain", "-material_poisson": "0.25"}):  # fmt: skip
            run = self.solve(PLATE | more)
            strain = ALPHA * DEGREES * (1.25 if "-material_plane" in more else 1.0)
            self.expect_free(run, strain)
            stress = np.abs(last(run)["mesh"]["stress"]).max()
            self.assertLess(stress, 1e-9 * YOUNG * abs(strain))
            self.assertAlmostEqual(last(run)["particles"]["temperature"].max(), 20.0, places=10)

    def test_a_free_body_shrinks_alike_on_two_ranks(self):
        self.assert_same_displacement(self.solve(PLATE), self.solve(PLATE, 2), 1e-9)

    def test_what_is_held_bears_it(self):
        plane = (({}, POISSON, YOUNG / (1.0 - POISSON)), ({"-material_plane": "strain", "-material_poisson": "0.25"}, 0.25, YOUNG / 0.5))
        for more, poisson, modulus in plane:
            run = self.solve(CLAMPED | more)
            results, stress = run.summary["results"], -modulus * ALPHA * DEGREES
            strain = ALPHA * DEGREES * (1.0 + poisson if more else 1.0)
            self.assertAlmostEqual(results["reaction"]["left"][0] / -stress, 1.0, delta=1e-9)
            self.assertAlmostEqual(results["reaction"]["top"][1] / stress, 1.0, delta=1e-9)
            self.assertAlmostEqual(results["strain_energy"] / (-stress * strain), 1.0, delta=1e-9)
            nodes = last(run)["mesh"]["stress"]
            self.assertLess(np.abs(nodes[:, [0, 3]] / stress - 1.0).max(), 1e-9)

    def test_a_bar_between_two_walls(self):
        run = self.solve(CLAMPED | {"-bc_names": "left,right,bottom", "-bc_top_on": None, "-bc_top_displacement": None})
        results, stress = run.summary["results"], -YOUNG * ALPHA * DEGREES
        self.assertAlmostEqual(results["reaction"]["right"][0] / stress, 1.0, delta=1e-9)
        self.assertAlmostEqual(results["strain_energy"] / (0.5 * stress**2 / YOUNG), 1.0, delta=1e-9)

    def table(self, function, times=(0.0, 1.0), xs=(0.0, 1.0), ys=(0.0, 1.0)):
        path = self.scratch / "table.txt"
        rows = [f"{t!r} {x!r} {y!r} {function(t, x, y)!r}" for t in times for x in xs for y in ys]
        path.write_text("# time x y temperature\n" + "\n".join(rows) + "\n")
        return {"-thermal_field": "file", "-thermal_file": str(path), "-thermal_duration": "1", "-thermal_ambient": None}

    def test_straight_temperatures_bend_particles_without_stress(self):
        dx, slope = 0.05, 400.0
        strip = HOT | self.table(lambda t, x, y: 300.0 + t * slope * y) | {
            "-mesh_lower": "0,0", "-mesh_upper": "1,0.5", "-pd_patches": "all", "-pd_spacing": str(dx), "-pd_horizon_ratio": "3",
            "-bc_names": "left,pin", "-bc_left_on": "left", "-bc_left_displacement": "0,free",
            "-bc_pin_box": "0,0,0.05,0.05", "-bc_pin_displacement": "free,0"}  # fmt: skip
        for more in ({}, {"-load_steps": "3"}):
            run = self.solve(strip | more)
            particles = last(run)["particles"]
            x, y = particles.points[:, 0] - dx / 2, particles.points[:, 1]
            bend = ALPHA * slope
            exact = np.stack([bend * x * y, bend * (y**2 - (dx / 2) ** 2 - x**2) / 2], axis=1)
            self.assertLess(np.abs(particles["displacement"][:, :2] - exact).max(), 1e-11 * np.abs(exact).max())
            self.assertLess(run.summary["results"]["strain_energy"], 1e-20 * YOUNG * bend**2)

    def test_straight_temperatures_move_nodes_as_they_should(self):
        """Bilinear elements cannot bend without stress, but their nodes are where they belong."""
        run = self.solve(HOT | self.table(lambda t, x, y: 300.0 + 400.0 * t * y) | {
            "-mesh_lower": "0,0", "-mesh_upper": "1,0.5", "-mesh_cells": "16,8", "-bc_names": "left,pin", "-bc_left_on": "left",
            "-bc_left_displacement": "0,free", "-bc_pin_box": "0,0,0.001,0.001", "-bc_pin_displacement": "free,0"})  # fmt: skip
        mesh, bend = last(run)["mesh"], ALPHA * 400.0
        x, y = mesh.points[:, 0], mesh.points[:, 1]
        exact = np.stack([bend * x * y, bend * (y**2 - x**2) / 2], axis=1)
        self.assertLess(np.abs(mesh["displacement"][:, :2] - exact).max(), 1e-11 * np.abs(exact).max())

    def test_a_quenched_strip(self):
        """Far from its ends it stretches evenly by the mean: the stress along it is E alpha (mean T - T(y))."""
        length, half, time = 4.0, 0.5, 0.25
        run = self.solve(HOT | {
            "-mesh_lower": "0,0", "-mesh_upper": f"{length},{half}", "-mesh_cells": "64,32", "-thermal_field": "quench",
            "-pd_patches": "0,0.125,1,0.375", "-pd_spacing": "0.015625", "-pd_horizon_ratio": "3",
            "-thermal_conductivity": "31", "-thermal_capacity": "310", "-material_density": "1", "-thermal_sides": "bottom",
            "-thermal_duration": str(time), "-thermal_pace": "square", "-load_steps": "2", "-output_history": "",
            "-bc_names": "left,top", "-bc_left_on": "left", "-bc_left_displacement": "0,free", "-bc_top_on": "top",
            "-bc_top_displacement": "free,0"})  # fmt: skip
        fourier = 31.0 / 310.0 * time / half**2
        depths = (np.arange(400) + 0.5) / 400
        mean = np.mean([cooled(d, fourier) for d in depths])
        scale = YOUNG * ALPHA * -DEGREES
        blocks = last(run)
        mesh = blocks["mesh"]
        for point, stress, temperature in zip(mesh.points, mesh["stress"], mesh["temperature"]):
            share = cooled(point[1] / half, fourier)
            self.assertAlmostEqual(temperature, 20.0 + 280.0 * share, delta=1e-9)
            if 1.0 < point[0] < 2.0:
                # Across, strain is even in an element and temperature is not: at the surface half of that is left.
                outermost = point[1] < 0.01
                self.assertAlmostEqual(stress[0] / scale, mean - share, delta=0.02 if outermost else 0.005)
                self.assertAlmostEqual(stress[3] / scale, 0.0, delta=0.05 if outermost else 0.005)
        particles = blocks["particles"]
        for point, energy in zip(particles.points, particles["strain_energy_density"]):
            if 0.3 < point[0] < 0.7 and 0.2 < point[1] < 0.3:
                share = cooled(point[1] / half, fourier)
                self.assertAlmostEqual(math.sqrt(2.0 * YOUNG * energy) / scale, abs(mean - share), delta=0.01)
        self.assertEqual([row["time"] for row in run.history()], [time / 4, time])

    def test_bonds_break_at_the_stretch_beyond_their_own(self):
        """Where all is held they break when alpha times the degrees lost comes to the critical stretch; where nothing is, never."""
        bar = {"-pd_critical_stretch": str(0.775 * ALPHA * -DEGREES), "-load_steps": "20", "-output_history": ""}
        for kinematics in ("small", "mixed"):
            how = bar | {"-kinematics": kinematics, "-load_halvings": "0"}
            run = self.launch(CLAMPED | how)
            broken = {round(20 * row["load"]): row["bonds_broken"] for row in run.history()}
            self.assertEqual([broken[k] for k in range(1, 16)], [0.0] * 15)
            self.assertGreater(broken.get(16, 1.0), 0.0)
            free = self.solve(PLATE | how | {"-crack_names": None, "-crack_a_points": None})
            self.assertEqual(free.summary["bonds_broken"], 0)

    def test_stretches_that_vary_by_place(self):
        """Where nothing moves all bonds bear the same stretch s, and with it those break whose own is below: of factors
        1 + w (z_i + z_j) / 2 with even z those below 1 - w q are (1 - q)^2 / 2, for q above 0."""
        sheet = HOT | {
            "-mesh_lower": "0,0", "-mesh_upper": "0.06,0.06", "-pd_patches": "all", "-pd_spacing": "0.001", "-pd_horizon_ratio": "3.015",
            "-bc_names": "all", "-bc_all_on": "left", "-bc_all_rows": "60", "-bc_all_displacement": "0,0", "-load_broken_share": "1"}  # fmt: skip
        broken = {}
        for width, q, seed in ((0.3, 0.4, 1), (0.3, 0.4, 2), (0.1, 0.4, 1), (0.3, 0.0, 1)):
            critical = ALPHA * -DEGREES / (1.0 - width * q)
            how = {"-pd_scatter": str(width), "-pd_scatter_seed": str(seed), "-pd_critical_stretch": str(critical)}
            runs = [self.solve(sheet | how, ranks) for ranks in ((1, 2, 3) if seed == 2 else (1,))]
            counts = {run.summary["bonds_broken"] for run in runs}
            self.assertEqual(len(counts), 1)
            broken[width, q, seed] = counts.pop()
            bonds = 60 * 60 * 14  # half a family of 28, but for the border
            self.assertAlmostEqual(broken[width, q, seed] / bonds, (1.0 - q) ** 2 / 2.0, delta=0.04)
        self.assertEqual(broken[0.3, 0.4, 1], broken[0.1, 0.4, 1])  # the same sites
        self.assertNotEqual(broken[0.3, 0.4, 1], broken[0.3, 0.4, 2])

    def test_a_table_that_ends_before_the_body_is_told(self):
        table = self.scratch / "short.heat"
        table.write_text("".join(f"{t} {x} {y} {300 - 100 * t}\n" for t in (0, 1) for x in (0, 0.5) for y in (0, 1)))
        heat = {"-mesh_lower": "0,0", "-mesh_upper": "1,1", "-mesh_cells": "4,4", "-material_young": "1e9", "-material_expansion": "1e-5",
                "-thermal_field": "file", "-thermal_initial": "300", "-thermal_duration": "1", "-thermal_file": str(table),
                "-bc_names": "l", "-bc_l_on": "left", "-bc_l_displacement": "0,0", "-quiet": ""}  # fmt: skip
        self.assertRegex(self.launch(heat).err, r"^warning: -thermal_file goes from 0 to 0\.5 m along x, and the body from 0 to 1")
        self.assertRegex(self.launch(heat | {"-mesh_upper": "0.5,1", "-thermal_duration": "5"}).err, r"0 to 1 s in time, and the run from 0 to 5")
        self.assertEqual(self.launch(heat | {"-mesh_upper": "0.5,1"}).err, "")


program.main()
