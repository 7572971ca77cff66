"""Bodies of several materials: closed forms of bars and waves, interfaces that break, materials by name."""

import math

import h5py
import numpy

import gmsh_files
import program

E, TRACTION = 1e9, 1e6
BAR = program.EVEN | {"-case": "bar", "-mesh_lower": "3,1", "-mesh_upper": "5,1.25", "-mesh_cells": "16,2", "-material_poisson": "0"}
RIGHT = {"-region_names": "stiff", "-region_stiff_box": "4,0,9,9", "-region_stiff_young": "3e9"}
# A plate stretched along x by 1e-3 with a layer of another material, in which a patch lies: its strain is uniform.
LAYERED = {key: value for key, value in program.EVEN.items() if "right_traction" not in key} | {
    "-case": "layered",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "8,8",
    "-bc_right_displacement": "1e-3,free",
    "-pd_patches": "0.25,0.25,0.75,0.5",
    "-pd_spacing": "0.03125",
    "-region_names": "layer",
    "-region_layer_polygon": "-1,0.25,2,0.25,2,0.5,-1,0.5",
    "-region_layer_young": "5e9",
    "-probe_names": "high,inside",
    "-probe_high_at": "0.4,1",
    "-probe_high_field": "displacement",
    "-probe_inside_at": "0.6,0.4",
    "-probe_inside_field": "displacement",
}
# A bar in uniaxial strain along x that is struck on the left; the density and modulus change at x = 1.
STRUCK = {
    "-case": "struck",
    "-analysis": "explicit",
    "-mesh_lower": "0,0",
    "-mesh_upper": "2,0.02",
    "-material_young": "1e9",
    "-material_density": "1000",
    "-region_names": "heavy",
    "-region_heavy_box": "1,-1,3,1",
    "-region_heavy_young": "2e9",
    "-region_heavy_density": "4500",
    "-bc_names": "left,flat",
    "-bc_flat_box": "-1,-1,3,1",
    "-bc_flat_displacement": "free,0",
    "-bc_left_on": "left",
    "-bc_left_velocity": "1,free",
    "-bc_left_history": "gaussian",
    "-bc_left_history_time": "0.15e-3",
    "-bc_left_history_width": "0.05e-3",
    "-ts_max_time": "1.75e-3",
    "-quiet": "",
    "-probe_names": "at",
    "-probe_at_at": "0.5,0.01",
    "-probe_at_field": "velocity",
    "-probe_at_every": "1",
}
# A cracked plate with an inclusion, a strip where nothing breaks, and a weak border of the inclusion.
CRACKED = {key: value for key, value in program.PATCH.items() if not key.startswith("-bc_")} | {
    "-case": "cracked",
    "-material_density": "1000",
    "-material_toughness": "2",
    "-crack_names": "c",
    "-crack_c_points": "0,0.5,0.5,0.5",
    "-region_names": "a,b",
    "-region_a_polygon": "0.1,0.1,0.9,0.2,0.5,0.9",
    "-region_a_young": "4e9",
    "-region_a_toughness": "3",
    "-region_a_density": "2500",
    "-region_b_box": "0.6,0.3,0.65,0.8",
    "-region_b_young": "0.5e9",
    "-region_b_no_fail": "",
    "-interface_names": "i",
    "-interface_i_between": "a,rest",
    "-interface_i_toughness": "0.5",
    "-bc_names": "b,t",
    "-bc_b_on": "bottom",
    "-bc_b_displacement": "0,0",
    "-bc_t_on": "top",
    "-output_fields": "",
}
LOADED = {"-bc_t_displacement": "0,2e-4"}
MOVED = {"-analysis": "explicit", "-kinematics": "finite", "-bc_t_velocity": "0,1", "-ts_max_time": "4e-3", "-adapt": "expand"}
# A beam of two unlike arms, one stiff, pulled apart at its left end; the crack is between them.
BEAM = {
    "-case": "beam",
    "-analysis": "explicit",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,0.3",
    "-pd_patches": "all",
    "-pd_spacing": "0.0125",
    "-pd_horizon_ratio": "3",
    "-material_young": "1e9",
    "-material_density": "1000",
    "-material_toughness": "50",
    "-crack_names": "c",
    "-crack_c_points": "-0.01,0.2,0.25,0.2",
    "-bc_names": "low,high,right",
    "-bc_low_box": "-1,-1,0.03,0.1",
    "-bc_low_velocity": "free,-0.5",
    "-bc_high_box": "-1,0.25,0.03,1",
    "-bc_high_velocity": "free,0.5",
    "-bc_right_on": "right",
    "-bc_right_displacement": "0,0",
    "-ts_max_time": "9e-3",
    "-output_fields": "",
    "-output_interval": "100000",
    "-quiet": "",
}
PEELED = {"-region_names": "upper", "-region_upper_box": "-1,0.2,2,1", "-interface_names": "glue", "-interface_glue_between": "upper,rest",
          "-interface_glue_toughness": "5"}  # fmt: skip


def last(run, field):
    """The last values of a field, and the places they are at."""
    with h5py.File(run.directory / "fields.h5") as file:
        step = file[sorted(name for name in file if name.startswith("step"))[-1]]
        block = step["particles"]
        places = file["geometry/particles/points"] if "geometry" in file else block["points"]
        return numpy.array(places), numpy.array(block[field]).ravel()


class Regions(program.ProgramTest):
    def warned(self, options, ranks=1):
        """A run that may warn."""
        run = self.launch(options, ranks)
        self.assertEqual(run.status, 0, run.err)
        return run

    def end(self, run, name):
        return program.rows_of(run.directory / f"probe_{name}.csv")[-1]

    def test_bar_in_a_row(self):
        options = BAR | RIGHT | {"-probe_names": "end", "-probe_end_at": "5,1.1", "-probe_end_field": "displacement"}
        for ranks in (1, 3):
            self.assertAlmostEqual(self.end(self.solve(options, ranks), "end")["displacement_x"], TRACTION / E + TRACTION / (3 * E), delta=1e-14)
        thick = self.solve(options | {"-region_stiff_thickness": "2"})
        self.assertAlmostEqual(self.end(thick, "end")["displacement_x"], 2 * TRACTION / E + TRACTION / (3 * E), delta=1e-14)
        # With particles over the border: two springs in a row, within what a row of cells between is worth.
        patch = {"-material_poisson": None, "-mesh_cells": "32,4", "-pd_patches": "3.5,1.0625,4.5,1.1875", "-pd_spacing": "0.015625"}
        self.assertAlmostEqual(self.end(self.solve(options | patch), "end")["displacement_x"], 4 / 3e3, delta=0.01 * 4 / 3e3)

    def test_layers_side_by_side(self):
        for ranks in (1, 2, 3):
            run = self.solve(LAYERED, ranks)
            for name, x, y in (("high", 0.4, 1), ("inside", 0.6, 0.4)):
                row = self.end(run, name)
                self.assertAlmostEqual(row["displacement_x"], 1e-3 * x, delta=1e-12)
                self.assertAlmostEqual(row["displacement_y"], -1e-3 / 3 * y, delta=1e-12)
            self.assertAlmostEqual(run.summary["results"]["reaction"]["right"][0], (0.75 + 5 * 0.25) * 1e6, delta=1e-4)

    def test_layers_of_two_thicknesses(self):
        weight = {"-bc_names": "left,bottom,right,weight", "-bc_weight_body": "0,0", "-bc_weight_box": "0,0,1,1"}
        run = self.solve(LAYERED | weight | {"-region_layer_thickness": "0.3", "-material_thickness": "0.1"}, 2)
        for name, x, y in (("high", 0.4, 1), ("inside", 0.6, 0.4)):
            row = self.end(run, name)
            self.assertAlmostEqual(row["displacement_x"], 1e-3 * x, delta=1e-12)
            self.assertAlmostEqual(row["displacement_y"], -1e-3 / 3 * y, delta=1e-12)
        results = run.summary["results"]
        force = (0.1 * 0.75 + 0.3 * 5 * 0.25) * 1e6
        self.assertAlmostEqual(results["reaction"]["right"][0], force, delta=1e-4)
        self.assertAlmostEqual(results["strain_energy"], 0.5e-3 * force, delta=1e-6)
        # Their own weight: what the floor bears.
        run = self.solve(LAYERED | weight | {"-bc_weight_body": "0,-1e3", "-region_layer_thickness": "0.3", "-material_thickness": "0.1",
                                             "-bc_right_displacement": "0,free"})  # fmt: skip
        self.assertAlmostEqual(run.summary["results"]["reaction"]["bottom"][1], (0.1 * 0.75 + 0.3 * 0.25) * 1e3, delta=1e-6)

    def test_j_beside_another_material_is_what_the_body_gives(self):
        """J around a tip in one material, thicker than the rest, against the energy that the body loses as the crack grows."""
        for more in ({}, {"-mesh_cells": "32,32", "-pd_patches": "0.25,0.3125,0.75,0.6875", "-pd_spacing": "0.015625", "-post_j_domain": None,
                          "-post_j_contours": "0.15,0.2"}):  # fmt: skip
            run = self.warned({
                "-mesh_lower": "0,0", "-mesh_upper": "1,1", "-material_young": "1e9", "-quiet": "", "-mesh_cells": "41,41", "-material_thickness": "0.5", "-bc_names": "low,high", "-bc_low_on": "bottom",
                "-bc_low_displacement": "0,0", "-bc_high_on": "top", "-bc_high_traction": "0,1e6", "-crack_names": "c",
                "-crack_c_points": f"-0.01,0.5,{20 / 41},0.5", "-region_names": "middle,side", "-region_middle_box": "-1,0.25,0.8,0.75",
                "-region_middle_young": "3e9", "-region_middle_thickness": "0.2", "-region_side_box": "0.8,-1,2,2",
                "-region_side_young": "8e9", "-post_j_domain": "0.08,0.2", "-post_energy_release": ""} | more)  # fmt: skip
            tip = run.summary["results"]["tips"][0]
            j = tip["j_domain"] if not more else tip["j_by_contour"][1][1]
            self.assertAlmostEqual(j / tip["energy_release_rate"], 1, delta=0.03)
            self.assertAlmostEqual(run.summary["results"]["stress_intensity"], math.sqrt(3e9 * j), delta=1e-6 * math.sqrt(3e9 * j))

    def test_waves_at_an_interface(self):
        """Of the velocity, (Z1 - Z2) / (Z1 + Z2) comes back; Z2 is three times Z1."""
        bodies = {
            "elements": {"-mesh_cells": "400,2"},
            "particles": {"-pd_patches": "all", "-pd_spacing": "0.005", "-pd_horizon_ratio": "3"},
            "both": {"-mesh_cells": "400,4", "-pd_patches": "0.995,0,1.02,0.02", "-pd_spacing": "0.0025", "-pd_horizon_ratio": "3"},
        }
        thick = {"-region_heavy_young": None, "-region_heavy_density": None, "-region_heavy_thickness": "3"}
        bodies |= {f"thick {name}": body | thick for name, body in bodies.items()}
        for name, body in bodies.items():
            with self.subTest(name):
                rows = program.rows_of(self.warned(STRUCK | body).directory / "probe_at.csv")
                come = max(row["velocity_x"] for row in rows if row["time"] < 0.9e-3)
                back = min(row["velocity_x"] for row in rows if row["time"] > 1.2e-3)
                self.assertAlmostEqual(back / come, -0.5, delta=0.01)

    def test_ranks(self):
        for more in (LOADED, MOVED):
            runs = [self.warned(CRACKED | more, ranks).summary["results"] for ranks in (1, 2, 3)]
            self.assertGreater(runs[0]["fracture_energy"], 0.1)
            for other in runs[1:]:
                for key in ("fracture_energy", "strain_energy", "external_work"):
                    self.assertAlmostEqual(other[key] / runs[0][key], 1.0, delta=1e-8, msg=key)

    def test_where_nothing_breaks(self):
        """Bonds with an end in the strip hold, and next to it some break."""
        run = self.warned(CRACKED | MOVED | {"-adapt": None})
        places, damage = last(run, "damage")
        inside = (places[:, 0] > 0.6) & (places[:, 0] < 0.65)
        self.assertEqual(damage[inside].max(), 0.0)
        self.assertGreater(damage[~inside].max(), 0.3)

    def test_equal_materials_change_no_bit(self):
        same = {"-region_names": "a", "-region_a_polygon": CRACKED["-region_a_polygon"], "-region_a_young": "1e9"}
        plain = {key: value for key, value in CRACKED.items() if not key.startswith(("-region_", "-interface_"))}
        for more in (LOADED, MOVED):
            with self.subTest(more):
                ours, theirs = (self.warned(o) for o in (plain | more | same, plain | more))
                with h5py.File(ours.directory / "fields.h5") as a, h5py.File(theirs.directory / "fields.h5") as b:
                    seen = []
                    b.visititems(lambda name, item: seen.append(name) if isinstance(item, h5py.Dataset) else None)
                    self.assertGreater(len(seen), 20)
                    for name in seen:
                        self.assertTrue(numpy.array_equal(a[name][()], b[name][()]), name)
                self.assertIn("-region_a is of the same material as the rest and changes nothing", ours.err)

    def test_cracks_follow_a_weak_interface(self):
        def strayed(options):
            places, damage = last(self.warned(options), "damage")
            broken = places[(damage > 0.2) & (places[:, 0] > 0.1) & (places[:, 0] < 0.9)]
            self.assertGreater(broken[:, 0].max(), 0.35)
            return numpy.abs(broken[:, 1] - 0.2).max()

        reach = 3 * 0.0125
        self.assertLess(strayed(BEAM | PEELED), reach)
        self.assertGreater(strayed(BEAM), 2 * reach)

    def test_surface_of_a_mesh(self):
        """The physical surface is all of the plate: as stiff as it alone."""
        square = gmsh_files.Square(8).write(self.scratch / "square.msh")
        body = {"-mesh_file": square, "-material_poisson": "0", "-probe_names": "end", "-probe_end_at": "1,0.3", "-probe_end_field": "displacement"}
        run = self.solve(program.EVEN | body | {"-region_names": "all", "-region_all_surface": "plate", "-region_all_young": "4e9"})
        self.assertAlmostEqual(self.end(run, "end")["displacement_x"], TRACTION / 4e9, delta=1e-14)

    def test_regions_in_space(self):
        """A bar of particles in space, struck: as that in the plane."""
        space = {"-material_plane": "solid", "-material_thickness": "0.06", "-mesh_upper": "2,0.06", "-pd_patches": "all", "-pd_spacing": "0.01",
                 "-pd_horizon_ratio": "2.5", "-bc_flat_displacement": "free,0,0", "-bc_left_velocity": "1,free,free", "-probe_at_at": "0.5,0.03,0.03"}  # fmt: skip
        rows = program.rows_of(self.warned(STRUCK | space | {"-ts_max_time": "1.65e-3"}).directory / "probe_at.csv")
        come = max(row["velocity_x"] for row in rows if row["time"] < 0.9e-3)
        back = min(row["velocity_x"] for row in rows if row["time"] > 1.2e-3)
        self.assertAlmostEqual(back / come, -0.5, delta=0.03)


class ByName(program.ProgramTest):
    def test_values_and_what_overrides_them(self):
        own = self.scratch / "own.txt"
        own.write_text("# mine\nrubber 1MPa 0.49 1200kg/m^3 -  # soft\npmma 2GPa 0 - -\n", encoding="utf-8")
        body = BAR | {"-material_young": None, "-probe_names": "end", "-probe_end_at": "5,1.1", "-probe_end_field": "displacement"}
        for more, young in (
            ({"-material": "alumina"}, 416e9),
            ({"-material": "alumina", "-material_young": "2e9"}, 2e9),
            ({"-material": "pmma", "-material_file": str(own), "-material_poisson": None}, 2e9),
        ):
            row = program.rows_of(self.solve(body | more).directory / "probe_end.csv")[-1]
            self.assertAlmostEqual(row["displacement_x"] * young / (2 * TRACTION), 1.0, delta=1e-12)

    def test_a_bar_of_two(self):
        body = BAR | {"-material_young": None, "-material": "alumina", "-probe_names": "end", "-probe_end_at": "5,1.1"}
        other = {"-region_names": "r", "-region_r_box": "4,0,9,9", "-region_r_material": "aluminium_6061", "-region_r_poisson": "0"}
        row = program.rows_of(self.solve(body | other).directory / "probe_end.csv")[-1]
        self.assertAlmostEqual(row["displacement_x"], TRACTION / 416e9 + TRACTION / 68.9e9, delta=1e-16)

    def test_bonds_take_their_own_ratio_and_the_toughness(self):
        run = self.launch(program.PATCH | {"-material_young": None, "-material": "soda_lime_glass", "-pd_toughness": "continuum", "-quiet": None})
        horizon = 4 * 0.025
        conical = math.sqrt(5 * math.pi * 135 / (9 * 72e9 * horizon))  # [XPD1 Eq. 7] with plane stress
        self.assertAlmostEqual(run.summary["results"]["critical_stretch"][0] / conical, 1.0, delta=1e-6)
        self.assertIn("Poisson's ratio of -material is 0.22: taken as 1/3", run.out)
        self.assertIn("-material_young 72", (run.directory / "options.opts").read_text(encoding="utf-8"))


if __name__ == "__main__":
    program.main()
