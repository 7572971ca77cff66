"""No PETSc object outlives a run, and valgrind finds no error in our code.

Usage: test_memory.py PDXSOLVE [unittest arguments]. Valgrind comes with scripts/setup.sh.
"""

import pathlib
import shutil

import program
from program import SMALL, SMALL_PATCH

MALLOC = {"-malloc_debug": "", "-malloc_dump": "", "-objects_dump": ""}
OUTPUT = {"-output_fields": "", "-output_history": ""}
PAPERS = {"-couple_scheme": "ghost", "-pd_surface_correction": "volume", "-kinematics": "mixed"}
SUPPRESSIONS = (
    pathlib.Path("/usr/share/openmpi/openmpi-valgrind.supp"),
    program.ROOT / "tests" / "support" / "pmix.supp",
)
VALGRIND_ERROR = 99


class PetscMemory(program.ProgramTest):
    def assert_clean(self, options, ranks, status=0):
        run = self.launch(options | MALLOC, ranks)
        leaks = [line for line in (run.out + run.err).splitlines() if " bytes " in line or "never freed" in line]
        self.assertEqual((run.status, leaks), (status, []), run.out + run.err)

    def test_runs_free_all_they_took(self):
        smoke = {"-options_file": "cases/plate_static/smoke.opts"}
        if not (program.ROOT / smoke["-options_file"]).exists():
            self.fail("cases/plate_static/smoke.opts is missing")
        for ranks in (1, 2):
            for options in (smoke | {"-quiet": ""}, SMALL_PATCH | PAPERS | OUTPUT | {"-post_reference_fe": ""}):
                with self.subTest(ranks=ranks, case=options.get("-case", "smoke")):
                    self.assert_clean(options, ranks)

    def test_assembled_runs_free_all_they_took(self):
        self.assert_clean(SMALL_PATCH | {"-pd_operator": "assembled"}, 2)
        self.assert_clean(SMALL | {"-kinematics": "finite", "-load_steps": "2"}, 2)

    def test_refused_and_failed_runs_free_all_they_took(self):
        self.assert_clean(SMALL_PATCH | {"-pd_patches": "0.3,0.25,0.75,0.75"}, 1, status=1)
        self.assert_clean(SMALL_PATCH | {"-ksp_max_it": "2"}, 1, status=2)


class Valgrind(program.ProgramTest):
    def test_finds_no_error(self):
        valgrind = shutil.which("valgrind")
        if not valgrind:
            self.fail("valgrind is not installed: run scripts/setup.sh")
        words = [valgrind, "--quiet", f"--error-exitcode={VALGRIND_ERROR}", "--num-callers=40"]
        words += ["--leak-check=full", "--show-leak-kinds=definite", "--errors-for-leak-kinds=definite"]
        words += [f"--suppressions={path}" for path in SUPPRESSIONS]

        def launch(scene):
            name, options = scene
            log = self.scratch / f"{name}.log"
            run = self.launch(options, before=[*words, f"--log-file={log}"])
            return name, run, log.read_text(encoding="utf-8", errors="replace")

        scenes = {"energy": SMALL_PATCH | OUTPUT, "papers": SMALL_PATCH | PAPERS | {"-pd_operator": "assembled"}}
        for name, run, log in program.in_pairs(launch, scenes.items()):
            with self.subTest(scene=name):
                self.assertEqual((run.status, log), (0, ""), run.err)


if __name__ == "__main__":
    program.main()
