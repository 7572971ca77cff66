"""What `cmake --install` leaves: a program that runs, its commands, and a library that another project finds and adds a Term to."""

import pathlib
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
        copied = subprocess.run(["diff", "-r", "-x", "__pycache__", "-x", "*.toml", program.ROOT / "scripts/pdxtools",
                                 prefix / "lib/python3/dist-packages/pdxtools"], capture_output=True, text=True, check=False)  # fmt: skip
        self.assertEqual(copied.stdout, "")


if __name__ == "__main__":
    program.main()
