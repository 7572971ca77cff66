"""What every study.py that runs variants of a case does: its command line, the runs, a table."""

import argparse
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]


class Parser(argparse.ArgumentParser):
    """--executable, --out and --only of a case whose runs have names."""

    def __init__(self, description, case, names):
        super().__init__(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
        self.names = list(names)
        self.add_argument("--executable", default=str(ROOT / "build/release/pdxsolve"))
        self.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / case)
        self.add_argument("--only", default=",".join(names), help="runs, separated by commas; none: only the table")

    def read(self):
        """The arguments: `only` as a list of names of runs, `executable` and `out` from the root of the file system."""
        arguments = self.parse_args()
        arguments.only = [name for name in arguments.only.split(",") if name and name != "none"]
        unknown = [name for name in arguments.only if name not in self.names]
        if unknown:
            self.error(f"no run {unknown[0]}: choose from {', '.join(self.names)}")
        arguments.executable = str(pathlib.Path(arguments.executable).resolve())
        arguments.out = arguments.out.resolve()
        return arguments


def run(executable, case, name, variant, out, ranks=1, timeout=None):
    """Runs a variant (options file and what is said after it) into its own directory below `out`; true if it ended well.
    `timeout`: longer counts as a failure [s]."""
    file, options = variant
    command = [*(["mpirun", "-n", str(ranks)] if ranks > 1 else []), executable]
    command += ["-options_file", f"cases/{case}/{file}.opts", *options]
    command += ["-case", f"{case}_{name}", "-output_dir", str(out / name), "-quiet"]
    begin = time.monotonic()
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        print(f"{name}: longer than {timeout:g} s", file=sys.stderr, flush=True)
        return False
    said = f"{name}: status {done.returncode} in {time.monotonic() - begin:.1f} s {done.stderr.strip()}"
    print(said, file=sys.stderr, flush=True)
    return done.returncode == 0


def print_table(columns, lines):
    print("|", " | ".join(columns), "|")
    print("|" + "---|" * len(columns))
    for line in lines:
        print("|", " | ".join(map(str, line)), "|")


def main(description, case, variants, columns, line, ranks=False):
    """Runs the variants asked for, by name, and prints `line(out, name)` of all that are there. `ranks`: --ranks is an
    option. Returns the exit status."""
    parser = Parser(description, case, variants)
    if ranks:
        parser.add_argument("--ranks", type=int, default=1)
    arguments = parser.read()
    done = [run(arguments.executable, case, name, variants[name], arguments.out, getattr(arguments, "ranks", 1))
            for name in arguments.only]  # fmt: skip
    lines = (line(arguments.out, name) for name in variants)
    print_table(columns, [cells for cells in lines if cells])
    return 0 if all(done) else 1
