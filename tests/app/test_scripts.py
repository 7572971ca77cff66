"""Scripts that read what runs leave: pictures of any body, steps for other programs, under whatever python3 is called."""

import os
import pathlib
import subprocess
import sys
import xml.etree.ElementTree as xml

import program
from torn import TORN

import h5py

SCRIPTS = program.ROOT / "scripts"
FIELDS = {"-output_fields": "", "-output_interval": "1000"}
POINTS = {"-case": "points", "-mpm_bodies": "a", "-mpm_spacing": "0.1", "-mpm_a_disc": "0,0,1", "-mpm_a_velocity": "1,0",
          "-material_young": "1e9", "-material_density": "1000", "-analysis": "explicit", "-ts_max_steps": "5", "-quiet": ""}  # fmt: skip


class Scripts(program.ProgramTest):
    def script(self, name, *words, python=sys.executable, status=0):
        done = subprocess.run([python, SCRIPTS / name, *map(str, words)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def test_pictures_of_bodies_without_elements(self):
        torn, points = self.solve(TORN | FIELDS), self.solve(POINTS | FIELDS)
        for kind, run in (("damage", torn), ("plate", points), ("motion", points)):
            with self.subTest(kind):
                picture = self.scratch / f"{kind}.png"
                self.script("plot_case.py", run.directory, "-o", picture, "--kind", kind)
                self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        refused = self.script("plot_case.py", points.directory, "-o", self.scratch / "no.png", "--kind", "damage", status=1)
        self.assertIn("no particles with a damage", refused.stderr)
        nowhere = self.script("plot_case.py", self.scratch / "nowhere", "-o", self.scratch / "no.png", status=1)
        self.assertRegex(nowhere.stderr, r"^plot_case\.py: \S*nowhere is not there: give the directory of a run with -output_fields\n$")

    def test_one_step_is_what_other_programs_read(self):
        run = self.solve(program.SMALL_PATCH | FIELDS)
        for block, cells in (("mesh", 4), ("particles", 1)):
            with self.subTest(block):
                file = self.scratch / "elsewhere" / f"{block}.xdmf"
                file.parent.mkdir(exist_ok=True)
                self.script("one_step.py", run.directory, "--block", block, "-o", file)
                grids = xml.parse(file).getroot().findall("./Domain/Grid")
                self.assertEqual([(grid.get("GridType"), grid.get("Name")) for grid in grids], [("Uniform", block)])
                items = list(grids[0].iter("DataItem"))
                self.assertGreaterEqual(len(items), 4)
                for item in items:
                    path, dataset = item.text.split(":")
                    self.assertFalse(pathlib.PurePath(path).is_absolute())
                    with h5py.File(file.parent / path) as data:
                        self.assertEqual(data[dataset].shape, tuple(map(int, item.get("Dimensions").split())))
                self.assertEqual(items[0].get("Dimensions").split()[1], str(cells))
        self.assertIn("no block points: choose from mesh, particles", self.script("one_step.py", run.directory, "--block", "points",
                                                                                   "-o", self.scratch / "no.xdmf", status=1).stderr)  # fmt: skip

    def test_a_python_without_modules_finds_one_that_has_them(self):
        if not os.path.exists("/usr/bin/python3"):
            self.skipTest("no python3 of the system")
        bare = self.scratch / "bare"
        subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", bare], check=True)
        for name in ("bench.py", "plot_case.py", "snail_pictures.py"):
            self.assertIn("usage", self.script(name, "--help", python=bare / "bin" / "python3").stdout)


if __name__ == "__main__":
    program.main()
