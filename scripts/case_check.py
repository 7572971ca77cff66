"""What every cases/*/check.py does: run variants through the program, say what holds and what does not."""

import argparse
import concurrent.futures
import pathlib
import subprocess
import tempfile

import pdxtools

ROOT = pathlib.Path(__file__).resolve().parents[1]
# One rank without mpirun: Open MPI 4 starts a daemon for it, which takes longer than a small scene. Not for mpirun, which needs
# the directories that are left out here, lest runs at the same time take each other's away.
ALONE = ["env", "OMPI_MCA_ess_singleton_isolated=1", "OMPI_MCA_orte_create_session_dirs=0"]


class Check:
    """Runs variants of one case in a scratch directory and counts what does not hold."""

    case = ""  # directory below cases/, said by the class that derives from this one

    def __init__(self, executable, scratch):
        self.executable, self.scratch, self.failures = executable, pathlib.Path(scratch), 0

    def check(self, name):
        """Checks what has this name: a part, which is a method, unless the case says otherwise."""
        getattr(self, name)()

    def expect(self, holds, what):
        print(f"  {'ok  ' if holds else 'FAIL'} {what}", flush=True)
        self.failures += not holds

    def expect_near(self, name, found, expected, tolerance):
        gap = abs(found / expected - 1.0)
        self.expect(gap <= tolerance, f"{name} {found:.9g} against {expected:.9g}: off by {gap:.1e} of it")

    def expect_between(self, name, found, lower, upper):
        self.expect(lower <= found <= upper, f"{name} {found:.6g}, wanted {lower:g} to {upper:g}")

    def books(self, run, momentum=None, drift=None):
        """Results and history of a run, after a look at what may be lost of momentum and energy."""
        results = pdxtools.read_summary(run)["results"]
        for name, most in (("momentum_error_ratio", momentum), ("energy_drift_ratio", drift)):
            if most is not None:
                self.expect_between(name, results[name], 0.0, most)
        return results, pdxtools.read_history(run)

    def expect_alike(self, variant, names, tolerance):
        """Results of these names are the same on 1, 2 and 3 ranks."""
        runs = [self.run(variant, ranks) for ranks in (1, 2, 3)]
        if None in runs:
            return
        values = [pdxtools.read_summary(run[0])["results"] for run in runs]
        for ranks, value in zip((2, 3), values[1:]):
            for name in names:
                self.expect_near(f"{ranks} ranks: {name}", value[name], values[0][name], tolerance)

    def run_at_once(self, *runs):
        """Runs on one rank, two at a time: arguments of `run` of each."""
        with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
            return list(pool.map(lambda arguments: self.run(*arguments), runs))

    def run(self, variant, ranks=2, options=(), name=None):
        """Runs cases/CASE/VARIANT.opts; its output directory and what it said on standard error, or None if it
        failed."""
        directory = self.scratch / (name or f"{variant}_{ranks}")
        launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else ALONE
        command = [*launcher, self.executable]
        command += ["-options_file", f"cases/{self.case}/{variant}.opts", *options]
        command += ["-output_dir", str(directory), "-quiet"]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=900)
        self.expect(done.returncode == 0, f"{directory.name}: exit status {done.returncode} {done.stderr.strip()}")
        return (directory, done.stderr) if done.returncode == 0 else None


def main(description, check_class, names, what="VARIANT"):
    """Parses the command line, calls `check_class(executable, scratch).check(name)` for the names asked for, and returns
    the exit status."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar=what, help=", ".join(names))
    parser.add_argument("--executable", default=str(ROOT / "build/release/pdxsolve"))
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in names]
    if unknown:
        parser.error(f"no {what.lower()} {unknown[0]}: choose from {', '.join(names)}")
    with tempfile.TemporaryDirectory() as scratch:
        check = check_class(str(pathlib.Path(arguments.executable).resolve()), scratch)
        for name in arguments.names or names:
            print(name, flush=True)
            check.check(name)
    print(f"{check.failures} failed" if check.failures else "all holds")
    return 1 if check.failures else 0
