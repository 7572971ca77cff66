"""Meshes from files, through the program: boundaries by physical groups, damage, and bodies in several parts.

Usage: test_meshes.py PDXSOLVE [unittest arguments].
"""

import gmsh_files
import program

PULLED = program.PULLED | {"-case": "mesh"}
FORMS = [(version, binary) for version in ("2.2", "4.1") for binary in (False, True)]
PATCH = {"-pd_patches": "0.1,0.3,0.4,0.7", "-pd_spacing": "0.0125"}
# Four neighbours and the diagonals: all bonds of a row break, none is left that a sideways motion spares.
TO_BREAK = {
    "-pd_critical_stretch": "2e-3",
    "-pd_horizon_ratio": "1.5",
    "-pd_surface_correction": "volume",
    "-load_steps": "8",
    "-load_broken_share": "1",
}


class Meshes(program.ProgramTest):
    def mesh(self, n, *arguments, **keywords):
        return gmsh_files.Square(n, *arguments).write(self.scratch / f"{len(list(self.scratch.iterdir()))}.msh", **keywords)

    def energy(self, options, ranks=1):
        return self.solve(options, ranks).summary["results"]["strain_energy"]

    def refused(self, options, *words):
        """Status 1 and the same line on 1 and 2 ranks, with these words; returns the last run."""
        lines = set()
        for ranks in (1, 2):
            run = self.launch(options, ranks)
            lines.add(run.err)
            self.assertEqual(run.status, 1, run.err)
        self.assertEqual(len(lines), 1, lines)
        line = lines.pop()
        self.assertTrue(line.count("\n") == 1 and len(line) < 400, line)
        for word in words:
            self.assertIn(word, line)
        return run


class Boundaries(Meshes):
    def test_are_physical_groups_in_every_form(self):
        box = {"-mesh_lower": "0,0", "-mesh_upper": "1,1", "-mesh_cells": "4,4"}
        options = PULLED | {"-bc_b_on": "left", "-bc_t_on": "right"}  # numbers of the curves are exchanged
        right = self.energy(options | box)
        for version, binary in FORMS:
            mesh = self.mesh(4, version=version, binary=binary)
            self.assertAlmostEqual(self.energy(options | {"-mesh_file": mesh}) / right, 1.0, 9, (version, binary))


class Damage(Meshes):
    def refused_file(self, data, *words):
        path = self.scratch / "damaged.msh"
        path.write_bytes(data)
        self.refused(PULLED | {"-mesh_file": str(path)}, "damaged.msh", *words)

    def test_is_one_line(self):
        square = gmsh_files.Square(4)
        text, binary = square.bytes("4.1"), square.bytes("4.1", True)
        self.refused_file(text + b"x" * 5000, "outside of all sections")
        self.refused_file(text.replace(b"$EndNodes", b"$Nodes"), "$EndNodes")
        self.refused_file(binary[:-200], "ends too early")
        self.refused_file(binary.replace(b"4.1 1 8", b"4.1 1 4"), "4 bytes")


class Parts(Meshes):
    def test_a_seam_parts_particles(self):
        """A crack made in the mesher: with a patch over it nearly the energy of elements alone. Patches over the middle
        of it, its mouth, and its tip, which elements see too stiffly."""
        options = PULLED | {"-mesh_file": self.mesh(20, lambda x: x < 0.499)}
        alone = self.energy(options)
        whole = self.energy(PULLED | {"-mesh_file": self.mesh(20)})
        self.assertLess(alone, 0.9 * whole)
        for box, near in (("0.1,0.3,0.4,0.7", 0.01), ("0,0.3,0.4,0.7", 0.01), ("0.3,0.3,0.7,0.7", 0.04)):
            patch = PATCH | {"-pd_patches": box}
            both = [self.energy(options | patch, ranks) for ranks in (1, 2)]
            self.assertAlmostEqual(both[0] / alone, 1.0, delta=near, msg=box)
            self.assertAlmostEqual(both[0] / both[1], 1.0, 8)

    def test_a_seam_parts_carried_bonds_of_every_scheme(self):
        options = PULLED | {"-mesh_file": self.mesh(20, lambda x: x < 0.499)}
        alone = self.energy(options)
        for scheme in ("ghost", "interface"):
            patch = PATCH | {"-couple_scheme": scheme, "-pd_patches": "0.1,0.5,0.4,0.7"}  # the seam is its border
            self.assertAlmostEqual(self.energy(options | patch) / alone, 1.0, delta=0.03, msg=scheme)

    def test_that_only_look_joined_are_refused(self):
        for upper in (None, 6):
            mesh = {"-mesh_file": self.mesh(8, lambda x: True, upper)}
            free = {"-bc_t_displacement": "free,1e-3"}
            for change in (free, free | {"-bc_t_displacement": "1e-3,free"}):
                self.refused(PULLED | mesh | change, "from (0, 0.5) to (1, 1) m", "slide along")
            self.energy(PULLED | mesh)  # either part is held
        mesh = {"-mesh_file": self.mesh(8, lambda x: True, None)}
        patch = {"-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.0625"}
        self.refused(PULLED | mesh | free | patch, "slide along x")

    def test_that_a_crack_cuts_off_are_refused(self):
        box = {"-mesh_lower": "0,0", "-mesh_upper": "1,1", "-mesh_cells": "10,10", "-bc_t_displacement": "free,1e-3"}
        crack = {"-crack_names": "c", "-crack_c_points": "0,0.55,1,0.55"}
        self.refused(PULLED | box | crack, "slide along x")
        self.refused(PULLED | box | crack | {"-pd_patches": "0,0.4,1,0.7", "-pd_spacing": "0.05"}, "slide along x")
        particles = {"-mesh_cells": None, "-pd_patches": "all", "-pd_spacing": "0.05"}
        self.refused(PULLED | box | particles | {"-crack_names": "c", "-crack_c_points": "0,0.5,1,0.5"}, "slide along x")
        block = {"-crack_c_points": "0,0.55,0.45,0.55,0.45,1", "-bc_t_box": "0.5,0,1,1"}
        self.refused(PULLED | box | crack | block | {"-pd_patches": "0.3,0.4,0.6,0.7", "-pd_spacing": "0.05"}, "rotate")

    def test_that_breaking_cuts_off_end_the_run_with_what_was_accepted(self):
        box = {"-mesh_lower": "0,0", "-mesh_upper": "1,1", "-mesh_cells": "10,10", "-bc_t_displacement": "free,8e-3"}
        band = TO_BREAK | {"-pd_patches": "0,0.4,1,0.6", "-pd_spacing": "0.1", "-output_history": ""}
        run = self.refused(PULLED | box | band, "bonds have broken until", "slide along x")
        self.assertEqual(run.summary["status"], "failed")
        self.assertGreaterEqual(run.summary["steps"], 1)
        self.assertIn("history.csv", run.files)


if __name__ == "__main__":
    program.main()
