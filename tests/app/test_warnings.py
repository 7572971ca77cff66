"""What is odd but allowed gets a line, what is meaningless is refused.

Usage: test_warnings.py PDXSOLVE [unittest arguments].
"""

import fcntl
import os
import pty
import struct
import subprocess
import termios

import program

CLOUD = {
    "-pd_horizon": "0.3",
    "-material_young": "1e9",
    "-material_density": "1000",
    "-analysis": "explicit",
    "-ts_max_steps": "2",
    "-ts_max_time": "1",
    "-bc_names": "weight",
    "-bc_weight_body": "0,-1",
    "-quiet": "",
}
BAR = {
    "-mesh_lower": "0,0",
    "-pd_patches": "all",
    "-pd_spacing": "0.01",
    "-material_young": "1e9",
    "-bc_names": "l,r",
    "-bc_l_on": "left",
    "-bc_l_displacement": "0,0",
    "-bc_l_rows": "4",
    "-bc_r_on": "right",
    "-bc_r_traction": "1,0",
    "-quiet": "",
}
GRID = [(0.05 + 0.1 * i, 0.05 + 0.1 * j) for j in range(6) for i in range(10)]


def watched(command):
    """What a command says on a terminal of 160 columns."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 160, 0, 0))
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=theirs, stderr=subprocess.DEVNULL, cwd=program.ROOT) as process:
        os.close(theirs)
        said = b""
        try:
            while part := os.read(ours, 4096):
                said += part
        except OSError:  # the other end is closed
            pass
        process.wait(program.TIMEOUT)
    os.close(ours)
    return said.decode(errors="replace")


class Warnings(program.ProgramTest):
    def cloud(self, points, ranks=1, **options):
        file = self.scratch / f"cloud_{self.runs}.csv"
        rows = [f"{x!r},{y!r},0.01" for x, y in points]
        file.write_text("x,y,volume\n" + "\n".join(rows) + "\n", encoding="utf-8")
        return self.launch(CLOUD | options | {"-pd_cloud": str(file)}, ranks)

    def assert_warned(self, run, pattern):
        self.assertEqual(run.status, 0, run.err)
        self.assertRegex(run.err, r"^warning: " + pattern + r"[^\n]*\n$")
        self.assertLess(len(run.err), 400)

    def test_cloud_without_oddities(self):
        self.assertEqual(self.cloud(GRID).err, "")

    def test_particles_without_neighbours(self):
        for ranks in (1, 2):
            run = self.cloud([*GRID, (5.0, 5.0)], ranks)
            self.assert_warned(run, r"-pd_cloud: 1 particle.*no neighbour.*number 61 at \(5, 5\): take")

    def test_nearly_double_particles(self):
        self.assert_warned(self.cloud([*GRID, (0.053, 0.05)]), r"-pd_cloud: 2 particles.*nearer.*number 1 at.*doubles")

    def test_double_particles_are_refused(self):
        for apart in (0.0, 1e-14, 1e-7):
            for ranks in (1, 2):
                run = self.cloud([*GRID, (0.05 + apart, 0.05)], ranks)
                self.assertEqual(run.status, 1)
                self.assertRegex(run.err, r"numbers 1 and 61 are in one place.*take one of them out\n$")

    def test_bonds_across_a_gap(self):
        halves = [(x + (0.25 if x > 0.5 else 0.0), y) for x, y in GRID]
        run = self.cloud(halves, **{"-pd_horizon": "0.4"})
        self.assert_warned(run, r"-pd_cloud: \d+ particles have bonds across a gap.*the first is number \d+ at.*crack")
        cut = {"-pd_horizon": "0.4", "-crack_names": "c", "-crack_c_points": "0.6,-1,0.6,2"}
        self.assertEqual(self.cloud(halves, **cut).err, "")

    def test_one_row_is_refused(self):
        for operator in ("matrix_free", "assembled"):
            run = self.launch(BAR | {"-mesh_upper": "1,0.01", "-pd_operator": operator}, ranks=2)
            self.assertEqual(run.status, 1)
            self.assertRegex(run.err, r"-pd_spacing is 0\.01: the body is one row.*along y.*8 rows or more\n$")

    def test_few_rows_are_told(self):
        told = r"the body is 4 rows of particles thick along y, less than two horizons.*"
        for correction, stiffness in (("none", r"0\.[4-8]\d* times as stiff.* in tension"), ("volume", "volume.*four 1.4 times"),
                                      ("exact", r"(0\.9|1|1\.0)\d* times as stiff.* in tension")):
            run = self.launch(BAR | {"-mesh_upper": "0.4,0.04", "-pd_surface_correction": correction})
            self.assert_warned(run, told + stiffness)

    def test_too_few_bonds_for_exact_sides(self):
        few = BAR | {"-mesh_upper": "0.4,0.08", "-pd_horizon_ratio": "2"}
        self.assert_warned(self.launch(few), r"-pd_surface_correction: bonds of -pd_horizon_ratio 2 are too few.*volume")
        self.assertEqual(self.launch(few | {"-pd_surface_correction": "volume"}).err, "")

    def test_an_inner_corner_near_a_free_side(self):
        plate = BAR | {"-mesh_upper": "0.4,0.2", "-mesh_cells": "20,10"}
        near = self.launch(plate | {"-pd_patches": "0.1,0,0.3,0.04,0.1,0.04,0.2,0.12"})
        self.assert_warned(near, r"-pd_patches: patch 1 has an inner corner at \(?0\.2, ?0\.04\)?, 4 rows.*6 rows")
        self.assertEqual(self.launch(plate | {"-pd_patches": "0.1,0,0.3,0.08,0.1,0.08,0.2,0.12"}).err, "")

    def test_a_poisson_ratio_that_is_nearly_that_of_bonds(self):
        thick = BAR | {"-mesh_upper": "0.4,0.08"}
        self.assert_warned(self.launch(thick | {"-material_poisson": "0.333"}), r"-material_poisson is 0\.333.*1/3")
        for poisson in ("0.33", "0.3"):
            run = self.launch(thick | {"-material_poisson": poisson}, ranks=2)
            self.assertEqual(run.status, 1)
            self.assertRegex(run.err, r"^error: -material_poisson is " + poisson + r"\b[^\n]*0\.333333 in plane stress[^\n]*\n$")

    def test_what_is_easily_overlooked_in_statics(self):
        for change, words in (
            ({"-bc_load_traction": "1e13,0"}, r"the largest displacement is [\d.e+]+ m and the body 1 m: small strains"),
            ({"-bc_load_traction": "0,0"}, "nothing loads or moves the body"),
            ({"-ts_max_time": "1"}, "-ts_max_time acts in time and changes nothing in statics"),
            ({"-bc_clamp_displacement": None, "-bc_clamp_turn": "10deg", "-bc_clamp_centre": "0,0", "-bc_load_traction": "0,0"},
             r"-bc_clamp_turn is 0\.175 rad, which strains what it turns by 0\.015 with -kinematics small"),
            ({"-post_section": "x"}, "-post_section tells when sections break in time, and changes nothing in statics"),
        ):
            with self.subTest(change):
                self.assert_warned(self.launch(program.SMALL | change), words)
                run = self.launch(program.SMALL | change | {"-warnings_are_errors": ""}, 2)
                self.assertEqual(run.status, 1, run.err)
                self.assertRegex(run.err, rf"^error: {words}[^\n]* \(-warnings_are_errors\)\n$")
        finite = self.launch(program.SMALL | {"-bc_load_traction": "1e3,0", "-warnings_are_errors": ""})
        self.assertEqual((finite.status, finite.err), (0, ""))

    def test_fields_that_are_wanted_after_the_end(self):
        late = BAR | {"-mesh_upper": "0.4,0.08", "-analysis": "explicit", "-material_density": "1000", "-ts_max_steps": "2",
                      "-ts_max_time": "1", "-output_fields": "", "-output_times": "3,2"}  # fmt: skip
        self.assert_warned(self.launch(late), r"-output_times asks for fields at 2 s and later, after the end of the run at 1 s")

    def test_rest_that_is_not_skipped_in_statics(self):
        body = {"-mpm_bodies": "a", "-mpm_a_box": "0,0,1,1", "-mpm_spacing": "0.125", "-material_density": "1", "-mesh_lower": None,
                "-mesh_upper": None, "-mesh_cells": None, "-mpm_skip_rest": "false"}  # fmt: skip
        self.assert_warned(self.launch(program.SMALL | body), "-mpm_skip_rest is of explicit steps, and changes nothing here")

    def test_a_traction_on_a_round_side(self):
        disc = {"-case": "disc", "-analysis": "explicit", "-material_young": "1e6", "-material_density": "1", "-mpm_bodies": "a",
                "-mpm_a_disc": "0,0,0.01", "-mpm_spacing": "1e-3", "-ts_max_steps": "2", "-bc_names": "p", "-bc_p_on": "left",
                "-bc_p_traction": "1,0", "-quiet": ""}  # fmt: skip
        self.assert_warned(self.launch(disc), r"-bc_p_traction acts on the outermost points of a alone.*not straight on its side left")
        square = disc | {"-mpm_a_disc": None, "-mpm_a_polygon": "0,0,0.01,0,0.01,0.01,0,0.01"}
        self.assertEqual(self.launch(square).err, "")
        slanted = disc | {"-mpm_a_disc": None, "-mpm_a_polygon": "0,0,0.02,0,0.02,0.01,0.01,0.01"}
        self.assert_warned(self.launch(slanted), r"-bc_p_traction acts on the outermost points of a alone")

    def test_a_scene_that_is_refused_says_its_error_alone(self):
        # Nothing moves these bodies, which is warned about where they may stand.
        bodies = {"-case": "two", "-analysis": "explicit", "-material_young": "1e6", "-material_density": "1", "-mpm_spacing": "0.1",
                  "-mpm_bodies": "a,b", "-mpm_a_box": "0,0,1,1", "-mpm_b_box": "1.5,0,2.5,1", "-ts_max_steps": "2", "-quiet": ""}  # fmt: skip
        self.assert_warned(self.launch(bodies), "nothing loads or moves the body")
        for ranks in (1, 2):
            run = self.launch(bodies | {"-mpm_b_box": "0.5,0,1.5,1"}, ranks)
            self.assertEqual(run.status, 1)
            self.assertRegex(run.err, r"^error: [^\n]*overlap[^\n]*\n$")

    def test_a_crack_on_a_row_of_particles(self):
        # Rows at 0.25 + 0.125 (k + 1/2): 0.4375 is one, 0.5 lies between two.
        crack = {"-crack_names": "a", "-crack_a_points": "0.3,0.4375,0.7,0.4375"}
        for ranks in (1, 2):
            self.assert_warned(self.launch(program.SMALL_PATCH | crack, ranks),
                               r"crack 1 runs along a row of particles from \(0\.3, 0\.4375\) to .* by half a spacing \(0\.0625 m\)")
        between = self.launch(program.SMALL_PATCH | crack | {"-crack_a_points": "0.3,0.5,0.7,0.5"})
        self.assertEqual((between.status, between.err), (0, ""))

    def test_a_third_component_that_was_left_out(self):
        block = {"-case": "block", "-analysis": "explicit", "-mesh_lower": "0,0", "-mesh_upper": "0.8,0.8", "-material_thickness": "0.8",
                 "-material_plane": "solid", "-material_young": "1e9", "-material_density": "1000", "-pd_patches": "all",
                 "-pd_spacing": "0.1", "-pd_horizon_ratio": "2", "-pd_surface_correction": "volume", "-ts_max_steps": "2",
                 "-bc_names": "hit", "-bc_hit_on": "left",
                 "-bc_hit_velocity": "1,free", "-quiet": ""}  # fmt: skip
        self.assert_warned(self.launch(block), r"-bc_hit_velocity has two components in space: along z it is free")
        self.assertEqual(self.launch(block | {"-bc_hit_velocity": "1,free,free"}).err, "")

    def test_loads_that_are_halved_are_told(self):
        # On a terminal the line is drawn anew ten times a second; attempts that were given up count in it.
        halved = program.PULLED | {"-case": "halved", "-mesh_lower": "0,0", "-mesh_upper": "1,1", "-mesh_cells": "10,10",
                                   "-pd_patches": "0,0.3,1,0.7", "-pd_spacing": "0.025", "-material_toughness": "20",
                                   "-crack_names": "notch", "-crack_notch_points": "0,0.5,0.3,0.5", "-load_passes": "30",
                                   "-bc_t_displacement": "0,6e-4", "-quiet": None}  # fmt: skip
        out = watched([program.PROGRAM, *program.words_of(halved), "-output_dir", str(self.scratch / "o")])
        self.assertRegex(out, r"load [\d.]+ being worked at, \d+ bonds broken, \d+ linear iterations so far, [1-9]\d* attempts given up")

    def test_no_contact_is_told(self):
        run = program.Run(*program.finish([program.PROGRAM, "-help"], program.ROOT), self.scratch)
        self.assertIn("contact between bodies of a scene with -mpm_bodies only", run.out)


if __name__ == "__main__":
    program.main()
