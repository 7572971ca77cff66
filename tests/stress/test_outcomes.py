"""Scenes that ask for trouble, through the program: what it does is said beforehand.

Usage: test_outcomes.py PDXSOLVE [unittest arguments]. The environment lets Open MPI run (ctest sets it; by hand:
`. scripts/mpi_env.sh`).
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "app"))

import program
from program import pdxtools

# A cantilever pair like cases/dcb in small: 0.9 x 0.45 mm in 30 x 15 elements, a patch ahead of and around the tip.
BEAM = {
    "-case": "beam",
    "-mesh_lower": "0,0",
    "-mesh_upper": "0.9e-3,0.45e-3",
    "-mesh_cells": "30,15",
    "-material_young": "75e9",
    "-material_thickness": "1e-3",
    "-material_toughness": "5",
    "-crack_names": "crack",
    "-crack_crack_points": "0,0.225e-3,0.3e-3,0.225e-3",
    "-bc_names": "right,top,bottom",
    "-bc_right_on": "right",
    "-bc_right_displacement": "0,0",
    "-bc_top_on": "top",
    "-bc_top_box": "-1e-6,0.44e-3,0.03e-3,0.46e-3",
    "-bc_top_displacement": "0,1.5e-6",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_box": "-1e-6,-0.01e-3,0.03e-3,0.01e-3",
    "-bc_bottom_displacement": "0,-1.5e-6",
    "-pd_patches": "0.24e-3,0.15e-3,0.84e-3,0.30e-3",
    "-pd_spacing": "7.5e-6",
    "-load_steps": "10",
    "-output_history": "",
    "-output_fields": "",
    "-quiet": "",
}
# A sheet of 1 x 1 m in 10 x 10 elements, pulled apart at top and bottom, with a patch right across it.
SHEET = {
    "-case": "sheet",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "10,10",
    "-material_young": "1e9",
    "-pd_patches": "0,0.3,1,0.7",
    "-pd_spacing": "0.025",
    "-bc_names": "bottom,top",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_displacement": "0,0",
    "-bc_top_on": "top",
    "-bc_top_displacement": "0,1e-3",
    "-load_steps": "4",
    "-output_history": "",
    "-output_fields": "",
    "-quiet": "",
}
NOTCHED = SHEET | {
    "-material_toughness": "20",
    "-crack_names": "notch",
    "-crack_notch_points": "0,0.5,0.3,0.5",
}
# A square patch in a sheet, for cracks that cut pieces out of it.
INLAY = SHEET | {"-pd_patches": "0.2,0.2,0.8,0.8", "-load_steps": None}

LENGTHS = (
    "-mesh_lower",
    "-mesh_upper",
    "-crack_crack_points",
    "-bc_top_box",
    "-bc_bottom_box",
    "-bc_top_displacement",
    "-bc_bottom_displacement",
    "-pd_patches",
    "-pd_spacing",
    "-material_thickness",
)


def times(text, factor):
    """A list of numbers, multiplied."""
    return ",".join(repr(factor * float(word)) for word in text.split(","))


def in_units(options, length, modulus):
    """The same scene where a metre is `length` metres and a pascal `modulus` pascals."""
    scaled = dict(options)
    for name in LENGTHS:
        scaled[name] = times(options[name], length)
    scaled["-material_young"] = times(options["-material_young"], modulus)
    scaled["-material_toughness"] = times(options["-material_toughness"], modulus * length)
    return scaled


def crossed_pairs(lower, upper, over):
    """Four cracks along the sides of the square from lower to upper, each longer by `over` at both ends."""
    a, b, long = lower, upper, (lower - over, upper + over)
    points = (
        (long[0], a, long[1], a),
        (b, long[0], b, long[1]),
        (long[1], b, long[0], b),
        (a, long[1], a, long[0]),
    )
    options = {"-crack_names": "south,east,north,west"}
    for name, line in zip(("south", "east", "north", "west"), points):
        options[f"-crack_{name}_points"] = ",".join(map(repr, line))
    return options


class StressTest(program.ProgramTest):
    CRACKS_REACH_BORDERS = True
    CRACKS_LIE_ON_ROWS = True

    def assert_on_disk(self, run, status):
        """Every accepted step is in history, fields and summary; no number anywhere is lost."""
        self.assertEqual(run.summary["status"], status)
        history = run.history()
        fields_of = ["fields.h5", "fields.xdmf"] if history else ["fields.h5"]  # no step, nothing for ParaView to show
        written = [name for name in run.files if name not in ("crack_path.csv", "citations.bib", "options.opts")]
        self.assertEqual(written, [*fields_of, "history.csv", "summary.json"])
        self.assertEqual(run.summary["results"]["load_steps_accepted"], len(history))
        for row in history:
            self.assertTrue(all(map(math.isfinite, row.values())), row)
        if history:
            load, blocks = pdxtools.read_step(run.directory)
            self.assertAlmostEqual(load, history[-1]["load"], places=12)
            for name, block in blocks.items():
                self.assertTrue(all(map(math.isfinite, block["displacement"].ravel())), name)
        return history

    def assert_unstable(self, run):
        """Exit status 2, one line on stderr that says at which load, and the same line in summary.json."""
        self.assertEqual(run.status, 2, run.err)
        lines = run.err.strip().splitlines()
        self.assertEqual(len(lines), 1, run.err)
        self.assertRegex(lines[0], r"^error: load step \d+ of \d+ failed at load [0-9.e-]+ .*: unstable growth: ")
        self.assertIn(run.summary["message"], lines[0])
        return self.assert_on_disk(run, "failed")


class Toughness(StressTest):
    def test_a_step_a_hundred_times_too_large_is_halved(self):
        """Ten times the load in one step in place of ten."""
        options = BEAM | {
            "-load_steps": "1",
            "-load_broken_share": "0.2",
            "-pd_spacing": "10e-6",
            "-bc_top_displacement": "0,1.5e-5",
            "-bc_bottom_displacement": "0,-1.5e-5",
        }
        runs = [self.solve(options, ranks) for ranks in (1, 2)]
        for run in runs:
            history = self.assert_on_disk(run, "done")
            results = run.summary["results"]
            self.assertGreater(results["halvings"], 0)
            self.assertEqual(history[-1]["load"], 1.0)
            self.assertGreater(run.summary["bonds_broken"], 1000)
            self.assertEqual([row["bonds_broken"] for row in history], sorted(row["bonds_broken"] for row in history))
            self.assertLess(results["fracture_energy"], results["external_work"])
        self.assertEqual(*(run.summary["bonds_broken"] for run in runs))

    def test_without_halvings_too_large_a_step_ends_with_a_message(self):
        run = self.launch(BEAM | {"-load_steps": "1", "-load_halvings": "0"})
        self.assertEqual(self.assert_unstable(run), [])

    def test_a_millionth_of_the_toughness_breaks_everything(self):
        """Under the default smallest step nothing is accepted; with smaller ones what is, is on disk."""
        nothing = BEAM | {"-material_toughness": "5e-6"}
        self.assertEqual(self.assert_unstable(self.launch(nothing)), [])
        small = {"-load_halvings": "12", "-load_broken_share": "0.002"}
        histories = [self.assert_unstable(self.launch(nothing | small, ranks)) for ranks in (1, 2)]
        history = histories[0]
        self.assertGreater(history[-1]["bonds_broken"], 100)
        self.assertEqual(*([row["bonds_broken"] for row in rows] for rows in histories))
        # Gc of 1e-6 takes loads of 1e-3: at nominal toughness the first bond breaks at a load between 0.2 and 0.3.
        self.assertLess(history[0]["load"], 0.3e-3)

    def test_a_million_times_the_toughness_is_none(self):
        tough = self.solve(BEAM | {"-material_toughness": "5e6"})
        free = self.solve(BEAM | {"-material_toughness": None})
        self.assertEqual(tough.summary["bonds_broken"], 0)
        self.assertEqual(tough.summary["results"]["passes"], 10)
        self.assertEqual([row["passes"] for row in tough.history()], [1.0] * 10)
        self.assertEqual(tough.summary["results"]["fracture_energy"], 0.0)
        self.assert_same_displacement(tough, free)


class Units(StressTest):
    def test_answers_do_not_depend_on_units(self):
        """Lengths and moduli by 1e6 and 1e-6: the same bonds break, P / (E L t) and a / L stay."""
        beam = BEAM | {
            "-load_steps": "2",
            "-pd_spacing": "10e-6",
            "-bc_top_displacement": "0,0.75e-6",
            "-bc_bottom_displacement": "0,-0.75e-6",
        }
        scales = [(1.0, 1.0), (1e6, 1.0), (1e-6, 1.0), (1.0, 1e6), (1.0, 1e-6), (1e6, 1e-6), (1e-6, 1e6)]
        runs = program.in_pairs(lambda scale: self.solve(in_units(beam, *scale)), scales)
        plain = runs[0].summary
        self.assertGreater(plain["bonds_broken"], 100)
        for (length, modulus), run in zip(scales[1:], runs[1:]):
            with self.subTest(length=length, modulus=modulus):
                self.assertEqual(run.summary["bonds_broken"], plain["bonds_broken"])
                found, expected = run.summary["results"], plain["results"]
                force = expected["reaction"]["top"][1] * modulus * length**2
                self.assertAlmostEqual(found["reaction"]["top"][1] / force, 1.0, delta=1e-8)
                self.assertAlmostEqual(found["crack_length"] / (expected["crack_length"] * length), 1.0, delta=1e-9)
                self.assertEqual(found["passes"], expected["passes"])


class Pieces(StressTest):
    def test_a_sheet_torn_in_two_rests(self):
        """Elements, a patch across, elements; and particles only: no force left, both halves moved as their grips.

        In 16 steps: in 4 the sheet bursts in one of them, and threads of bonds stay between its shreds.
        """
        for options in (NOTCHED, PARTICLES_TORN):
            with self.subTest(patches=options["-pd_patches"]):
                runs = [self.solve(options | {"-load_steps": "16"}, ranks) for ranks in (1, 2)]
                for run in runs:
                    history = self.assert_on_disk(run, "done")
                    peak = max(row["reaction_top_y"] for row in history)
                    self.assertGreater(peak, 1e4)
                    self.assertLess(abs(history[-1]["reaction_top_y"]), 1e-8 * peak)
                    self.assertLess(abs(history[-1]["reaction_bottom_y"]), 1e-8 * peak)
                    self.assertAlmostEqual(run.summary["results"]["max_displacement_component"], 1e-3, delta=1e-9)
                self.assertEqual(*(run.summary["bonds_broken"] for run in runs))

    def test_a_sheet_torn_by_a_force_ends_with_a_message(self):
        force = NOTCHED | {"-bc_top_displacement": None, "-bc_top_traction": "0,1e6"}
        history = self.assert_unstable(self.launch(force, ranks=2))
        self.assertGreater(len(history), 0)
        self.assertLess(history[-1]["load"], 0.25)

    def test_a_block_cut_out_is_refused(self):
        """A piece that nothing holds could be anywhere: said alike whichever way it is cut out, on any number of ranks."""
        crossing, meeting = (INLAY | crossed_pairs(0.4, 0.6, over) for over in (0.02, 0.0))
        runs = [self.launch(options, ranks) for options, ranks in ((crossing, 1), (crossing, 2), (meeting, 1))]
        for run in runs:
            self.assertEqual(run.status, 1, run.err)
            self.assertEqual(run.err, runs[0].err)
            for words in ("0 nodes and 64 particles", "slide along x and slide along y and rotate"):
                self.assertIn(words, run.err)

    def test_a_particle_cut_out_is_held(self):
        """Sites lie at 0.2 + 0.025 (k + 1/2): one in the square from 0.5 to 0.525, whatever the horizon."""
        cracks = crossed_pairs(0.5, 0.525, 0.01)
        for ratio, ranks in (("4", 1), ("4", 2), ("1.5", 1)):
            run = self.solve(INLAY | cracks | {"-pd_horizon_ratio": ratio, "-pd_surface_correction": "volume"}, ranks)
            self.assert_on_disk(run, "done")
            self.assertEqual(run.summary["results"]["particles_held"], 1)
            self.assertLess(run.summary["results"]["max_displacement_component"], 1.001e-3)

    def test_two_patches_grow_their_own_cracks(self):
        """Mirror images about x = 0.5, and a crack in the elements below, which cannot grow."""
        options = SHEET | {
            "-pd_patches": "0.1,0.3,0.4,0.7,0.6,0.3,0.9,0.7",
            "-material_toughness": "40",
            "-load_steps": "8",
            "-load_broken_share": "0.3",
            "-bc_bottom_displacement": "free,-1e-3",
            "-crack_names": "west,east,below",
            "-crack_west_points": "0.2,0.5,0.3,0.5",
            "-crack_east_points": "0.8,0.5,0.7,0.5",
            "-crack_below_points": "0.35,0.15,0.65,0.15",
        }
        runs = [self.launch(options, ranks) for ranks in (1, 2)]
        for run in runs:
            self.assertEqual(run.status, 0, run.err)
            self.assertEqual(run.err.count("warning: "), 3, run.err)
            self.assertEqual(run.err.count("ends in elements"), 2, run.err)
            self.assertEqual(run.err.count("warning: a crack came to "), 1, run.err)
            self.assert_on_disk(run, "done")
            outer, inner, outer_mirror, inner_mirror, *below = run.summary["results"]["tips"]
            for tip, image in ((outer, outer_mirror), (inner, inner_mirror)):
                self.assertAlmostEqual(tip["start"][0] + image["start"][0], 1.0, delta=1e-12)
                self.assertGreater(tip["farthest_broken"], 0.05)
                self.assertAlmostEqual(tip["farthest_broken"], image["farthest_broken"], delta=1e-9)
                self.assertAlmostEqual(tip["first_intact"], image["first_intact"], delta=1e-9)
            self.assertEqual([tip["farthest_broken"] for tip in below], [0.0, 0.0])
        self.assertEqual(*(run.summary["bonds_broken"] for run in runs))


class CracksInElements(StressTest):
    """What needs no patch."""

    SHEET = {
        name: value
        for name, value in SHEET.items()
        if not name.startswith("-pd_") and name not in ("-load_steps", "-output_history")
    }

    def energy(self, line):
        options = self.SHEET if line is None else self.SHEET | {"-crack_names": "a", "-crack_a_points": line}
        run = self.launch(options)
        self.assertEqual(run.status, 0, run.err)
        return run.summary["results"]["strain_energy"], run

    def test_a_crack_within_elements_says_that_it_stays_shut(self):
        whole, _ = self.energy(None)
        for line in ("0.02,0.05,0.08,0.06", "0.02,0.05,0.18,0.06"):
            shut, run = self.energy(line)
            self.assertAlmostEqual(shut / whole, 1.0, delta=1e-12)
            self.assertEqual(run.err.count("ends in elements and closes"), 2, run.err)

    def test_a_crack_that_leaves_the_body_is_what_lies_in_it(self):
        inside, first = self.energy("0,0.55,0.5,0.55")
        beyond, second = self.energy("-7,0.55,0.5,0.55")
        self.assertAlmostEqual(beyond / inside, 1.0, delta=1e-12)
        for run in (first, second):
            self.assertEqual(run.summary["results"]["cut_elements"], 5)

    def test_a_crack_right_through_leaves_no_force(self):
        whole, _ = self.energy(None)
        for line in ("-1,0.54,2,0.57", "0,0.5,1,0.5", "1,0.5,0,0.5"):
            parted, _ = self.energy(line)
            self.assertLess(parted, 1e-12 * whole)

    def test_dropped_rows_are_counted(self):
        """Along an edge of the mesh the strip is as thin as nothing: its far nodes have no row."""
        for line in ("0,0.5,1,0.5", "1,0.5,0,0.5"):
            _, run = self.energy(line)
            results = run.summary["results"]
            self.assertEqual(results["cut_elements"], 10)
            self.assertEqual((results["enriched_sets"], results["enriched_sets_dropped"]), (11, 11))


PARTICLES_TORN = NOTCHED | {
    "-mesh_cells": None,
    "-pd_patches": "all",
    "-pd_horizon_ratio": "3",
    "-bc_bottom_layer": "",
    "-bc_top_layer": "",
}

if __name__ == "__main__":
    program.main()
