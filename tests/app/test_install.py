"""What `cmake --install` leaves: a program that runs, its commands, and a library that another project finds and adds a Term to."""

import pathlib
import re
import subprocess

import program
from program import pdxtools

EXAMPLE = program.ROOT / "scripts" / "docs" / "example"


class Install(program.ProgramTest):
    def call(self, *command):
        status, out, err = program.finish(list(map(str, command)), self.scratch)
        self.assertEqual(status, 0, f"{' '.join(map(str, command))}\n{out}{err}")
        return out

    def test_an_installed_copy_serves_another_project(self):
        build, prefix = pathlib.Path(program.PROGRAM).parent, self.scratch / "prefix"
        if "PDX_SANITIZE:BOOL=ON" in (build / "CMakeCache.txt").read_text(encoding="utf-8"):
            self.skipTest("a library with sanitizers serves programs that have them")
        self.call("cmake", "--install", build, "--prefix", prefix)
        self.call("cmake", "-S", EXAMPLE, "-B", self.scratch / "ground", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_CXX_FLAGS=-Wall -Werror")
        self.call("cmake", "--build", self.scratch / "ground")
        for ranks in (1, 2, 3):  # the program itself judges by the closed form
            self.assertIn("the first node moves by 0.000217", self.call(*program.launcher(ranks), self.scratch / "ground" / "ground"))

        self.call(*program.launcher(1), prefix / "bin" / "pdxsolve", *program.words_of(program.SMALL), "-output_fields", "-output_dir", "run")
        for command, left in (("pdxsolve-report", "run/report.html"), ("pdxsolve-vtkhdf", "run/fields_mesh.vtkhdf")):
            self.call(prefix / "bin" / command, "run")
            self.assertTrue((self.scratch / left).stat().st_size > 0)
        self.call(prefix / "bin" / "pdxsolve-pack", "run")
        self.assertEqual(pdxtools.step_count(self.scratch / "run"), 1)
        self.assertIn(".B \\-adapt_seed\n", (prefix / "share/man/man1/pdxsolve.1").read_text(encoding="utf-8"))
        for name in ("report", "plot", "vtkhdf", "pack"):
            self.assertIn(f"pdxsolve\\-{name} OUT_DIR", (prefix / f"share/man/man1/pdxsolve-{name}.1").read_text(encoding="utf-8"))
        self.reads_on(prefix)
        copied = subprocess.run(["diff", "-r", "-x", "__pycache__", "-x", "*.toml", program.ROOT / "scripts/pdxtools",
                                 prefix / "lib/python3/dist-packages/pdxtools"], capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(copied.stdout, "")

    def reads_on(self, prefix):
        """A user finds the tutorial, every link of the pages leads to what is installed, and cases run from anywhere."""
        pages, cases = prefix / "share/doc/pdxsolve", prefix / "share/pdxsolve/cases"
        self.assertIn(f"{pages.resolve()}/tutorial.md; cases are in {cases.resolve()}.", self.call(*program.launcher(1), prefix / "bin" / "pdxsolve", "-help"))
        links = [(page, target) for page in pages.glob("*.md") if page.name not in ("README.md", "CHANGELOG.md")
                 for target in re.findall(r"\]\(([^)#:\s]+)(?:#[^)\s]*)?\)", re.sub(r"(?s)```.*?```", "", page.read_text(encoding="utf-8")))]  # fmt: skip
        self.assertGreater(len(links), 40)
        for page, target in links:
            self.assertTrue((page.parent / target).exists(), f"{page.name}: {target}")
        for file in ("mpi_env.sh", "paraview_view.py", "pdxsolve.sbatch"):
            self.assertTrue((cases.parent / file).exists(), file)
        self.call(*program.launcher(1), prefix / "bin" / "pdxsolve", "-options_file", cases / "teaching/hole_crack.opts", "-output_dir", "far")
        known = pdxtools.read_summary(self.scratch / "far")["results"]["tips"][1]["k1_domain"]
        self.assertLess(abs(known / 7.489e6 * 1000**0.5 - 1), 0.01)  # of cases/teaching: dislocations


if __name__ == "__main__":
    program.main()
