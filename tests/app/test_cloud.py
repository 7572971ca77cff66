"""Particles read from a file: on lattice points they give the lattice's answers, elsewhere a continuum's."""

import program
import torn
from program import pdxtools

import h5py
import numpy as np

DX = 0.001
# The notched plate of torn.py, torn by body forces on its outermost rows: the same for a lattice and for a cloud.
PLATE = torn.TORN | {
    "-kinematics": "finite",
    "-crack_notch_points": "-0.001,0.02,0.03,0.02",
    "-bc_top_on": None,
    "-bc_top_traction": None,
    "-bc_top_box": "0,0.039,0.08,0.04",
    "-bc_top_body": "0,2e9",
    "-bc_top_history": "ramp",
    "-bc_top_history_width": "5e-5",
    "-bc_bottom_on": None,
    "-bc_bottom_displacement": None,
    "-bc_bottom_box": "0,0,0.08,0.001",
    "-bc_bottom_velocity": "free,-1",
}
LATTICE = PLATE | {"-pd_calibration": "continuum", "-pd_surface_correction": "none"}
GONE = ("-mesh_lower", "-mesh_upper", "-pd_patches", "-pd_spacing", "-pd_horizon_ratio")
CLOUD = PLATE | {name: None for name in GONE} | {"-pd_horizon": "0.003"}
# The same rows by their sets, pulled by a force in all: 80 particles of 1e-6 m^3 under 2e9 N/m^3.
BY_SETS = {
    "-bc_top_box": None,
    "-bc_top_set": "1",
    "-bc_top_body": None,
    "-bc_top_force": "0,160000",
    "-bc_bottom_box": None,
    "-bc_bottom_set": "-2",
}
DEPTH = 6
BLOCK = LATTICE | {
    "-material_plane": "solid",
    "-material_thickness": str(DEPTH * DX),
    "-mesh_upper": "0.02,0.016",
    "-pd_horizon_ratio": "2.015",
    "-pd_micromodulus": "uniform",
    "-crack_notch_points": "-0.001,0.008,0.006,0.008",
    "-bc_top_box": "0,0.015,0.02,0.016",
    "-bc_bottom_box": "0,0,0.02,0.001",
    "-bc_bottom_velocity": "free,-1,free",
    "-ts_max_steps": "200",
}
BLOCK_CLOUD = BLOCK | {name: None for name in (*GONE, "-material_thickness")} | {"-pd_horizon": "0.002015"}
TABLES = ("displacement", "velocity", "acceleration", "held_force", "gone_bonds")


def lattice(*count):
    """Points of a lattice, x fastest."""
    axes = [DX * (np.arange(n) + 0.5) for n in reversed(count)]
    return np.stack([x.ravel() for x in reversed(np.meshgrid(*axes, indexing="ij"))], axis=1)


def jittered(nx, ny, seed):
    return lattice(nx, ny) + 0.2 * DX * np.random.default_rng(seed).uniform(-1, 1, (nx * ny, 2))


def sets_of(points, height=0.04):
    """1 for the uppermost row, -2 for the lowest, else 0."""
    return np.where(points[:, 1] > height - DX, 1, np.where(points[:, 1] < DX, -2, 0))


class Cloud(program.ProgramTest):
    def csv(self, points, sets=None, name="cloud.csv"):
        dim = points.shape[1]
        head = ["x", "y", "z"][:dim] + ["volume"] + ([] if sets is None else ["set"])
        rows = [[*map(repr, map(float, x)), repr(DX**dim)] for x in points]
        for row, number in zip(rows, [] if sets is None else sets):
            row.append(str(number))
        path = self.scratch / name
        path.write_text("\n".join(map(",".join, [head, *rows])) + "\n", encoding="utf-8")
        return {"-pd_cloud": str(path)}

    def hdf5(self, points, sets):
        path = self.scratch / "cloud.h5"
        with h5py.File(path, "w") as file:
            file["position"] = points
            file["volume"] = np.full(len(points), DX ** points.shape[1])
            file["set"] = sets
        return {"-pd_cloud": str(path)}

    def assert_same_history(self, a, b, tolerance):
        a, b = a.history(), b.history()
        self.assertEqual(len(a), len(b))
        names = [name for name in a[0] if name.startswith(("energy", "work", "reaction"))]
        largest = max(abs(row["work"]) for row in a)
        for row, other in zip(a, b):
            self.assertEqual((row["step"], row["bonds_broken"]), (other["step"], other["bonds_broken"]))
            for name in names:
                scale = largest if not name.startswith("reaction") else max(abs(r[name]) for r in a)
                self.assertAlmostEqual(row[name], other[name], delta=tolerance * scale, msg=name)

    def assert_same_checkpoint(self, a, b):
        (a, _), (b, _) = torn.checkpoint(a.directory), torn.checkpoint(b.directory)
        moved = a["displacement"].any(axis=1).sum(), b["displacement"].any(axis=1).sum()
        self.assertGreater(min(moved), 0)
        for name in TABLES:
            np.testing.assert_array_equal(a[name], b[name], name)

    def test_on_lattice_points_it_breaks_and_moves_as_the_lattice(self):
        expected = self.solve(LATTICE)
        self.assertGreater(expected.summary["bonds_broken"], 500)
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                self.assert_same_history(expected, self.solve(CLOUD | self.csv(lattice(80, 40)), ranks), 1e-9)

    def test_in_space_too(self):
        points = lattice(20, 16, DEPTH)
        expected = self.solve(BLOCK)
        self.assertGreater(expected.summary["bonds_broken"], 500)
        self.assert_same_history(expected, self.solve(BLOCK_CLOUD | self.csv(points), 2), 1e-9)

    def test_sets_choose_as_boxes_do_from_either_kind_of_file(self):
        points = lattice(80, 40)
        expected = self.solve(CLOUD | self.csv(points))
        for file in (self.csv(points, sets_of(points)), self.hdf5(points, sets_of(points))):
            self.assert_same_history(expected, self.solve(CLOUD | BY_SETS | file), 1e-9)

    def test_ranks_and_restarts_change_no_bit(self):
        points = jittered(80, 40, 3)
        options = CLOUD | BY_SETS | self.csv(points, sets_of(points))
        whole = self.solve(options | {"-checkpoint_interval": "400"})
        self.assertGreater(whole.summary["bonds_broken"], 500)
        for ranks in (2, 3):
            with self.subTest(ranks=ranks):
                self.assert_same_checkpoint(whole, self.solve(options | {"-checkpoint_interval": "400"}, ranks))
        for ranks in (1, 2):
            with self.subTest(renewed_on=ranks):
                renewed = {"-checkpoint_interval": "400", "-layout_renew_interval": "9"}
                self.assert_same_checkpoint(whole, self.solve(options | renewed, ranks))
        for before, after in ((1, 1), (2, 1), (1, 2)):
            with self.subTest(before=before, after=after):
                half = self.scratch / f"half_{before}_{after}"
                self.solve(options | {"-ts_max_steps": "200", "-checkpoint_interval": "200"}, before, half)
                restart = {"-restart": str(half / "checkpoint.h5"), "-checkpoint_interval": "400"}
                rest = self.solve(options | restart, after, half)
                self.assert_same_checkpoint(whole, rest)
                if (before, after) == (1, 1):
                    self.assertEqual(whole.summary["results"], rest.summary["results"])
                    self.assertEqual((whole.directory / "history.csv").read_bytes(), (half / "history.csv").read_bytes())

    def test_a_checkpoint_of_another_cloud_is_refused(self):
        options = CLOUD | {"-ts_max_steps": "2"}
        points = jittered(80, 40, 3)
        run = self.solve(options | self.csv(points) | {"-checkpoint_interval": "2"})
        inside = points.copy()
        inside[1640] += 1e-5  # neither the body nor its corner change
        for other, words in ((inside, "cloud = 3200 particles"), (jittered(80, 40, 4), "corner of the body = ")):
            with self.subTest(words):
                refused = self.launch(options | self.csv(other) | {"-restart": str(run.directory / "checkpoint.h5")})
                self.assertEqual(refused.status, 1)
                self.assertRegex(refused.err, rf"-restart is .* another scene.*{words}")

    def test_fields_show_what_the_file_says_and_what_moves(self):
        points = jittered(80, 40, 3)
        sets = sets_of(points)
        run = self.solve(CLOUD | self.csv(points, sets) | {"-output_fields": "", "-ts_max_steps": "100"}, 2)
        block = pdxtools.read_step(run.directory)[1]["particles"]
        order = np.argsort(block.natural_point)
        np.testing.assert_allclose(block.points[order, :2], points, rtol=0, atol=1e-13)  # counted from the corner
        np.testing.assert_array_equal(block["set"][order], sets)
        np.testing.assert_allclose(block["volume"], DX * DX)
        bottom = order[points[:, 1] < DX]
        np.testing.assert_allclose(block["velocity"][bottom, 1], -1.0)
        beside = block["precrack"][order][(abs(points[:, 1] - 0.02) < 0.4 * DX) & (points[:, 0] < 0.025)]
        self.assertGreater(beside.min(), 0.2)
        self.assertEqual(run.summary["unknowns"]["pd"], 6400)
        self.assertFalse([name for name in run.summary["results"] if "tip" in name or "tiles" in name])

    def test_what_is_not_asked_for_is_not_done(self):
        options = {name: value for name, value in CLOUD.items() if "crack" not in name and "critical" not in name}
        run = self.solve(options | self.csv(lattice(20, 40)) | {"-ts_max_steps": "5", "-output_history": None})
        events = [name for name in run.events if name.startswith(("pd", "io", "fe", "couple"))]
        self.assertEqual(events, ["pd_force"])
        self.assertEqual(run.files, ["citations.bib", "options.opts", "summary.json"])

    def test_jittered_particles_carry_plane_waves_at_the_speed_of_the_bulk(self):
        """Behind the front that a wall sends out at speed v0 the strain is -v0/c, until the sides are felt."""
        speed, wall = np.sqrt(1e9 / (1 - 1 / 9) / 1000), 0.01
        points = jittered(70, 80, 7)
        end = 40 * DX / speed
        options = {
            "-analysis": "explicit",
            "-material_young": "1e9",
            "-material_density": "1000",
            "-pd_horizon": str(4 * DX),
            "-bc_names": "wall",
            "-bc_wall_set": "1",
            "-bc_wall_velocity": f"{wall},0",
            "-bc_wall_history": "ramp",
            "-bc_wall_history_width": repr(float(0.25 * end)),
            "-ts_max_time": repr(float(end)),
            "-output_fields": "",
            "-quiet": "",
        }
        run = self.solve(options | self.csv(points, (points[:, 0] < 4 * DX).astype(int)), 2)
        block = pdxtools.read_step(run.directory)[1]["particles"]
        x, y = block.points[:, 0], block.points[:, 1]
        inner = (x > 8 * DX) & (x < 20 * DX) & (abs(y - 40 * DX) < 8 * DX)
        strain = np.polyfit(x[inner], block["displacement"][inner, 0], 1)[0]
        self.assertAlmostEqual(-wall / strain / speed, 1.0, delta=0.03)


if __name__ == "__main__":
    program.main()
