"""A scene that is moved, scaled or mirrored as a whole gives the same answer.

Usage: test_moved.py PDXSOLVE [unittest arguments].
"""

import math

import program

PLACES = ("-mesh_lower", "-mesh_upper", "-pd_patches", "-pd_no_fail", "-post_j_centre")
ENDINGS = ("_points", "_box", "_at")
VECTORS = ((5e5, 4.5e6), (1e3, -1e3), (1 / 3, math.pi), (-2e8, 1e7))

# Elements, a patch, a crack whose tip is a corner of the lattice, and bonds through it.
TIP = program.PULLED | {
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "20,20",
    "-pd_patches": "0.25,0.25,0.75,0.75",
    "-pd_spacing": "0.025",
    "-bc_names": "b,t,p",
    "-bc_p_at": "0.9,0.7",
    "-bc_p_force": "1e3,0",
    "-crack_names": "c",
    "-crack_c_points": "0,0.5,0.5,0.5",
}
RUNNING = TIP | {
    "-analysis": "explicit",
    "-material_density": "1000",
    "-ts_max_time": "2e-3",
    "-material_toughness": "100",
    "-pd_no_fail": "0.25,0.25,0.75,0.3125",
    "-bc_t_displacement": None,
    "-bc_t_velocity": "0,0.5",
    "-bc_b_box": "0,0,0.5,0.1",
}


def is_place(name):
    return name in PLACES or name.endswith(ENDINGS)


def mapped(options, function):
    """Every place (x, y) of the options through a function."""
    changed = dict(options)
    for name, value in options.items():
        if value is None or not is_place(name):
            continue
        numbers = [float(word) for word in value.split(",")]
        pairs = [function(*numbers[k : k + 2]) for k in range(0, len(numbers), 2)]
        changed[name] = ",".join(repr(x) for pair in pairs for x in pair)
    return changed


def moved(options, vector):
    return mapped(options, lambda x, y: (x + vector[0], y + vector[1]))


def scaled(options, factor):
    """Lengths, spacings and displacements times a factor; thickness 1 stays, so that energies scale with its square."""
    changed = mapped(options, lambda x, y: (x * factor, y * factor))
    for name in ("-pd_spacing", "-bc_t_displacement", "-bc_p_force"):
        if changed.get(name):
            changed[name] = ",".join(repr(float(word) * factor) for word in changed[name].split(","))
    return changed


class Moved(program.ProgramTest):
    CRACKS_REACH_BORDERS = True

    def energy(self, options, ranks=1):
        return self.solve(options, ranks).summary["results"]["strain_energy"]

    def test_at_rest(self):
        here = self.solve(TIP).summary["results"]
        for vector in VECTORS:
            with self.subTest(vector=vector):
                there = self.solve(moved(TIP, vector)).summary["results"]
                self.assertLess(abs(there["strain_energy"] / here["strain_energy"] - 1), 1e-9)
                tip = there["crack_tips"][0]
                self.assertAlmostEqual(tip[0] - vector[0], 0.5, delta=1e-7)
                self.assertAlmostEqual(tip[1] - vector[1], 0.5, delta=1e-7)

    def test_in_motion(self):
        here = self.solve(RUNNING)
        self.assertGreater(here.summary["bonds_broken"], 20)
        for vector in VECTORS[:3]:
            with self.subTest(vector=vector):
                there = self.solve(moved(RUNNING, vector), ranks=2 if vector is VECTORS[0] else 1)
                self.assertEqual(there.summary["bonds_broken"], here.summary["bonds_broken"])
                for name in ("strain_energy", "kinetic_energy", "fracture_energy", "stable_step"):
                    a, b = (run.summary["results"][name] for run in (here, there))
                    self.assertLess(abs(a / b - 1), 1e-9, name)

    def test_fields_lie_where_the_body_is(self):
        vector = VECTORS[0]
        here, there = (
            program.pdxtools.read_step(self.solve(options | {"-output_fields": ""}).directory)[1]
            for options in (TIP, moved(TIP, vector))
        )
        for block in here:
            gap = there[block].points[:, :2] - here[block].points[:, :2]
            self.assertLess(abs(gap - vector).max(), 2e-9, block)

    def test_scaled(self):
        here = self.energy(TIP)
        for factor in (1e-3, 1e3, 1 / 3):
            with self.subTest(factor=factor):
                self.assertLess(abs(self.energy(scaled(TIP, factor)) / factor**2 / here - 1), 1e-9)

    def test_scaled_and_moved(self):
        here = self.energy(TIP)
        there = self.energy(moved(scaled(TIP, 1 / 3), (1e3, 7e2)))
        self.assertLess(abs(there * 9 / here - 1), 1e-8)

    def test_mirrored(self):
        mirror = mapped(TIP, lambda x, y: (1 - x, y))
        for name in ("-mesh_lower", "-mesh_upper", "-pd_patches"):
            mirror[name] = TIP[name]
        mirror["-crack_c_points"] = "0.5,0.5,1,0.5"  # what was left of it is left again
        mirror["-bc_p_force"] = "-1e3,0"
        self.assertLess(abs(self.energy(mirror) / self.energy(TIP) - 1), 1e-9)

    def test_cloud(self):
        sites = [(0.05 + 0.1 * i, 0.05 + 0.1 * j) for j in range(10) for i in range(10)]
        cloud = {
            "-pd_horizon": "0.3",
            "-pd_micromodulus": "uniform",
            "-material_young": "1e9",
            "-material_density": "1000",
            "-analysis": "explicit",
            "-ts_max_time": "1e-3",
            "-bc_names": "l,r",
            "-bc_l_box": "0,0,0.1,1",
            "-bc_l_displacement": "0,0",
            "-bc_r_box": "0.95,0,1,1",
            "-bc_r_velocity": "1,0",
            "-crack_names": "c",
            "-crack_c_points": "0.5,-0.1,0.5,0.5",
            "-quiet": "",
        }
        energies = []
        for vector in ((0.0, 0.0), *VECTORS[:3]):
            file = self.scratch / "cloud.csv"
            rows = [f"{x + vector[0]!r},{y + vector[1]!r},0.01" for x, y in sites]
            file.write_text("x,y,volume\n" + "\n".join(rows) + "\n", encoding="utf-8")
            energies.append(self.energy(moved(cloud, vector) | {"-pd_cloud": str(file)}))
        for energy in energies[1:]:
            self.assertLess(abs(energy / energies[0] - 1), 1e-9)

    def test_too_far_is_refused(self):
        run = self.launch(moved(TIP, (0.0, 1e13)), ranks=2)
        self.assertEqual(run.status, 1)
        self.assertRegex(run.err, r"^.*corner at \(0, 1e\+13\).*told apart to 0\.01 m.*nearer to the origin\n$")


if __name__ == "__main__":
    program.main()
