"""The answer does not depend on the number of ranks, and on the same ranks it is the same to the last bit.

Usage: test_ranks.py PDXSOLVE [unittest arguments].
"""

import h5py
import program
from program import PATCH, PLATE

FIELDS = {"-output_fields": ""}


def write_gmsh(path, cells, patch):
    """Writes the unit square in cells x cells quadrilaterals as Gmsh 2.2 text; nodes beyond the cells first ... last of
    `patch` are moved by up to a fifth of a cell, sides excepted."""
    first, last = patch

    def place(i, j):
        fixed = (first - 1 <= i <= last + 1 and first - 1 <= j <= last + 1) or i in (0, cells) or j in (0, cells)
        shift = 0.0 if fixed else 0.2
        return (i + shift * (-1) ** j) / cells, (j + shift * (-1) ** i) / cells

    def node(i, j):
        return 1 + i + j * (cells + 1)

    nodes = [place(i, j) for j in range(cells + 1) for i in range(cells + 1)]
    elements = [f"1 2 1 1 {node(0, k + 1)} {node(0, k)}" for k in range(cells)]
    elements += [f"1 2 2 2 {node(cells, k)} {node(cells, k + 1)}" for k in range(cells)]
    elements += [
        f"3 2 3 3 {node(i, j)} {node(i + 1, j)} {node(i + 1, j + 1)} {node(i, j + 1)}"
        for j in range(cells)
        for i in range(cells)
    ]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    lines += ["$PhysicalNames", "3", '1 1 "left"', '1 2 "right"', '2 3 "plate"', "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(nodes))] + [f"{k + 1} {x!r} {y!r} 0" for k, (x, y) in enumerate(nodes)] + ["$EndNodes"]
    lines += ["$Elements", str(len(elements))] + [f"{k + 1} {e}" for k, e in enumerate(elements)] + ["$EndElements"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


class Ranks(program.ProgramTest):
    def assert_ranks_agree(self, options, ranks=(2, 3, 4)):
        alone = self.solve(options | FIELDS)
        for n in ranks:
            with self.subTest(ranks=n):
                self.assert_same_displacement(alone, self.solve(options | FIELDS, n))

    def test_energy_scheme(self):
        self.assert_ranks_agree(PATCH)

    def test_papers_scheme_with_finite_bonds(self):
        papers = {"-couple_scheme": "ghost", "-pd_calibration": "continuum", "-pd_surface_correction": "volume"}
        self.assert_ranks_agree(PATCH | papers | {"-kinematics": "mixed"})

    def test_two_patches_with_spacings_of_their_own(self):
        self.assert_ranks_agree(
            PATCH | {"-pd_patches": "0.1,0.1,0.4,0.4,0.6,0.5,0.9,0.9", "-pd_spacing": "0.025,0.0125"}
        )

    def test_a_patch_like_an_l_and_one_of_two_boxes_that_meet_in_a_corner(self):
        boxes = "0.1,0.1,0.4,0.2,0.1,0.2,0.2,0.5,0.5,0.5,0.7,0.7,0.7,0.7,0.9,0.9"
        self.assert_ranks_agree(PATCH | {"-pd_patches": boxes})

    def test_particles_only_with_a_held_layer(self):
        layer = {"-mesh_cells": None, "-pd_patches": "all", "-pd_spacing": "0.025", "-bc_clamp_layer": ""}
        self.assert_ranks_agree(PLATE | layer)

    def test_mesh_from_gmsh(self):
        mesh = self.scratch / "plate.msh"
        write_gmsh(mesh, cells=20, patch=(6, 14))
        box = {"-mesh_lower": None, "-mesh_upper": None, "-mesh_cells": None}
        self.assert_ranks_agree(PATCH | box | {"-mesh_file": str(mesh)})

    def test_elements_only(self):
        self.assert_ranks_agree(PLATE, ranks=(3,))

    def test_interface_scheme(self):
        self.assert_ranks_agree(PATCH | {"-couple_scheme": "interface"}, ranks=(3,))

    def test_patch_at_a_free_edge(self):
        self.assert_ranks_agree(PATCH | {"-pd_patches": "0.3,0.6,0.7,1"}, ranks=(3,))

    def test_finite_kinematics_in_two_steps(self):
        self.assert_ranks_agree(PATCH | {"-kinematics": "finite", "-load_steps": "2"}, ranks=(2,))

    def test_point_force_between_equally_near_particles(self):
        exact = {"-mesh_cells": "8,8", "-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.0625"}
        push = {"-bc_names": PATCH["-bc_names"] + ",push", "-bc_push_force": "0,-1e6", "-bc_push_at": "0.5,0.5"}
        self.assert_ranks_agree(PATCH | exact | push)

    def test_body_that_only_particles_inside_a_patch_hold(self):
        held = {"-bc_clamp_on": None, "-bc_clamp_box": "0.42,0.42,0.52,0.52", "-mesh_cells": "10,10",
                "-pd_patches": "0.3,0.3,0.7,0.7", "-pd_spacing": "0.05"}
        self.assert_ranks_agree(PATCH | held, ranks=(3,))
        two_level, assembled = (self.solve(PATCH | held | FIELDS | {"-pd_operator": operator})
                                for operator in ("matrix_free", "assembled"))
        self.assert_same_displacement(assembled, two_level)

    def test_every_partitioner(self):
        runs = [self.solve(PATCH | FIELDS)]
        for partitioner in ("ptscotch", "simple"):
            with self.subTest(partitioner=partitioner):
                runs.append(self.solve(PATCH | FIELDS | {"-petscpartitioner_type": partitioner}, 3))
                self.assert_same_displacement(runs[0], runs[-1])

    def test_comparison_notices_another_scheme(self):
        runs = [self.solve(PATCH | FIELDS | {"-couple_scheme": scheme}) for scheme in ("energy", "ghost")]
        with self.assertRaises(AssertionError):
            self.assert_same_displacement(*runs, tolerance=1e-5)


def numbers_of(value, path=()):
    """All numbers of nested results, by the names on the way to them."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if items is None:
        return {path: value}
    return {key: number for name, item in items for key, number in numbers_of(item, (*path, name)).items()}


class Cracked(program.ProgramTest):
    """The smoke runs of the cases with cracks, the beam up to its first broken bonds."""

    NOTCH = {"-options_file": "cases/double_notch/smoke.opts", "-quiet": ""}
    BEAM = {
        "-options_file": "cases/dcb/smoke.opts",
        "-bc_top_displacement": "0,0.64e-6",
        "-bc_bottom_displacement": "0,-0.64e-6",
        "-load_steps": "2",
        "-quiet": "",
    }

    def assert_numbers_agree(self, options, exact, close, noise):
        """The results that `exact` names are equal, those that `close` names to 1e-7 of the largest of that name, and
        displacements are close. `noise` is what is left of larger numbers or depends on the ranks; nothing else is
        there."""
        alone = self.solve(options)
        first = numbers_of(alone.summary["results"])
        self.assertEqual({key[0] for key in first}, set(exact + close + noise))
        for ranks in (2, 3):
            with self.subTest(ranks=ranks):
                run = self.solve(options, ranks)
                self.assert_same_displacement(alone, run, 1e-8)
                self.assertEqual(run.summary["bonds_broken"], alone.summary["bonds_broken"])
                second = numbers_of(run.summary["results"])
                self.assertEqual(first.keys(), second.keys())
                for key, value in first.items():
                    if key[0] in exact:
                        self.assertEqual(second[key], value, key)
                    elif key[0] in close:
                        largest = max(abs(v) for k, v in first.items() if k[0] == key[0])
                        self.assertAlmostEqual(second[key], value, delta=1e-7 * largest, msg=key)
        return alone.summary

    CUTS = ("cut_elements", "enriched_sets", "enriched_sets_dropped", "crack_length", "crack_tips",
            "load_steps_accepted", "passes", "halvings", "particles_held")
    ENERGIES = ("strain_energy", "strain_energy_elements", "strain_energy_bonds", "strain_energy_interface",
                "external_work", "max_displacement_component")

    def test_double_notch(self):
        j = ("energy_release_rate", "j_by_contour", "j_integral", "stress_intensity", "tips")
        self.assert_numbers_agree(self.NOTCH, self.CUTS, self.ENERGIES + j,
                                  ("reaction", "solve_iterations", "seconds_solved_before", "static_condense"))

    def test_beam_that_breaks(self):
        broken = ("critical_stretch", "tips", "solve_bonds_broken")
        forces = ("reaction", "peak_reaction", "peak_reaction_per_thickness", "fracture_energy")
        noise = ("energy_balance_error", "peak_reaction_load", "solve_iterations", "solve_seconds", "static_condense")
        summary = self.assert_numbers_agree(self.BEAM, self.CUTS + broken, self.ENERGIES + forces, noise)
        self.assertGreater(summary["bonds_broken"], 10)
        self.assertGreater(summary["results"]["crack_length"], 0.3e-3)


class Repeats(program.ProgramTest):
    def datasets(self, run):
        found = {}

        def keep(name, item):
            if isinstance(item, h5py.Dataset):
                found[name] = item[()].tobytes()

        with h5py.File(run.directory / "fields.h5", "r") as file:
            file.visititems(keep)
        return found

    def test_fields_are_the_same_to_the_last_bit(self):
        scenes = (PATCH, PATCH | {"-couple_scheme": "ghost", "-kinematics": "finite"}, Cracked.NOTCH, Cracked.BEAM)
        for options in scenes:
            with self.subTest(scheme=options.get("-couple_scheme"), case=options.get("-options_file")):
                first, second = (self.datasets(self.solve(options | FIELDS, 2)) for _ in range(2))
                self.assertEqual(first.keys(), second.keys())
                self.assertGreater(len(first), 5)
                self.assertEqual([name for name in first if first[name] != second[name]], [])


if __name__ == "__main__":
    program.main()
