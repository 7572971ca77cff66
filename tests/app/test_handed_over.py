"""Patches that stay when a layout changes are handed over with all that is around them: a run in which all is made whole
again every few steps, which changes nothing, is the same to the last bit."""

import program
from torn import TABLES, checkpoint, results

import numpy as np

# Two patches among elements, a crack in each, which grow out of them: one patch changes, the other stays.
PAIR = {
    "-case": "pair",
    "-analysis": "explicit",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,0.5",
    "-mesh_cells": "40,20",
    "-pd_patches": "0.2,0.2,0.35,0.3,0.65,0.2,0.8,0.3",
    "-pd_spacing": "0.0125",
    "-pd_horizon_ratio": "3",
    "-material_young": "1e9",
    "-material_density": "1000",
    "-pd_critical_stretch": "0.004",
    "-crack_names": "a,b",
    "-crack_a_points": "0.2525,0.25125,0.31875,0.25625",
    "-crack_b_points": "0.7025,0.25125,0.76875,0.24375",
    "-bc_names": "top,bottom",
    "-bc_top_on": "top",
    "-bc_top_traction": "0.5e6,3e6",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_velocity": "free,-0.5",
    "-adapt": "expand",
    "-adapt_every": "5",
    "-adapt_critical_length": "0.03",
    "-adapt_expansion_length": "0.06",
    "-ts_max_steps": "160",
    "-checkpoint_interval": "160",
    "-output_history": "",
    "-output_history_interval": "4",
    "-quiet": "",
}
SPRUNG = {"-bc_names": "top,bottom,right", "-bc_right_on": "right", "-bc_right_spring": "1e9,1e8"}
STIFF = {
    "-region_names": "stiff",
    "-region_stiff_box": "0.55,0.2,0.95,0.45",
    "-region_stiff_young": "2e9",
    "-region_stiff_thickness": "0.7",
    "-region_stiff_density": "1500",
    "-region_stiff_toughness": "400",
    "-pd_critical_stretch": None,
    "-material_toughness": "200",
}
QUIET = {
    "-adapt_trigger": "damage,stretch",
    "-adapt_stretch": "0.5",
    "-adapt_hand_back": "40",
    "-adapt_critical_length": None,
    "-adapt_expansion_length": None,
    "-bc_bottom_velocity": "free,-2",
    "-ts_max_steps": "200",
    "-checkpoint_interval": "200",
}
PROBED = {"-probe_names": "line", "-probe_line_line": "0.2,0.25,0.95,0.05,9"}
PULSE = {"-bc_top_history": "gaussian", "-bc_top_history_width": "3e-4", "-bc_top_history_time": "5e-4"}
SCENES = {  # with the number of ranks
    "scattered": (1, {"-adapt": "relocate", "-pd_scatter": "0.3"} | SPRUNG | PROBED),
    "finer": (2, {"-pd_spacing": "0.0125,0.00625", "-pd_no_fail": "0.7,0.2,0.75,0.25"}),
    "strained": (1, {"-kinematics": "finite", "-couple_face_mass": ""} | PULSE),
    "parted": (2, {"-ts_subcycle": "2"} | STIFF),
}
EVERY = {"-layout_renew_interval": "7"}
LATER = {"dormant_carried_bonds"}  # those of the last change: the others are told with what is broken
SEEN = {"seen_damage"}  # summed up when it was looked at


class HandedOver(program.ProgramTest):
    CRACKS_REACH_BORDERS = True

    def pair(self, options, ranks):
        """A run whose patches are handed over, and one in which all is made whole in between."""
        over, whole = (self.solve(PAIR | options | more, ranks) for more in ({}, EVERY))
        self.assertGreater(over.summary["bonds_broken"], 1000)
        self.assertGreater(over.events["layout_change"], 1)
        self.assertGreater(whole.events["layout_change"], over.events["layout_change"] + 15)
        return over, whole

    def test_as_what_is_made_whole(self):
        for name, (ranks, options) in SCENES.items():
            with self.subTest(name):
                # cells stay where they are dealt to by number
                over, whole = self.pair(options | {"-petscpartitioner_type": "simple"}, ranks)
                (a, numbers), (b, other) = checkpoint(over.directory), checkpoint(whole.directory)
                self.assertEqual(set(a), set(b))
                for table in set(a) - LATER - SEEN:
                    np.testing.assert_array_equal(a[table], b[table], table)
                for table in SEEN:
                    np.testing.assert_allclose(a[table], b[table], rtol=1e-12, err_msg=table)
                self.assertEqual(numbers, other)
                self.assertEqual(results(over), results(whole))
                self.assertEqual((over.directory / "history.csv").read_bytes(), (whole.directory / "history.csv").read_bytes())

    def test_what_is_known_of_cells_goes_where_they_are_dealt_to(self):
        """Made whole, cells are dealt out by what they hold then: how long each was quiet, and what damage was seen."""
        over, whole = self.pair(QUIET, 3)
        (a, _), (b, _) = checkpoint(over.directory), checkpoint(whole.directory)
        for table in ("gone_bonds", "broken_carried_bonds", "row_names", "layout_patches", "quiet_looks", "seen_particles"):
            np.testing.assert_array_equal(a[table], b[table], table)
        for table in TABLES[:2]:
            self.assertLessEqual(np.abs(a[table] - b[table]).max(), 1e-12 * np.abs(a[table]).max(), table)


if __name__ == "__main__":
    program.main()
