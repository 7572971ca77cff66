"""The energy that a slanted crack releases, against J over a ring of elements; its modes on contours, against those of the ring.

Usage: test_slanted_tip.py PDXSOLVE [unittest arguments].
"""

import math

import program

PULLED = program.PULLED | {
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "40,40",
    "-pd_patches": "0.3,0.3,0.7,0.8",
    "-pd_spacing": "0.0125",
    "-crack_names": "c",
    "-post_energy_release": "",
}

# A crack at 45 degrees that ends among particles, and runs exactly through them.
THROUGH_PARTICLES = program.PULLED | {
    "-mesh_lower": "0,-10mm",
    "-mesh_upper": "20mm,10mm",
    "-mesh_cells": "40,40",
    "-crack_names": "c",
    "-crack_c_points": "0,0,3.5355339mm,3.5355339mm",
    "-adapt_seed": "tip",
    "-pd_horizon_ratio": "3",
    "-post_modes": "",
}


def crack(degrees, reach=0.5):
    return f"0,0.31,{reach},{0.31 + reach * math.tan(math.radians(degrees))!r}"


class SlantedTip(program.ProgramTest):
    def test_energy_release_is_j(self):
        for degrees in (30, 45):
            with self.subTest(degrees=degrees):
                tip = {"-crack_c_points": crack(degrees), "-post_j_domain": "0.31,0.4"}
                if degrees == 45:
                    tip["-crack_c_points"] = crack(45, 0.25 + 0.0375)  # room in the patch
                    tip["-pd_patches"] = "0.15,0.45,0.45,0.75"
                    tip["-post_j_domain"] = "0.2,0.28"
                results = self.solve(PULLED | tip).summary["results"]
                self.assertLess(abs(results["energy_release_rate"] / results["j_domain"] - 1), 0.01)

    def test_in_elements_it_is_refused(self):
        run = self.launch(PULLED | {"-pd_patches": None, "-pd_spacing": None, "-crack_c_points": crack(30)}, ranks=2)
        self.assertEqual(run.status, 1)
        self.assertRegex(run.err, r"-post_energy_release: the tip at \(0\.5, 0\.598[0-9]*\) is slanted.*-post_j_domain\n$")

    def test_modes_of_a_crack_through_particles_are_those_of_the_ring(self):
        results = self.solve(THROUGH_PARTICLES | {"-post_j_contours": "1mm,2mm", "-post_j_domain": "2.4mm,3.5mm"}).summary["results"]
        for _, opening, sliding, _ in results["modes_by_contour"]:
            self.assertLess(abs(opening / results["k1_domain"] - 1), 0.01)
            self.assertLess(abs(sliding / results["k2_domain"] - 1), 0.02)

    def test_a_ring_without_room_is_refused_before_anything_is_solved(self):
        for toughness in ({}, {"-material_toughness": "1e9"}):
            run = self.launch(THROUGH_PARTICLES | toughness | {"-post_j_domain": "1mm,2mm"})
            self.assertEqual((run.status, (run.directory / "history.csv").exists()), (1, False))
            self.assertRegex(run.err, r"^error: the J domain from 0\.001 to 0\.002 m around the tip at .* holds cells under a "
                                      r"peridynamic patch: choose an inner half-width")


if __name__ == "__main__":
    program.main()
