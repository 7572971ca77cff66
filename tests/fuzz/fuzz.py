#!/usr/bin/env python3
"""Damaged inputs through the program: options, command lines, meshes, tables, clouds, checkpoints. Seeded and bounded.

usage: fuzz.py HARNESS [--ranks N] [--count N] [--seed N] [--kind WORD] [--keep DIRECTORY]
       fuzz.py PROGRAM --whole [the same]        every input is a run of its own, slower and closer to life
Whatever the input: no trace, no signal, no hang, no exit status but 0, 1 and 2 (3, the machine failed, only for lack of
memory), no message over 640 characters, and status 1 with one line of error. What fails is printed with the command that
repeats it, and kept with --keep. The files below corpus/ come first.
"""

import argparse
import json
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "app"))
sys.dont_write_bytecode = True

import harness
import mutations
import program
import seeds

PATIENCE = 60  # [s] a run that says nothing for longer hangs; on an idle machine it takes a few hundredths
LONGEST = 640  # characters of a message
MEMORY = 6 << 30  # [bytes] address space: a scene that wants more ends with status 3, not the machine
TRACES = ("PETSC ERROR", "Signal", "signal", "*** ", "terminate called", "runtime error:", "AddressSanitizer", "LeakSanitizer", "std::", "Assertion")
OPTION_WORDS = ("-mesh_cells", "-pd_spacing", "-bc_names", "-crack_names", "-ts_dt", "-output_times", "-options_file", "-help", "-ksp_type",
                "-log_view", "-mesh_file", "-pd_cloud", "-restart", "-material_plane", "-analysis", "-prefix_push", "-options_file_yaml")  # fmt: skip


class Case:
    """One input: what it came from, the words of its command line, the directory of its files."""

    def __init__(self, name, words, directory):
        self.name, self.words, self.directory = name, words, directory


class Inputs:
    """Makes cases in a scratch directory, where the checkpoints of seeds.BEFORE must lie before."""

    def __init__(self, scratch, seed, kinds):
        self.scratch, self.random = scratch, random.Random(seed)
        self.files = seeds.write_files(scratch)
        self.kinds = [kind for kind in KINDS if not kinds or kinds in kind]
        self.number = 0

    def directory(self):
        self.number += 1
        directory = self.scratch / f"case_{self.number}"
        directory.mkdir()
        return directory

    def good(self, scene, text=None):
        """The scene as it is."""
        directory = self.directory()
        options = (text or seeds.SCENES[scene]).format(dir=self.scratch)
        (directory / "case.opts").write_text(options)
        return Case(scene, ["-options_file", str(directory / "case.opts")], directory)

    def made(self):
        return getattr(self, self.random.choice(self.kinds))()

    def options(self):
        scene = self.random.choice(sorted(seeds.SCENES))
        case = self.good(scene)
        path = case.directory / "case.opts"
        path.write_bytes(mutations.text(self.random, path.read_bytes()))
        case.name = f"options of {scene}"
        return case

    def command_line(self):
        scene = self.random.choice(sorted(seeds.SCENES))
        case = self.good(scene)
        words = case.words + [self.random.choice(OPTION_WORDS)] + ["0.5"] * self.random.randrange(2)
        for _ in range(self.random.choice((1, 1, 2, 3))):
            at = self.random.randrange(len(words) + 1)
            word = self.random.choice(mutations.WORDS + list(OPTION_WORDS)).replace("\0", "")[:60000]
            what = self.random.randrange(3)
            words[at : at + (what > 0)] = [word] if what < 2 else []
        case.name, case.words = f"command line of {scene}", words
        return case

    def text_file(self):
        return self.damaged([s for s in self.files if "text" in s or s in ("motion", "cracks", "regions", "cloud_csv", "points")], mutations.text)

    def binary_file(self):
        return self.damaged([s for s in self.files if "binary" in s] + ["cloud_h5", "restart", "restart_mixed"], mutations.binary)

    def hdf5_file(self):
        def damage(rng, data):
            path = self.scratch / "work.h5"
            path.write_bytes(data)
            mutations.hdf5(rng, path)
            return path.read_bytes()

        return self.damaged(["cloud_h5", "restart", "restart_mixed"], damage)

    def damaged(self, scenes, damage):
        scene = self.random.choice(scenes)
        name = self.files[scene]
        directory = self.directory()
        (directory / name).write_bytes(damage(self.random, (self.scratch / name).read_bytes()))
        text = seeds.SCENES[scene].replace("{dir}/" + name, f"{directory}/{name}").format(dir=self.scratch)
        (directory / "case.opts").write_text(text)
        return Case(f"{name} of {scene}", ["-options_file", str(directory / "case.opts")], directory)

    def corpus(self):
        """Small files that once broke something: options by themselves, others in the scene they belong to."""
        for path in sorted((HERE / "corpus").iterdir()):
            scene = {".msh": "gmsh_2.2_text", ".csv": "cloud_csv", ".txt": "cracks", ".h5": "restart"}.get(path.suffix)
            directory = self.directory()
            shutil.copy(path, directory / path.name)
            words = ["-options_file", str(directory / path.name)]
            if scene:
                text = seeds.SCENES[scene].replace("{dir}/" + self.files[scene], f"{directory}/{path.name}")
                (directory / "case.opts").write_text(text.format(dir=self.scratch))
                words[1] = str(directory / "case.opts")
            yield Case(f"corpus/{path.name}", words, directory)


KINDS = ("options", "command_line", "text_file", "binary_file", "hdf5_file")


def limit_memory():
    if "LSAN_OPTIONS" not in os.environ:  # the sanitizers reserve far more than they use
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def judge(status, said, message=None):
    """What is wrong with how a run ended, "" if nothing. `message`: where it is not among what was said."""
    lines = [line for line in said.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("error:")] if message is None else [message] * (status != 0)
    trace = next((line for line in lines if any(word in line for word in TRACES)), None)
    if status is None:
        return "hangs"
    if trace and trace not in errors:
        return f"trace: {trace[:200]}"
    if status == 3 and any("memory" in line for line in errors):
        return ""
    if status not in (0, 1, 2):
        return f"status {status}: {(errors or lines or [''])[-1][:300]}"
    if status and len(errors) != 1:
        return f"status {status} with {len(errors)} lines of error"
    if status and message is None and len(lines) > 1 + sum(line.startswith("warning:") for line in lines):
        return f"more than a line of error: {[line[:100] for line in lines]}"
    for line in lines + errors:
        if len(line) > LONGEST:
            return f"message of {len(line)} characters: {line[:100]}..."
        if re.search(r"[\0-\x08\x0b-\x1f\x7f]", line):
            return f"control characters in {line!r:.200}"
    return "" if not any("\n" in error.strip() for error in errors) else f"more than a line: {errors[0]!r:.300}"


def run_whole(executable, cases, ranks):
    """Each case by the program itself; yields (case, what is wrong, status)."""
    for case in cases:
        words = [*case.words, "-output_dir", str(case.directory / "out")]
        with subprocess.Popen([*program.launcher(ranks), executable, *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              cwd=case.directory, env=os.environ | program.NO_WAIT, preexec_fn=limit_memory) as process:  # fmt: skip
            try:
                err, status = process.communicate(timeout=PATIENCE)[1], process.returncode
            except subprocess.TimeoutExpired:
                process.terminate()
                err, status = process.communicate()[1], None
        said = program.without_launcher(err.decode(errors="replace"))
        yield case, judge(status, said), status


def run_together(executable, cases, ranks, scratch):
    """All in one process, begun anew behind a case that ends it; yields (case, what is wrong, status)."""
    commands = [case.words + ["-output_dir", str(case.directory / "out")] for case in cases]
    outcomes = harness.run(executable, commands, ranks, scratch, patience=PATIENCE, preexec_fn=limit_memory)
    for outcome, case in zip(outcomes, cases):  # the outcomes first: their end is looked at too
        if outcome.ended:
            yield case, f"ended with {outcome.status}: {outcome.said.strip()[-300:]}", outcome.status
        else:
            yield case, judge(outcome.status, outcome.said, outcome.message), outcome.status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("executable")
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", default="", help=", ".join(KINDS))
    parser.add_argument("--keep", type=pathlib.Path)
    arguments = parser.parse_args()
    executable = str(pathlib.Path(arguments.executable).resolve())
    with tempfile.TemporaryDirectory(prefix="pdx_fuzz_") as name:
        scratch = pathlib.Path(name)
        inputs = Inputs(scratch, arguments.seed, arguments.kind)
        run = lambda cases: run_whole(executable, cases, arguments.ranks) if arguments.whole else run_together(executable, cases, arguments.ranks, scratch)

        before = {name: inputs.good("before " + name, text) for name, text in seeds.BEFORE.items()}
        faults = [(case, wrong or f"status {status}") for case, wrong, status in run(list(before.values())) if wrong or status]
        if faults:
            raise SystemExit(f"fuzz: the scene {faults[0][0].name} is right, but ends with {faults[0][1]}")
        for name, case in before.items():
            shutil.copy(case.directory / "out" / "checkpoint.h5", scratch / name)
        if not arguments.kind:
            right = [inputs.good(scene) for scene in seeds.SCENES]
            faults += [(case, wrong or f"is right, but ends with status {status}") for case, wrong, status in run(right) if wrong or status]
        counts = {}
        for case, wrong, status in run([*inputs.corpus(), *(inputs.made() for _ in range(arguments.count))]):
            counts[status] = counts.get(status, 0) + 1
            if wrong:
                faults.append((case, wrong))
                if arguments.keep:
                    shutil.copytree(case.directory, arguments.keep / f"seed_{arguments.seed}_{case.directory.name}", dirs_exist_ok=True)
        for case, wrong in faults:
            print(f"{case.name} ({case.directory.name}): {wrong}")
        print(f"fuzz: {sum(counts.values())} inputs, seed {arguments.seed}, {arguments.ranks} rank(s); by status {counts}; {len(faults)} wrong")
        if faults:
            print(f"again: {' '.join(sys.argv)} --keep DIRECTORY")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
