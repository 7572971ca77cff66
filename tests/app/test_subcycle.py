"""Steps of particles within steps of elements (-ts_subcycle): momentum, energy, convergence, ranks and restarts."""

import numpy as np
import program
from program import pdxtools

CELLS, RATIO = 18, 6  # elements along a side, particles along one of them
INNER = (6, 12)  # columns and rows of elements that particles take the place of
THROWN, SIZE = (1e-3, 2e-3), 1.0 / CELLS
# A free plate thrown at one corner.
FREE = {
    "-case": "subcycle",
    "-analysis": "explicit",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": f"{CELLS},{CELLS}",
    "-material_young": "1",
    "-material_poisson": "0.33333333333333333",
    "-material_density": "1",
    "-pd_patches": ",".join(repr(k * SIZE) for k in (INNER[0], INNER[0], INNER[1], INNER[1])),
    "-pd_spacing": repr(SIZE / RATIO),
    "-pd_horizon_ratio": "3",
    "-bc_names": "hit",
    "-bc_hit_box": "-0.01,-0.01,0.2,0.2",
    "-bc_hit_initial_velocity": "{},{}".format(*THROWN),
    "-ts_max_time": "3",
    "-output_fields": "",
    "-quiet": "",
}
# The same held on the left and pulled apart through the patch until bonds break.
TORN = FREE | {
    "-bc_names": "left,right",
    "-bc_hit_box": None,
    "-bc_hit_initial_velocity": None,
    "-bc_left_on": "left",
    "-bc_left_displacement": "0,0",
    "-bc_right_on": "right",
    "-bc_right_velocity": "0.01,0",
    "-crack_names": "notch",
    "-crack_notch_points": "0.4,0.5,0.5,0.5,0.6,0.51",
    "-bc_right_history": "ramp",
    "-bc_right_history_width": "0.5",
    "-pd_critical_stretch": "0.01",
    "-output_history": "",
    "-output_history_interval": "5",
}


def by_parts(options, parts):
    return options | {"-ts_subcycle": str(parts)}


def masses(points):
    """Of the nodes of the elements that are left, lumped: a quarter of each element around."""
    mass = np.zeros(len(points))
    column = np.rint(points[:, :2] / SIZE).astype(int)
    for across in (-1, 0):
        for along in (-1, 0):
            cell = column + (across, along)
            there = ((cell >= 0) & (cell < CELLS)).all(axis=1)
            taken = ((cell >= INNER[0]) & (cell < INNER[1])).all(axis=1)
            mass += 0.25 * SIZE**2 * (there & ~taken)
    return mass


class Subcycle(program.ProgramTest):
    CRACKS_REACH_BORDERS = True

    def test_keeps_momentum(self):
        """The centre of mass of a free body goes on evenly: sum m u = t sum m v(0) [closed form]."""
        run = self.shared(by_parts(FREE, 2))
        time, blocks = pdxtools.read_step(run.directory)
        mesh, particles = blocks["mesh"], blocks["particles"]
        mass = masses(mesh.points)
        self.assertAlmostEqual(mass.sum() + len(particles.points) * (SIZE / RATIO) ** 2, 1.0, places=12)
        thrown = mass[(mesh.points[:, :2] < 0.2).all(axis=1)].sum()
        moved = mass @ mesh["displacement"][:, :2] + (SIZE / RATIO) ** 2 * particles["displacement"][:, :2].sum(axis=0)
        for found, velocity in zip(moved, THROWN):
            self.assertAlmostEqual(found / (thrown * velocity * time), 1.0, delta=1e-12)

    def test_keeps_energy(self):
        """Nothing is lost or made in 40 crossings but what impulses move to and fro."""
        run = self.solve(by_parts(FREE, 2) | {"-ts_max_time": "40", "-output_history": "", "-output_fields": None})
        off = np.abs([row["energy_residual"] for row in run.history()]) / run.summary["results"]["initial_energy"]
        self.assertLess(off.max(), 2e-3)
        self.assertLess(off[len(off) // 2:].max(), 2.0 * off[:len(off) // 2].max())

    def test_comes_to_the_same_as_steps_shrink(self):
        """Impulses are of second order: half the step, a quarter of the difference to whole steps."""
        differences = []
        whole = self.solve(FREE | {"-ts_dt": "5e-4", "-ts_max_time": "1"})
        for step in ("1.6e-2", "8e-3"):
            run = self.solve(by_parts(FREE, 2) | {"-ts_dt": step, "-ts_max_time": "1"})
            a, b = (pdxtools.read_step(one.directory)[1]["mesh"]["displacement"] for one in (run, whole))
            differences.append(np.linalg.norm(a - b) / np.linalg.norm(b))
        self.assertLess(differences[0], 0.05)
        self.assertGreater(differences[0] / differences[1], 3.5)

    def test_is_the_same_on_more_ranks_and_after_a_restart(self):
        torn = by_parts(TORN, 2)
        whole = self.solve(torn)
        self.assertGreater(whole.summary["bonds_broken"], 20)
        self.assertEqual(whole.summary["results"]["subcycle"], 2)
        two = self.solve(torn, 2)
        self.assertEqual(two.summary["bonds_broken"], whole.summary["bonds_broken"])
        self.assert_same_displacement(whole, two, tolerance=1e-9)
        directory, half = self.scratch / "half", whole.summary["steps"] // 2
        self.solve(torn | {"-ts_max_steps": str(half), "-checkpoint_interval": str(half)}, directory=directory)
        rest = self.solve(torn | {"-restart": str(directory / "checkpoint.h5")}, directory=directory)
        after, at_once = ({name: value for name, value in one.summary["results"].items() if not name.startswith("pd_tiles")}
                          for one in (rest, whole))  # but for the work since the start of a run
        self.assertEqual(after, at_once)
        self.assert_same_displacement(whole, rest, tolerance=0.0)
        residual = max(abs(row["energy_residual"]) for row in whole.history())
        self.assertLess(residual, 0.02 * whole.summary["results"]["external_work"])
        run = self.launch(TORN | {"-restart": str(directory / "checkpoint.h5")}, directory=directory)
        self.assertEqual(run.status, 1)
        self.assertIn("-ts_subcycle", run.err)


if __name__ == "__main__":
    program.main()
