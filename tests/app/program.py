"""For the tests beside this file: runs pdxsolve in a directory of its own and reads what it leaves there.

A test file ends with `program.main()` and is called as test_X.py PDXSOLVE [unittest arguments]. The environment lets
Open MPI run (ctest sets it; by hand: `. scripts/mpi_env.sh`).
"""

import concurrent.futures
import csv
import dataclasses
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))

import case_check
import compare
import pdxtools

AT_BORDER = re.compile(r"^warning: a crack came to \([^\n]*\n", re.MULTILINE)
ON_ROW = re.compile(r"^warning: crack \d+ runs along a row of particles[^\n]*\n", re.MULTILINE)
TIMEOUT = 120  # [s] longer is a hang
ALONE = case_check.ALONE  # in front of a program on one rank
# When one rank has ended with an error, mpirun waits a second before it ends the others. Where hundreds of mistakes are
# tried it need not: what another rank says later is looked for in other tests.
NO_WAIT = {"OMPI_MCA_odls_base_sigkill_timeout": "0", "PRTE_MCA_odls_base_sigkill_timeout": "0"}

# 1 x 1 m in 4 x 4 elements, clamped on the left, pulled and sheared on the right: the smallest scene worth a run.
SMALL = {
    "-case": "small",
    "-mesh_lower": "0,0",
    "-mesh_upper": "1,1",
    "-mesh_cells": "4,4",
    "-material_young": "1e9",
    "-bc_names": "clamp,load",
    "-bc_clamp_on": "left",
    "-bc_clamp_displacement": "0,0",
    "-bc_load_on": "right",
    "-bc_load_traction": "1e6,1e6",
    "-quiet": "",
}
SMALL_PATCH = SMALL | {"-pd_patches": "0.25,0.25,0.75,0.75", "-pd_spacing": "0.125"}
# The same in 20 x 20 elements, with a patch of 16 x 16 particles: room for four ranks.
PLATE = SMALL | {"-case": "plate", "-mesh_cells": "20,20"}
PATCH = PLATE | {"-pd_patches": "0.3,0.3,0.7,0.7", "-pd_spacing": "0.025"}

# Held at the bottom and moved at the top; the body is to be added.
PULLED = {
    "-material_young": "1e9",
    "-bc_names": "b,t",
    "-bc_b_on": "bottom",
    "-bc_b_displacement": "0,0",
    "-bc_t_on": "top",
    "-bc_t_displacement": "0,1e-3",
    "-quiet": "",
}
# Held and pulled so that it stretches evenly along x and is free along y; the body is to be added.
EVEN = {
    "-material_young": "1e9",
    "-bc_names": "left,bottom,right",
    "-bc_left_on": "left",
    "-bc_left_displacement": "0,free",
    "-bc_bottom_on": "bottom",
    "-bc_bottom_displacement": "free,0",
    "-bc_right_on": "right",
    "-bc_right_traction": "1e6,0",
    "-quiet": "",
}


@dataclasses.dataclass(frozen=True)
class Run:
    """What a run left behind."""

    status: int  # exit status; None if it hung
    out: str
    err: str
    directory: pathlib.Path

    @property
    def summary(self):
        return json.loads((self.directory / "summary.json").read_text(encoding="utf-8"))

    @property
    def events(self):
        return self.summary["events"]

    @property
    def files(self):
        return sorted(path.name for path in self.directory.iterdir())

    def history(self):
        return rows_of(self.directory / "history.csv")


def rows_of(path):
    """The rows of a curve, by column name without its unit."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = [name.split(" ")[0] for name in rows[0]]
    return [dict(zip(names, map(float, row))) for row in rows[1:]]


def words_of(options):
    """The command line of options: {"-quiet": ""} is a flag, a value None takes an option away."""
    words = []
    for key, value in options.items():
        if value is not None:
            words += [key, value] if value else [key]
    return words


def launcher(ranks):
    """The words in front of a program that start it on so many ranks."""
    return ["mpirun", "-n", str(ranks)] if ranks > 1 else ALONE


def without_launcher(said):
    """What ranks said on stderr, without the notice that Open MPI 5 cannot be kept from adding when they fail."""
    said = re.sub(r"^\[[^\]\n]*\] PMIX ERROR: .*\n", "", said.replace("\0", ""), flags=re.MULTILINE)  # PMIx 5 at an early end
    said = re.sub(r"^\[warn\] Epoll .*\n", "", said, flags=re.MULTILINE)  # its event loop, of a rank that is gone
    return re.sub(r"-{60,}\n(prterun|mpirun|MPI_ABORT) .*?\n-{60,}\n", "", said, flags=re.DOTALL)


def finish(command, directory, timeout=TIMEOUT, more=None):
    """Runs a command there to its end: exit status (None if it hung), what it said on stdout and on stderr.
    `more` goes into its environment."""
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, **pipes, text=True, cwd=directory, env=os.environ | (more or {})) as process:
        try:
            out, err = process.communicate(timeout=timeout)
            return process.returncode, out, without_launcher(err)
        except subprocess.TimeoutExpired:
            process.terminate()  # mpirun takes its ranks along
            return None, *process.communicate()


SHARED_SCRATCH = tempfile.TemporaryDirectory()  # goes with the process
SHARED = {}  # runs by options and ranks


class ProgramTest(unittest.TestCase):
    """Each test has a scratch directory; each of its runs a directory in there."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.scratch = pathlib.Path(scratch.name)
        self.runs = 0

    def launch(self, options, ranks=1, before=(), directory=None):
        """Runs the program behind the words `before` (valgrind) and returns a Run, however it ended."""
        self.runs += 1
        directory = directory or self.scratch / f"run_{self.runs}"
        command = [*launcher(ranks), *before, PROGRAM, *words_of(options), "-output_dir", str(directory)]
        return Run(*finish(command, ROOT), directory)

    CRACKS_REACH_BORDERS = False  # do scenes of these tests have patches that end where their cracks run?
    CRACKS_LIE_ON_ROWS = False  # of particles, or do they run between them?

    def solve(self, options, ranks=1, directory=None):
        """Runs a scene that must succeed without a word on stderr."""
        run = self.launch(options, ranks, directory=directory)
        said = AT_BORDER.sub("", run.err) if self.CRACKS_REACH_BORDERS else run.err
        said = ON_ROW.sub("", said) if self.CRACKS_LIE_ON_ROWS else said
        self.assertEqual((run.status, said), (0, ""), f"{ranks} ranks; stdout: {run.out}")
        return run

    def shared(self, options, ranks=1):
        """As `solve`, but a scene that this or another test has run is not run again: nobody may write where it lies."""
        key = (tuple(sorted((name, value) for name, value in options.items() if value is not None)), ranks)
        if key not in SHARED:
            SHARED[key] = self.solve(options, ranks, pathlib.Path(tempfile.mkdtemp(dir=SHARED_SCRATCH.name)))
        return SHARED[key]

    def assert_same_displacement(self, a, b, tolerance=1e-9):
        """All blocks of two runs agree: largest difference over largest displacement. Points by natural number."""
        steps = [pdxtools.read_step(run.directory)[1] for run in (a, b)]
        self.assertEqual(steps[0].keys(), steps[1].keys())
        for name in steps[0]:
            self.assertLessEqual(compare.difference(name, steps[0][name], steps[1][name]), tolerance, name)


def in_pairs(function, items):
    """The results of function(item), two at a time: for runs on one rank."""
    with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
        return list(pool.map(function, items))


def main():
    global PROGRAM
    if len(sys.argv) < 2:
        sys.exit(f"usage: {pathlib.Path(sys.argv[0]).name} PDXSOLVE [unittest arguments]")
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
